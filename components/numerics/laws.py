"""Scalar force laws that have a potential, and their exact mean over a step.

A law gives the generalised force `value(s) = -V'(s)` and the potential `potential(s) = V(s)` of one
coordinate. `mean_force` is the discrete gradient: the mean force whose work over the step equals the change
of potential, whatever the step.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ..contract.component import ComponentError
from .monotone_cubic import monotone_cubics
from .scheme import LEAST_CHANGE


class Law(Protocol):
    """A scalar force law."""

    def value(self, s: float) -> float:
        """Force -V'(s)."""

    def potential(self, s: float) -> float:
        """Potential V(s)."""

    def tangent(self, s0: float, s1: float) -> float:
        """Divided difference of V' between two coordinates, V'' where they are one."""


def mean_force(law: Law, s0: float, s1: float) -> float:
    """Mean force of a law between the coordinates at both ends of a step.

    The discrete gradient, and the force at the middle where the difference is too small to divide by.
    """
    change = s1 - s0
    middle = 0.5 * (s0 + s1)
    return (
        (law.potential(s0) - law.potential(s1)) / change if abs(change) > LEAST_CHANGE else law.value(middle)
    )


class Linear:
    """Spring and a constant force: f0 - k (s - s_free), with the free coordinate s_free of the spring."""

    __slots__ = ("constant", "free", "stiffness")

    def __init__(self, stiffness: float, free: float = 0.0, constant: float = 0.0) -> None:
        self.stiffness = stiffness
        self.free = free
        self.constant = constant

    def value(self, s: float) -> float:
        """Force at s."""
        return self.constant - self.stiffness * (s - self.free)

    def potential(self, s: float) -> float:
        """Energy at s."""
        stretch = s - self.free
        # as in the native law: a power may round differently
        return (0.5 * self.stiffness * stretch - self.constant) * stretch

    def tangent(self, s0: float, s1: float) -> float:
        """The stiffness."""
        return self.stiffness


class Sum:
    """Laws that act together."""

    __slots__ = ("laws",)

    def __init__(self, *laws: Law) -> None:
        self.laws = laws

    def value(self, s: float) -> float:
        """Force at s."""
        return sum(law.value(s) for law in self.laws)

    def potential(self, s: float) -> float:
        """Energy at s."""
        return sum(law.potential(s) for law in self.laws)

    def tangent(self, s0: float, s1: float) -> float:
        """Sum of the tangents."""
        return sum(law.tangent(s0, s1) for law in self.laws)


class SlackSpring:
    """Tension-only strand: force -k (s + s0) while taut, zero while slack; s0 the elongation of the preload."""

    __slots__ = ("preload_elongation", "stiffness")

    def __init__(self, stiffness: float, preload: float) -> None:
        self.stiffness = stiffness
        self.preload_elongation = preload / stiffness

    def value(self, s: float) -> float:
        """Force at elongation s from the preloaded state; minus the tension."""
        elongation = s + self.preload_elongation
        return -self.stiffness * elongation if elongation > 0.0 else 0.0

    def potential(self, s: float) -> float:
        """Energy at elongation s."""
        elongation = s + self.preload_elongation
        return 0.5 * self.stiffness * elongation * elongation if elongation > 0.0 else 0.0

    def taut_share(self, s0: float, s1: float) -> float:
        """Share of the way between two elongations on which the strand is taut."""
        slack = -self.preload_elongation
        if s0 > slack and s1 > slack:
            return 1.0
        if s0 <= slack and s1 <= slack:
            return 0.0
        return (max(s1, slack) - max(s0, slack)) / (s1 - s0)

    def tangent(self, s0: float, s1: float) -> float:
        """The stiffness while taut."""
        return self.stiffness * self.taut_share(s0, s1)


