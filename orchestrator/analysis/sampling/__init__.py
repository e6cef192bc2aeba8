"""Studies by samples: one scene run many times with drawn values, and what follows from them."""
