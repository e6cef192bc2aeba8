"""What a result says of its hinge lines alone."""
