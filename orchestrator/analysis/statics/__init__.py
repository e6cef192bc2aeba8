"""A scene at rest: its mechanism in a configuration, static equilibrium, the linear model about it."""
