"""Figures of runs that follow a prescribed motion."""
