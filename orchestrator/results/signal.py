"""Signals of a result as arrays that know their unit and times, at an instant and between rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ..records import short_repr
from .parts import Event
from .result import Result, ResultError, Vector

Side = Literal["before", "after"]
"""Which of the values that an instant may have: those before or those after what happens there."""
EVENT_WIDTH = 2e-7
"""Samples this close to an event (s) are samples of the event: a latch impulse is a step of 1e-7 s."""
_BEYOND = 1e-9
"""Of the end time; round-off of summed steps."""


class Place(NamedTuple):
    """A time between two rows: their numbers, and how much of the way from one to the other."""

    left: int
    right: int
    share: float


def matches(key: tuple[str, str], pattern: str) -> bool:
    """Whether a signal is one of a pattern's, of its component or of COMPONENT.VARIABLE, as of file names."""
    return fnmatchcase(key[0], pattern) or fnmatchcase(".".join(key), pattern)


@short_repr
@dataclass(frozen=True, eq=False)
class Signal(NDArrayOperatorsMixin):
    """A recorded signal; NumPy takes it for the array of its values, and what is computed from it is a plain array.

    values: shape (N,), or (N, size) of a vector quantity. time: s, shape (N,). unit: in FMI syntax.
    """

    values: Vector
    time: Vector
    unit: str
    name: str
    description: str = ""
    events: Sequence[Event] = field(default=(), repr=False)

    def at(self, times: ArrayLike, side: Side = "after") -> NDArray[np.float64]:
        """Values at times (s), shape of the times, then (size,) of a vector; see `Result.at` about events."""
        try:
            asked = np.asarray(times, dtype=float)
        except (TypeError, ValueError):
            raise ResultError(f"{self.name}: {times!r} are no times; give numbers, in s") from None
        is_flag = _is_flag(self.values)
        found = np.array(
            [_at(self.time, self.values, self.events, float(t), side, is_flag) for t in asked.ravel()]
        )
        return found.reshape(asked.shape + self.values.shape[1:])

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the values."""
        return self.values.shape

    @property
    def ndim(self) -> int:
        """1, or 2 of a vector quantity."""
        return self.values.ndim

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, key: Any) -> Any:  # noqa: ANN401 - whatever NumPy takes and gives
        return self.values[key]

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.values, dtype=dtype, copy=copy)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **keywords: Any) -> Any:  # noqa: ANN401
        plain = (one.values if isinstance(one, Signal) else one for one in inputs)
        return getattr(ufunc, method)(*plain, **keywords)


@short_repr
@dataclass(frozen=True, slots=True)
class Instant:
    """All signals of a result at one time (s): `instant["hinge", "angle"]`, () or (size,) of a vector."""

    result: Result
    time: float
    side: Side

    def __getitem__(self, key: tuple[str, str]) -> NDArray[np.float64]:
        result = self.result
        values = result.signal(*key)
        return _at(result.time, values, result.events, self.time, self.side, _is_flag(values))


def instant(result: Result, time: float, side: Side = "after") -> Instant:
    """A result at one time (s); ResultError where the run does not reach there."""
    _refuse_outside(result.time, time)
    if side not in ("before", "after"):
        raise ResultError(f"the side of an instant is {side!r}; it must be 'before' or 'after'")
    return Instant(result, time, side)


def _refuse_outside(time: Vector, asked: float) -> None:
    margin = _BEYOND * float(time[-1])
    if not time[0] - margin <= asked <= time[-1] + margin:
        raise ResultError(
            f"there is nothing at t = {asked:g} s; the result goes from {time[0]:g} to {time[-1]:g} s"
        )


def _is_flag(values: Vector) -> bool:
    """Whether a signal has nothing between its values."""
    return bool(np.isin(values, (0.0, 1.0)).all())


def _at(
    time: Vector, values: Vector, events: Sequence[Event], asked: float, side: Side, is_flag: bool
) -> NDArray[np.float64]:
    """Values at a time: those of the first or last of the rows that share an instant, else between two rows."""
    left, right, share = _between(time, events, asked, side)
    if is_flag and share < 1.0:
        return np.asarray(values[left])
    return np.asarray(values[left] + share * (values[right] - values[left]))


def values_at(values: Vector, places: Sequence[Place]) -> Vector:
    """Values (k,) or (k, size) of a signal at the places of k times."""
    left, right, share = (np.array(part) for part in zip(*places, strict=True))
    weight = share.reshape(-1, *(1 for _ in values.shape[1:]))
    found: Vector = values[left] + weight * (values[right] - values[left])
    return found


def places(result: Result, times: ArrayLike) -> list[Place]:
    """Where times (k,) in s lie in a result: after what happens there, see `Result.at`; ResultError outside of it."""
    asked = np.asarray(times, dtype=float).tolist()
    return [_between(result.time, result.events, one, "after") for one in asked]


def _between(time: Vector, events: Sequence[Event], asked: float, side: Side) -> Place:
    _refuse_outside(time, asked)
    near = min((event[0] for event in events), key=lambda event: abs(event - asked), default=np.inf)
    low, high = (
        (near - EVENT_WIDTH, near + EVENT_WIDTH) if abs(near - asked) <= EVENT_WIDTH else (asked, asked)
    )
    first, beyond = int(np.searchsorted(time, low)), int(np.searchsorted(time, high, side="right"))
    if first < beyond:
        row = first if side == "before" else beyond - 1
        return Place(row, row, 0.0)
    if not time[0] < asked < time[-1]:
        row = 0 if asked < time[0] else time.size - 1
        return Place(row, row, 0.0)
    share = float((asked - time[first - 1]) / (time[first] - time[first - 1]))
    return Place(first - 1, first, share)
