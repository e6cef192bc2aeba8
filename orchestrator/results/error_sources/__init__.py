"""Sources of errors of peaks: the rows of a run, and those of its companion."""
