"""Runs beside a run, with parameters that differ a little: derivatives through all of its steps and events."""
