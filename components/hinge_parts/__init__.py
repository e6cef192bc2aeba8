"""What the component `hinge` is made of."""
