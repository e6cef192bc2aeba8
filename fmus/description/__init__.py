"""Model descriptions: what an FMU says of itself in XML, for FMI 2.0, FMI 3.0 and model exchange."""
