"""Wrenches of the last steps: where the next one starts from, and how much they bend.

What fmus/native/coupling/prediction.h does for a network of FMUs.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import prod
from typing import Any, NamedTuple

import numpy as np

from ..participant import Vector
from ..ports import Width

Table = np.ndarray[Any, np.dtype[np.float64]]

_POINTS = 3


class Bend(NamedTuple):
    """What bends mean wrenches over a step, (size,), and how much independent errors of the points grow in it.

    h^2 u'' at order 2. At order 4 what rates r, that slopes give, do not tell of it, h^2 (u'' - r'), by a formula that
    vanishes for cubic wrenches: -h^4 u''''/12 where slopes are right. Slopes of joints that a step does not resolve are
    not, and do nothing: a component with a slope bends no more than h^3 u'''/12, which is more than that of a resolved
    vibration. Zero in the rows of slopes.
    """

    change: Vector
    gain: float


class History:
    """Wrenches (wrenches, width.wrench) of the last three accepted steps, each at its mid-step time.

    A slope, half the change over a step, is remembered as a rate (1/s).
    """

    def __init__(self, wrenches: int, width: Width) -> None:
        self._times: list[float] = []
        self._values = np.zeros((_POINTS, wrenches, width.wrench))

    def clear(self) -> None:
        """Forget all: something jumped."""
        self._times.clear()

    def add(self, time: float, value: Vector, h: float) -> None:
        """Remember those of a step h, and only the last three, the newest in the last row."""
        self._times.append(time)
        del self._times[:-_POINTS]
        self._values[:-1] = self._values[1:]
        self._values[-1] = self._with_rates(value, h)

    def points(self) -> tuple[Table, Table]:
        """Times and values of the points there are, slopes as rates, oldest first."""
        count = len(self._times)
        return np.array(self._times), self._values[_POINTS - count :].reshape(count, -1).copy()

    def take(self, times: Table, values: Table) -> None:
        """Such points in place of those there are."""
        self._times[:] = times.tolist()
        self._values[_POINTS - len(times) :] = values.reshape(len(times), *self._values.shape[1:])

    def _with_rates(self, value: Vector, h: float) -> Table:
        table = value.reshape(self._values.shape[1:]).copy()
        table[:, 6:] *= 2.0 / h
        return table

    def extrapolated(self, time: float, h: float, points: int = _POINTS) -> Vector | None:
        """Polynomial through the last points in the middle of a step h; None without any."""
        times = self._times[-points:]
        if not times:
            return None
        table = np.tensordot(_weights(time, times), self._values[-len(times) :], 1)
        table[:, 6:] *= 0.5 * h
        result: Vector = table.ravel()
        return result

    def curvature(self, time: float, value: Vector, h: float) -> Bend | None:
        """Of the last points and a new one, its mean now and a step before; None with fewer than two.

        What changes sign with every step cancels: the ringing of stiff joints that a change of step stirs.
        """
        if len(self._times) < 2:
            return None
        times = [*self._times, time]
        weigh = _unknown_curvature if self._values.shape[2] > 6 else _curvature
        weights = np.zeros((2, len(times)))
        for first in (len(times) - 3, max(len(times) - 4, 0)):
            weights[:, first : first + 3] += 0.5 * np.array(weigh(times[first : first + 3], h))
        values = np.concatenate((self._values[-len(self._times) :], [self._with_rates(value, h)]))
        change = np.zeros(values.shape[1:])
        change[:, :6] = np.tensordot(weights[0], values[..., :6], 1)
        if values.shape[2] > 6:
            change[:, :6] += np.tensordot(weights[1], values[..., 6:], 1)
        weights[1] *= 2.0 / h
        gain = float(np.linalg.norm(weights))
        if values.shape[2] > 6 and len(times) > _POINTS:
            of_means = np.array(_third_difference(times, h))
            most = np.tensordot(of_means, values[..., :6], 1)
            limited = (values[-1, :, 6:] != 0.0) & (np.abs(most) < np.abs(change[:, :6]))
            change[:, :6] = np.where(limited, most, change[:, :6])
            gain = min(gain, float(np.linalg.norm(of_means)))
        return Bend(change.ravel(), gain)


def _curvature(times: Sequence[float], h: float) -> tuple[list[float], list[float]]:
    """Weights of three points, and none of their rates, in h^2 u''."""
    weights = []
    for i, time in enumerate(times):
        a, b = (time - other for j, other in enumerate(times) if j != i)
        weights.append(2.0 * h * h / (a * b))
    return weights, [0.0] * 3


def _unknown_curvature(times: Sequence[float], h: float) -> tuple[list[float], list[float]]:
    """Weights of three points and of their rates in -2 h^4 times the fourth divided difference, outer points doubled.

    In equal steps the second difference of u less h/2 times that of its rates.
    """
    a, b, c = times
    scale = -2.0 * h**4
    of_a, of_c = scale / ((a - b) * (a - c) ** 2), scale / ((c - b) * (c - a) ** 2)
    means = [
        -of_a * (1.0 / (a - b) + 2.0 / (a - c)),
        scale / ((b - a) * (b - c)) ** 2,
        -of_c * (1.0 / (c - b) + 2.0 / (c - a)),
    ]
    return means, [of_a, 0.0, of_c]


def _third_difference(times: Sequence[float], h: float) -> list[float]:
    """Weights of four points in a twelfth of h^3 times the third derivative."""
    return [
        0.5 * h**3 / prod(time - other for j, other in enumerate(times) if j != i)
        for i, time in enumerate(times)
    ]


def _weights(time: float, times: list[float]) -> tuple[float, ...]:
    """Lagrange's weights of one to three points at another time."""
    if len(times) == 1:
        return (1.0,)
    if len(times) == 2:
        share = (time - times[0]) / (times[1] - times[0])
        return 1.0 - share, share
    a, b, c = times
    to_a, to_b, to_c = time - a, time - b, time - c
    return (
        to_b * to_c / ((a - b) * (a - c)),
        to_a * to_c / ((b - a) * (b - c)),
        to_a * to_b / ((c - a) * (c - b)),
    )
