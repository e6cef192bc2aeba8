"""Records: named tuples whose fields declare the variables of a flat array, once, with name, unit and size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import accumulate
from typing import Annotated, Any, Generic, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from .quantity import ComponentError, Quantity, Vector

T = TypeVar("T", bound=tuple[Any, ...])


def tunable(
    unit: str,
    description: str,
    start: float = 0.0,
    minimum: float | None = None,
    maximum: float | None = None,
) -> Quantity:
    """A parameter that may change between steps; ComponentError where its start is no number."""
    if not isinstance(start, int | float):
        raise ComponentError(f"a parameter ({description}) starts at {start!r}; it must be a number")
    return Quantity("", unit, description, 1, start, minimum, maximum, "tunable")


def switched(description: str, start: float = 0.0) -> Quantity:
    """A tunable parameter that is 0 or 1, and nothing between."""
    return Quantity("", "1", description, 1, start, 0.0, 1.0, "tunable", kind="boolean")


def kept(unit: str, description: str) -> Quantity:
    """A state."""
    return Quantity("", unit, description)


def integrated(unit: str, rate_unit: str, description: str, quadrature: bool = True) -> Quantity:
    """A state that an outer solver may integrate; nothing but observations depends on a quadrature."""
    return Quantity("", unit, description, rate_unit=rate_unit, quadrature=quadrature)


def observed(unit: str, description: str, role: str = "") -> Quantity:
    """An observation."""
    return Quantity("", unit, description, role=role)


def fixed(unit: str, description: str) -> Quantity:
    """A parameter of zero that is given before the start only."""
    return Quantity("", unit, description)


def flagged(description: str) -> Quantity:
    """An observation that is 0 or 1, and nothing between."""
    return Quantity("", "1", description, variability="discrete", kind="boolean")


_Names = dict[str, Any]
"""Kinds of tuples that an expression makes, by what it calls them."""


class _Field(NamedTuple):
    """Number of scalars of a type, and the expression of its value, which is told the first one's place in a list v."""

    size: int
    expression: Callable[[int, _Names], str]


class Record(Generic[T]):
    """The flat form of a named tuple, each field of which is annotated with a `Quantity`.

        class State(NamedTuple):
            angle: Annotated[float, kept("rad", "Angle, unwrapped")]
            frame: Annotated[Quaternion, kept("1", "Frame of the axis on the inboard port")]

    The quantity takes the field's name, and its size from the type: a float, or a tuple, named or not, of such types;
    `tuple[X, ...]` has as many elements as the quantity's size says, or as `sizes` do where the structure decides.
    A field that is not annotated is a record itself, whose variables are declared here under their own names.
    """

    quantities: tuple[Quantity, ...]
    size: int

    def __init__(self, kind: type[T], **sizes: int) -> None:
        self._kind = kind
        self.quantities, self._field, self._make = _declared(kind, tuple(sizes.items()))
        self.size = self._field.size

    def read(self, values: Vector) -> T:
        """The named tuple of a flat array (size,); ValueError for another size."""
        if values.size != self.size:
            raise ValueError(f"{self._kind.__name__} has {self.size} numbers; {values.size} are given")
        made: T = self._make(values.tolist())
        return made

    def write(self, record: T) -> Vector:
        """The flat array (size,) of a named tuple; ComponentError for anything else, ValueError for another size."""
        if not isinstance(record, tuple):
            raise ComponentError(
                f"{record!r} is no {self._kind.__name__}; a function that makes one must return it"
            )
        found: list[float] = []
        _append_scalars(record, found)
        values = np.array(found, dtype=float)
        if values.size != self.size:
            raise ValueError(f"{self._kind.__name__} has {values.size} numbers; {self.size} are declared")
        return values


@cache  # structures of one kind ask for the same again and again
def _declared(
    kind: type[tuple[Any, ...]], given: tuple[tuple[str, int], ...]
) -> tuple[tuple[Quantity, ...], _Field, Callable[[list[float]], Any]]:
    """Variables of a named tuple in order, and what makes one of a list of numbers.

    That is compiled, as named tuples are themselves: it is what kernels in Python do most.
    """
    sizes = dict(given)
    parts: list[_Field] = []
    found: list[Quantity] = []
    for name, hint in get_type_hints(kind, include_extras=True).items():
        if get_origin(hint) is Annotated:
            inner, quantity = get_args(hint)
            part = _field(inner, sizes.get(name, quantity.size))
            if quantity.name not in ("", name):
                raise TypeError(f"{kind.__name__}.{name} is declared as {quantity.name}")
            found.append(
                replace(quantity, name=name, size=part.size, resized=quantity.resized or name in sizes)
            )
            parts.append(part)
        else:
            record = Record(hint, **sizes)
            parts.append(record._field)
            found.extend(record.quantities)
    whole, names = _tuple(parts, kind), {"new": tuple.__new__}
    return tuple(found), whole, eval(f"lambda v: {whole.expression(0, names)}", names)


def _field(hint: Any, count: int) -> _Field:  # noqa: ANN401 - any type
    if hint is float:
        return _SCALAR
    if isinstance(hint, type) and hasattr(hint, "_fields"):
        return _tuple([_field(h, 1) for h in get_type_hints(hint).values()], hint)
    arguments = get_args(hint)
    if arguments[-1] is Ellipsis:
        return _tuple([_field(arguments[0], 1)] * count)
    return _tuple([_field(h, 1) for h in arguments])


_SCALAR = _Field(1, lambda place, _: f"v[{place}]")


def _tuple(inner: Sequence[_Field], kind: type[tuple[Any, ...]] | None = None) -> _Field:
    """A tuple of fields, of a kind of its own where it is named."""
    size = sum(field.size for field in inner)

    def expression(place: int, names: _Names) -> str:
        if all(field is _SCALAR for field in inner):
            values = f"v[{place}:{place + size}]"
        else:
            places = accumulate((field.size for field in inner), initial=place)
            made = (field.expression(at, names) for field, at in zip(inner, places, strict=False))
            values = f"({', '.join(made)},)"
        if kind is None:
            return f"tuple({values})"
        name = f"{kind.__name__}_{len(names)}"
        names[name] = kind
        return f"new({name}, {values})"

    return _Field(size, expression)


def _append_scalars(value: Any, found: list[float]) -> None:  # noqa: ANN401 - a tree of tuples
    for item in value:
        if isinstance(item, tuple):
            _append_scalars(item, found)
        else:
            found.append(item)
