"""Maxima of cubics through samples, because a peak lies between samples."""

from __future__ import annotations

from collections.abc import Iterable
from math import prod
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from components.numerics.scheme import CREST_SURE

from .result import Vector

T = TypeVar("T", float, Vector)


class Peak(NamedTuple):
    """An extreme value and when it happened (s)."""

    time: float
    value: float


def highest_crest(time: Vector, values: Vector, tops: NDArray[np.intp], above: float) -> Peak | None:
    """The highest maximum above a value of the cubics on the two intervals next to each of some samples.

    Each cubic goes through four samples around its interval. None if no maximum exceeds its sample by more than the
    error of its cubic.
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
    """Error of the cubic through four samples at a time, interpolated from its errors at the adjacent samples.

    The error of interpolation goes with the product of the distances to its samples. It is large for one through a
    kink.
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
