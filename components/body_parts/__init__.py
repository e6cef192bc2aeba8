"""What the component `body` is made of."""
