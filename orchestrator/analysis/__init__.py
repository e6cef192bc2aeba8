"""Analyses of scenes and results; each module is one analysis with its command."""
