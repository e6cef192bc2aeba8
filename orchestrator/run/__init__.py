"""Runs of an assembly: into a result, as FMUs for others, again for its errors."""
