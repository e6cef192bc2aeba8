"""Declared variables: the single place where a name, a unit, a size and a meaning stand, and where each one lies."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .errors import FanfoldError

Vector = NDArray[np.float64]
Kind = Literal["real", "boolean", "integer"]
"""Type of a variable of an FMU; within components its value is a number, 0 or 1 for a Boolean."""


class ComponentError(FanfoldError):
    """A sentence for the user: what is wrong with a value, and what it must be."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """One declared variable: the single place where its unit, range, start value and meaning stand.

    `size` scalars of `unit` (FMI unit syntax; "1" for none). `start` is one number for all or one per
    scalar. `minimum` and `maximum` bound every scalar, inclusive. `variability` only matters for
    parameters ("fixed" before the start only, "tunable" between steps), inputs ("continuous", "discrete") and
    observations ("discrete" for flags). `role`: of an observation, what it is to those who show results, see `roles`.
    `kind`: what hosts see; a Boolean or an integer is a number of no unit here, and is never continuous.

    Of states alone: `rate_unit` is the unit of the rate where an outer solver may integrate the state, which then is
    typically of the size `nominal`, and nothing but observations depends on it if it is a `quadrature`. `resized`:
    the size follows from the structure, such as the number of ports.
    """

    name: str
    unit: str
    description: str
    size: int = 1
    start: float | tuple[float, ...] = 0.0
    minimum: float | None = None
    maximum: float | None = None
    variability: Literal["fixed", "tunable", "continuous", "discrete"] = "continuous"
    role: str = ""
    rate_unit: str = ""
    nominal: float | tuple[float, ...] = 1.0
    quadrature: bool = False
    resized: bool = False
    kind: Kind = "real"

    def saying(self, description: str) -> Quantity:
        """The same with a description of its own."""
        return replace(self, description=description)

    def called(self, name: str, size: int = 1) -> Quantity:
        """The same under a name, of that size."""
        return replace(self, name=name, size=size)

    def sized(self, size: int) -> Quantity:
        """The same of another size."""
        return replace(self, size=size)

    def scalar_names(self) -> tuple[str, ...]:
        """Names of the scalars, `name` itself when there is one, else `name[1]`, ..."""
        if self.size == 1:
            return (self.name,)
        return tuple(f"{self.name}[{i}]" for i in range(1, self.size + 1))

    def start_values(self) -> Vector:
        """Start values, shape (size,)."""
        return np.full(self.size, self.start, dtype=float)


class Layout:
    """Where each quantity sits in a flat array: `layout["name"]` is its slice, `size` the total length."""

    def __init__(self, quantities: Iterable[Quantity]) -> None:
        self.quantities = tuple(quantities)
        self._slices: dict[str, slice] = {}
        position = 0
        for quantity in self.quantities:
            if quantity.name in self._slices:
                raise ComponentError(f"variable {quantity.name!r} is declared twice")
            self._slices[quantity.name] = slice(position, position + quantity.size)
            position += quantity.size
        self.size = position

    def __getitem__(self, name: str) -> slice:
        """Slice of the named quantity; KeyError if there is none."""
        return self._slices[name]

    def __contains__(self, name: str) -> bool:
        """Whether the quantity is declared here."""
        return name in self._slices

    def start_values(self) -> Vector:
        """Start values of all quantities, shape (size,)."""
        return np.concatenate([np.zeros(0), *(q.start_values() for q in self.quantities)])

    def scalar_names(self) -> tuple[str, ...]:
        """Names of all scalars in order."""
        return tuple(name for q in self.quantities for name in q.scalar_names())
