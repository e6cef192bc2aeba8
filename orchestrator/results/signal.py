"""Signals of a result as arrays that know their unit and times, at an instant and between rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from itertools import pairwise
from math import copysign, prod, sqrt
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, DTypeLike, NDArray

from components.numerics.scheme import CREST_SURE

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


class Peak(NamedTuple):
    """An extreme value and when it happened (s)."""

    time: float
    value: float


def matches(key: tuple[str, str], pattern: str) -> bool:
    """Whether a signal is one of a pattern's, of its component or of COMPONENT.VARIABLE, as of file names."""
    return fnmatchcase(key[0], pattern) or fnmatchcase(".".join(key), pattern)


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
    if time.size == 1:
        return Place(0, 0, 0.0)
    right = min(max(first, 1), time.size - 1)
    share = float((asked - time[right - 1]) / (time[right] - time[right - 1]))
    return Place(right - 1, right, min(max(share, 0.0), 1.0))


def maxima_near(time: Vector, values: Vector, top: int) -> Iterator[Peak]:
    """The sample, and the maxima of the cubics on the two intervals beside it, each through four samples around it."""
    yield Peak(float(time[top]), float(values[top]))
    for left in (top - 1, top):
        if 0 <= left < time.size - 1:
            first = min(max(left - 1, 0), time.size - 4)
            nodes = slice(first, first + 4)
            ends = float(time[left]), float(time[left + 1])
            for found in _cubic_maxima(time[nodes], values[nodes], *ends):
                rise = found.value - float(values[top])
                if rise > 0.0 and rise > CREST_SURE * _off(time, values, first, found.time):
                    yield found


def _off(time: Vector, values: Vector, first: int, at: float) -> float:
    """What the cubic through four samples may be off by at a time: as it misses the samples beside them, in between.

    The error of interpolation goes with the product of the distances to its samples. One through a kink misses by much.
    """
    nodes = slice(first, first + 4)
    samples, scale = time[nodes].tolist(), float(time[first + 3] - time[first])
    third, second, slope, value = _cubic(samples, values[nodes].tolist(), at, scale)

    def distances(t: float) -> float:
        return float(prod(abs(t - sample) for sample in samples))

    def miss(k: int) -> float:
        x, sample = float(time[k] - at) / scale, float(values[k])
        return abs(((third * x + second) * x + slope) * x + value - sample)

    beside = [k for k in (first - 1, first + 4) if 0 <= k < time.size]
    misses = (miss(k) / far for k in beside if (far := distances(float(time[k]))))
    return max(misses, default=np.inf) * distances(at)


def _cubic_maxima(time: Vector, values: Vector, left: float, right: float) -> Iterator[Peak]:
    """Stationary points within [left, right] of the cubic through four samples."""
    samples = time.tolist()
    if not all(before < after for before, after in pairwise(samples)):
        return
    scale = samples[3] - samples[0]
    third, second, slope, value = _cubic(samples, values.tolist(), left, scale)
    for root in _stationary(third, second, slope):
        if 0.0 <= root * scale <= right - left:
            height = ((third * root + second) * root + slope) * root + value
            yield Peak(left + root * scale, height)


def _cubic(time: Sequence[float], values: Sequence[float], origin: float, scale: float) -> tuple[float, ...]:
    """Coefficients, of the third power first, of the cubic through four samples in x = (t - origin) / scale.

    By divided differences (Newton's form), in plain floats: signals have thousands of such stretches.
    """
    x0, x1, x2, x3 = ((t - origin) / scale for t in time)
    v0, v1, v2, v3 = values
    d01, d12, d23 = (v1 - v0) / (x1 - x0), (v2 - v1) / (x2 - x1), (v3 - v2) / (x3 - x2)
    d012, d123 = (d12 - d01) / (x2 - x0), (d23 - d12) / (x3 - x1)
    third = (d123 - d012) / (x3 - x0)
    return (
        third,
        d012 - third * (x0 + x1 + x2),
        d01 - d012 * (x0 + x1) + third * (x0 * x1 + x0 * x2 + x1 * x2),
        v0 - x0 * (d01 - x1 * (d012 - x2 * third)),
    )


def _stationary(third: float, second: float, first: float) -> Iterator[float]:
    """Where the slope of a cubic is zero, by its coefficients; without cancellation."""
    square = second**2 - 3.0 * third * first
    if square >= 0.0:
        larger = -(second + copysign(sqrt(square), second))
        if third:
            yield larger / (3.0 * third)
        if larger:
            yield first / larger
