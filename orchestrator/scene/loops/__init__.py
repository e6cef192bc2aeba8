"""Loops that joints between placed bodies close: their constraints, and the poses that fulfil them."""
