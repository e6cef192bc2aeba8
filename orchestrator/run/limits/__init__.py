"""Where a run went beyond what its models are made for."""
