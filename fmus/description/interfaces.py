"""Interface types of FMI other than co-simulation, which Fanfold needs."""

OTHER_INTERFACES = {"ModelExchange": "model exchange", "ScheduledExecution": "scheduled execution"}
"""Words by element of the model description."""
