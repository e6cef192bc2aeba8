"""Round-off relative to real values: numbers that count as zero."""

from __future__ import annotations

from collections.abc import Iterable

NOISE = 1e-6
"""Of the largest value of a group: wrenches are solved for no worse than to this part of the largest."""


def noise_floor(group: Iterable[float]) -> float:
    """Magnitude up to which a value of the group is round-off; 0 for an empty group."""
    return NOISE * max(map(abs, group), default=0.0)


def rounded_to_floor(value: float, floor: float) -> float:
    """The value, or 0 (never -0) where it is round-off."""
    return value if abs(value) > floor else 0.0
