"""Numbers as people give them from Python."""

from __future__ import annotations

from typing import overload

from ..scene.table import SceneError
from ..scene.units import Sign, written

Quantity = float | str
"""A number in SI units, or a text with its unit such as "90 deg"."""


@overload
def in_si(value: None, unit: str, what: str, sign: Sign = "any") -> None: ...
@overload
def in_si(value: Quantity, unit: str, what: str, sign: Sign = "any") -> float: ...
def in_si(value: Quantity | None, unit: str, what: str, sign: Sign = "any") -> float | None:
    """A quantity in its SI unit, None for none; SceneError where it is no such quantity."""
    if value is None:
        return None
    try:
        return written(value, unit, sign)
    except ValueError as error:
        raise SceneError([f"{what} {error}"]) from None
