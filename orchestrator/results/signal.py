"""Signals of a result as arrays that know their unit and times, at an instant and between rows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from math import prod
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, DTypeLike, NDArray

from components.numerics.scheme import CREST_SURE

from .parts import Event
from .result import Result, ResultError, Vector

T = TypeVar("T", float, Vector)
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


def highest_crest(time: Vector, values: Vector, tops: NDArray[np.intp], above: float) -> Peak | None:
    """The highest maximum above a value of the cubics on the two intervals beside each of some samples.

    Each cubic goes through four samples around its interval. None where no crest rises above its sample by more than
    its cubic may be off by.
    """
    own, left = np.concatenate([tops, tops]), np.concatenate([tops - 1, tops])
    first = np.clip(left - 1, 0, time.size - 4)
    rising = np.min(np.diff(time[first[:, None] + np.arange(4)], axis=1), axis=1) > 0.0
    among = (left >= 0) & (left < time.size - 1) & rising
    own, left, first = own[among], left[among], first[among]
    nodes = first + np.arange(4)[:, None]
    scale = time[first + 3] - time[first]
    third, second, slope, value = _cubic(time[nodes], values[nodes], time[left], scale)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        roots = _stationary(third, second, slope)
        height = ((third * roots + second) * roots + slope) * roots + value
        at, rise = time[left] + roots * scale, height - values[own]
    found = (roots >= 0.0) & (roots * scale <= time[left + 1] - time[left]) & (rise > 0.0) & (height > above)
    which, number = np.nonzero(found)
    for k in np.argsort(-height[which, number], kind="stable"):
        place = which[k], number[k]
        when = float(at[place])
        if rise[place] > CREST_SURE * _off(time, values, int(first[number[k]]), when):
            return Peak(when, float(height[place]))
    return None


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
        return float(abs(((third * x + second) * x + slope) * x + value - sample))

    beside = [k for k in (first - 1, first + 4) if 0 <= k < time.size]
    misses = (miss(k) / far for k in beside if (far := distances(float(time[k]))))
    return max(misses, default=np.inf) * distances(at)


def _cubic(time: Iterable[T], values: Iterable[T], origin: T, scale: T) -> tuple[T, T, T, T]:
    """Coefficients, of the third power first, of the cubic through four samples in x = (t - origin) / scale.

    By divided differences (Newton's form), of one cubic in floats or of many in arrays.
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


def _stationary(third: Vector, second: Vector, first: Vector) -> Vector:
    """Where slopes of cubics (n,) are zero, by coefficients without cancellation, (2, n); not finite where nowhere."""
    larger = -(second + np.copysign(np.sqrt(second * second - 3.0 * third * first), second))
    return np.stack([larger / (3.0 * third), first / larger])
