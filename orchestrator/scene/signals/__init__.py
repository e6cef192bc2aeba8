"""FMUs that have signals instead of ports, as a scene file says it."""