class Table:
    """Force given at points; monotone cubic between them, straight with the end slope beyond.

    Two points make a straight line. Piecewise cubic Hermite interpolation does not overshoot the data. straight: lines
    lie between the points.
    """

    __slots__ = ("_breaks", "_force", "_potential")

    def __init__(
        self, coordinates: Sequence[float], forces: Sequence[float], *, straight: bool = False
    ) -> None:
        s = np.asarray(coordinates, dtype=float)
        f = np.asarray(forces, dtype=float)
        if s.ndim != 1 or s.size < 2 or s.shape != f.shape:
            raise ComponentError("a table needs at least two points and as many values as coordinates")
        if not np.all(np.diff(s) > 0.0):
            raise ComponentError(f"the coordinates of a table must increase; they are {s.tolist()}")
        span = float(s[-1] - s[0])
        chords, none = np.diff(f) / np.diff(s), np.zeros(s.size - 1)
        own = np.array((none, none, chords, f[:-1])) if straight else monotone_cubics(s, f)
        width = float(s[-1] - s[-2])
        first, last = own[2, 0], (3.0 * own[0, -1] * width + 2.0 * own[1, -1]) * width + own[2, -1]
        below, above = (0.0, 0.0, first, f[0] - first * span), (0.0, 0.0, last, f[-1])
        pieces = [below, *own.T.tolist(), above]
        self._breaks = [float(s[0]) - span, *s.tolist(), float(s[-1]) + span]
        self._force = [(float(a), float(b), float(c), float(d)) for a, b, c, d in pieces]
        self._potential: list[tuple[float, float, float, float, float]] = []
        energy = 0.0
        for (a, b, c, d), width in zip(self._force, np.diff(self._breaks).tolist(), strict=True):
            piece = (-a / 4.0, -b / 3.0, -c / 2.0, -d, energy)
            self._potential.append(piece)
            energy = float(np.polyval(piece, width))

    def native_data(self, name: str) -> dict[str, ArrayLike]:
        """What a native kernel reads: breaks, and per piece the coefficients of force and potential."""
        return {
            f"{name}_breaks": self._breaks,
            f"{name}_force": self._force,
            f"{name}_potential": self._potential,
        }

    def _piece(self, s: float) -> tuple[int, float]:
        i = min(max(bisect_right(self._breaks, s) - 1, 0), len(self._force) - 1)
        return i, s - self._breaks[i]

    def value(self, s: float) -> float:
        """Force at s."""
        i, t = self._piece(s)
        a, b, c, d = self._force[i]
        return ((a * t + b) * t + c) * t + d

    def potential(self, s: float) -> float:
        """Energy at s, zero at an arbitrary point."""
        i, t = self._piece(s)
        a, b, c, d, e = self._potential[i]
        return (((a * t + b) * t + c) * t + d) * t + e

    def tangent(self, s0: float, s1: float) -> float:
        """Minus the mean slope of the force between both; of one piece without a difference of forces."""
        (i, t0), (j, t1) = self._piece(s0), self._piece(s1)
        if i != j and abs(s1 - s0) > LEAST_CHANGE:
            return (self.value(s0) - self.value(s1)) / (s1 - s0)
        if i != j:
            i, t0 = self._piece(0.5 * (s0 + s1))
            t1 = t0
        a, b, c, _ = self._force[i]
        return -(a * (t0 * t0 + t0 * t1 + t1 * t1) + b * (t0 + t1) + c)


def share_beyond(play: tuple[float, float], s0: float, s1: float) -> float:
    """Share of the way between two coordinates that lies outside of a play; all of it where there is none."""
    low, high = play
    if low == high:
        return 1.0
    within = min(max(s1, low), high) - min(max(s0, low), high)
    if s0 == s1 or within == s1 - s0:
        return 0.0 if low < 0.5 * (s0 + s1) < high else 1.0
    return 1.0 - within / (s1 - s0)


def cubic_step(s: float) -> float:
    """STEP: s^2 (3 - 2 s) from 0 to 1, constant before and after."""
    t = min(max(s, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


class StictionFactors(NamedTuple):
    """Signed factors on dynamic Coulomb friction and on a constant friction."""

    dynamic: float
    constant: float


def static_factor(rate: float, transition: float, static_ratio: float) -> float:
    """Factor on dynamic Coulomb friction: static up to a rate, falling smoothly to 1 at 1.5 times that."""
    return static_ratio + (1.0 - static_ratio) * cubic_step(2.0 * (abs(rate) / transition - 1.0))


def stiction_factors(rate: float, transition: float, static_ratio: float) -> StictionFactors:
    """Factors at a sliding rate.

    Rises smoothly to the static value at the stiction transition velocity, falls to the dynamic one between
    1 and 1.5 times it; the second factor stays at 1 beyond the transition. Both are odd in the rate.
    """
    ratio = abs(rate) / transition
    constant = ratio * (1.5 - 0.5 * ratio * ratio) if ratio < 1.0 else 1.0
    dynamic = static_factor(rate, transition, static_ratio) * constant
    return StictionFactors(dynamic, constant) if rate >= 0.0 else StictionFactors(-dynamic, -constant)
