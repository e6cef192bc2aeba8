"""What the component `beam` is made of."""
