"""Numbers as people give them from Python."""

from __future__ import annotations

from collections.abc import Mapping
from operator import index
from typing import Annotated, TypeVar, overload

from ..assembly.statics import ZERO_FREQUENCY
from ..scene.schema import SMALLEST_STEP, TOLERANCES
from ..scene.table import SceneError
from ..scene.units import Sign, written
from .options import Within

T = TypeVar("T")
Quantity = float | str
"""A number in SI units, or a text with its unit such as "90 deg"."""
Tolerance = Annotated[float, Within("1", *TOLERANCES)]
Duration = Annotated[Quantity, Within("s", 0.0, above=True)]
StepSize = Annotated[Quantity, Within("s", SMALLEST_STEP)]
Frequency = Annotated[Quantity, Within("Hz", ZERO_FREQUENCY, 1e6)]
"""Below it the round-off of stiff joints would be stiffer than what moves."""
Length = Annotated[Quantity, Within("m", 0.0)]


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


def at_least(count: int, least: int, what: str) -> int:
    """A count that is as large; SceneError where it is less, or no whole number."""
    try:
        found = index(count)
    except TypeError:
        raise SceneError([f"{what} is {count!r}; it must be a whole number"]) from None
    if found < least:
        raise SceneError([f"{what} is {found}; it must be at least {least}"])
    return found


def by_line(given: Mapping[str, T], what: str, example: str) -> Mapping[str, T]:
    """What is given by hinge line; SceneError where it is something else."""
    if not isinstance(given, Mapping):
        raise SceneError([f"{what}: is {given!r}; give values by line, such as {example}"])
    return given
