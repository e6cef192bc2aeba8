"""Neighbouring runs with slightly different parameters: derivatives through all steps and events of a run."""
