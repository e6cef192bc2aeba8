"""Records: named tuples whose fields declare the variables of a flat array, once, with name, unit and size."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
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
    return Quantity("", "1", description, variability="discrete")


class _Field(NamedTuple):
    """Number of scalars of a type, and what makes a value of them."""

    size: int
    make: Callable[[list[float]], Any]


_Part = tuple[slice, Callable[[list[float]], Any]]
"""Where the numbers of a field are, and what makes a value of them."""


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
        self.quantities, self._parts = _declared(kind, tuple(sizes.items()))
        self.size = sum(quantity.size for quantity in self.quantities)

    def of(self, v: list[float]) -> T:
        """The named tuple of as many numbers."""
        return self._kind(*(make(v[part]) for part, make in self._parts))

    def read(self, values: Vector) -> T:
        """The named tuple of a flat array (size,)."""
        return self.of(values.tolist())

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
) -> tuple[tuple[Quantity, ...], tuple[_Part, ...]]:
    """Variables of a named tuple in order, and where the numbers of each field are."""
    sizes, position = dict(given), 0
    parts: list[_Part] = []
    found: list[Quantity] = []
    for name, hint in get_type_hints(kind, include_extras=True).items():
        if get_origin(hint) is Annotated:
            inner, quantity = get_args(hint)
            size, make = _field(inner, sizes.get(name, quantity.size))
            if quantity.name not in ("", name):
                raise TypeError(f"{kind.__name__}.{name} is declared as {quantity.name}")
            found.append(replace(quantity, name=name, size=size, resized=quantity.resized or name in sizes))
        else:
            part = Record(hint, **sizes)
            size, make = part.size, part.of
            found.extend(part.quantities)
        parts.append((slice(position, position + size), make))
        position += size
    return tuple(found), tuple(parts)


def _field(hint: Any, count: int) -> _Field:  # noqa: ANN401 - any type
    if hint is float:
        return _Field(1, lambda v: v[0])
    if isinstance(hint, type) and hasattr(hint, "_fields"):
        return _tuple([_field(h, 1) for h in get_type_hints(hint).values()], hint)
    arguments = get_args(hint)
    if arguments[-1] is Ellipsis:
        return _tuple([_field(arguments[0], 1)] * count)
    return _tuple([_field(h, 1) for h in arguments])


def _tuple(inner: Sequence[_Field], kind: Callable[..., Any] | None = None) -> _Field:
    """A tuple of fields, of a kind of its own where it is named."""
    ends = np.cumsum([0, *(f.size for f in inner)]).tolist()
    if ends[-1] == len(inner):
        return _Field(ends[-1], (lambda v: kind(*v)) if kind else tuple)
    parts = [(slice(a, b), f.make) for a, b, f in zip(ends, ends[1:], inner, strict=False)]

    def make(v: list[float]) -> Any:  # noqa: ANN401 - any type
        values = (build(v[part]) for part, build in parts)
        return kind(*values) if kind else tuple(values)

    return _Field(ends[-1], make)


def _append_scalars(value: Any, found: list[float]) -> None:  # noqa: ANN401 - a tree of tuples
    for item in value:
        if isinstance(item, tuple):
            _append_scalars(item, found)
        else:
            found.append(item)
