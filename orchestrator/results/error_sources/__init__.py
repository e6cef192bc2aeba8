"""What tells how far peaks of a run are off: its own rows, and those of a companion."""
