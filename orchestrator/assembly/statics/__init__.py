"""Assemblies at rest: their linear model, their static equilibrium, and the configurations of a scene."""

from __future__ import annotations

ZERO_FREQUENCY = 1e-3
"""Hz; below it a mode is a free motion. Round-off of bushings and locks leaves 1e-5 Hz on a body of 1 kg.m2."""
