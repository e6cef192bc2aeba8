"""What analyses of vibration are asked in: directions, and the load on the base."""

from __future__ import annotations

from typing import Literal, get_args

from ..assembly.statics import ZERO_FREQUENCY as ZERO_FREQUENCY

Direction = Literal["x", "y", "z", "rx", "ry", "rz"]
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
"""Translations along, then rotations about the world axes."""
INTERFACE = "interface"
"""The load on the base, in place of a point."""
