"""Assemblies at rest: their linear model, their static equilibrium, and the configurations of a scene."""
