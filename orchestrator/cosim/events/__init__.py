"""What interrupts a run that steps through time."""
