"""What a run leaves: the result file, and what can be read from it."""
