"""Laws and schemes that several components share, each stated once."""
