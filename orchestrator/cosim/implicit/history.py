"""Wrenches of the last steps: where the next one starts from, and how much they bend.

What orchestrator/cosim/native/prediction.h does for a network of FMUs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..participant import Vector

_POINTS = 3


class Bend(NamedTuple):
    """h^2 u'' of wrenches, (size,), and how much independent errors of the three points grow in it."""

    change: Vector
    gain: float


class History:
    """Mean wrenches (size,) of the last three accepted steps, each at its mid-step time."""

    def __init__(self, size: int) -> None:
        self._times: list[float] = []
        self._values = np.zeros((_POINTS, size))

    def clear(self) -> None:
        """Forget all: something jumped."""
        self._times.clear()

    def add(self, time: float, value: Vector) -> None:
        """Remember one more, and only the last three, the newest in the last row."""
        self._times.append(time)
        del self._times[:-_POINTS]
        self._values[:-1] = self._values[1:]
        self._values[-1] = value

    def extrapolated(self, time: float, points: int = _POINTS) -> Vector | None:
        """Polynomial through the last points; None without any."""
        times = self._times[-points:]
        if not times:
            return None
        result: Vector = np.array(_weights(time, times)) @ self._values[-len(times) :]
        return result

    def curvature(self, time: float, value: Vector, h: float) -> Bend | None:
        """h^2 u'' of the last points and a new one, its mean now and a step before; None with fewer than two.

        What changes sign with every step cancels: the ringing of stiff joints that a change of step stirs.
        """
        if len(self._times) < 2:
            return None
        times = [*self._times, time]
        weights = np.zeros(len(times))
        for first in (len(times) - 3, max(len(times) - 4, 0)):
            for i in range(first, first + 3):
                others = [times[i] - times[j] for j in range(first, first + 3) if j != i]
                weights[i] += h * h / (others[0] * others[1])
        values = np.vstack((self._values[-len(self._times) :], value))
        return Bend(weights @ values, float(np.linalg.norm(weights)))


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
