"""What analyses of vibration are asked in: directions, the load on the base, what counts as a free motion."""

from __future__ import annotations

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
"""Translations along, then rotations about the world axes."""
INTERFACE = "interface"
"""The load on the base, in place of a point."""
ZERO_FREQUENCY = 1e-3
"""Hz; below it a mode is a free motion. Round-off of bushings and locks leaves 1e-5 Hz on a body of 1 kg.m2."""
