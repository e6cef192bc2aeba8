"""Stresses of a panel over a run, from its modal coordinates."""
