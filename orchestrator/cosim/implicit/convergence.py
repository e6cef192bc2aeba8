"""When the wrenches of a coupled step agree, and the update that makes them agree sooner."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt
from typing import NamedTuple

import numpy as np

from ..participant import Matrix, ParticipantError, Vector
from ..ports import Width

MAX_ITERATIONS = 14
REFRESHED = (2, 4, 8)
"""Iterations after which slow contraction has matrices refreshed: first only turned, then those of connections probed
anew, at last those of bodies as well, which cost tens of sweeps."""
LAST_REFRESHED = REFRESHED[-1]
SLOW = 0.15
"""Contraction beyond which turning pays; probing costs several iterations, see `is_too_slow`."""
PATIENCE = 8
"""Steps with slow contraction, though fast enough, after which probing pays for those to come."""
OVERSHOT = 0.5
"""Part of the step before, and cosine against it, from which a correction takes it back; see `overshoots`."""
ROUGH = 1e-5
"""Least relative correction of wrenches that takes one back; smaller ones may be round-off of laws and joints."""
LEAST_REACH = 1.0
"""m, of positions whose rounding ports have at least: bodies reach beyond their ports, which may lie in the origin."""
HALVINGS = 24
"""Most halvings of an iteration's steps: a way of a radian comes down to where friction of 1e-7 rad sticks."""
DIVERGED = 50.0
STEEPEST = 0.9
ROUND_OFF = 8.0 * float(np.finfo(float).eps)
NEAR = 1e-2
"""Largest relative correction of wrenches that are near a solution; beyond it they may be absurd."""
CREDIBLE = 1e12
"""Largest residual over wrench at a solution; stiff joints leave up to 1e5, matrices of an absurd motion 1e30."""

AGREED = 300.0
"""Largest residual over the tolerance of a correction that needs no further sweep."""


class Solution(NamedTuple):
    """Outcome of a coupled step: whether it converged, sweeps taken, size of the last correction (scaled).

    failure: what a participant said that refused a sweep, as it may under absurd wrenches of an iteration.
    """

    converged: bool
    iterations: int
    correction: float
    worst_row: int
    failure: ParticipantError | None = None


@dataclass(slots=True)
class Tolerance:
    """Convergence limits of the correction of wrenches: relative to the largest force and torque, and to these.

    residual: below this many tolerances a larger correction is round-off, as between joints that constrain a loop more
    than once.
    """

    relative: float
    force: float = 1.0
    torque: float = 1.0
    residual: float = 0.0

    @classmethod
    def beside(cls, load: float, relative: float) -> Tolerance:
        """Relative to a force (N) and a torque (N.m) of the same number, and to what is larger."""
        return cls(relative, load, load)

    def scale(self, wrenches: Vector) -> Vector:
        """What a correction of 1 means for every row."""
        table = np.abs(wrenches).reshape(-1, 2, 3)
        force = self.relative * (self.force + float(table[:, 0].max(initial=0.0)))
        torque = self.relative * (self.torque + float(table[:, 1].max(initial=0.0)))
        return np.tile(np.repeat((force, torque), 3), len(table))

    def is_near(self, correction: float) -> bool:
        """Whether a scaled correction is small enough for the wrenches to be those of a solution nearby."""
        return correction * self.relative <= NEAR


def is_too_slow(correction: float, last: float, iteration: int) -> bool:
    """Whether the contraction of two scaled corrections does not get there in the iterations that are left."""
    return correction * (correction / last) ** (MAX_ITERATIONS - iteration) > 1.0


def leaves_little(correction: float, last: float) -> bool:
    """Whether all scaled corrections to come, which shrink like the last, add up to less than 1: slow ones may not."""
    return last == 0.0 or correction <= 1.0 - correction / last


def overshoots(correction: Vector, before: Vector, last: float) -> bool:
    """Whether a scaled correction, larger than round-off, takes back the step before without being smaller.

    Newton's method goes to and fro for ever between two branches of a law that bends within its steps, as friction does
    that slides on one side of where it sticks and on the other. last: size of the correction before.
    """
    size = float(np.abs(correction).max(initial=0.0))
    length = sqrt(float(before @ before) * float(correction @ correction))
    return size >= OVERSHOT * last and -float(before @ correction) > OVERSHOT * length


def is_credible(wrenches: Vector, residual: Vector) -> bool:
    """Whether wrenches like these can leave this residual.

    A small correction says nothing of a motion gone astray, whose matrices make any residual small.
    """
    wrench = 1.0 + float(np.abs(wrenches).max(initial=0.0))
    return float(np.abs(residual).max(initial=0.0)) <= CREDIBLE * wrench


class Extent(NamedTuple):
    """Largest component of the positions (m) and of the velocities (m/s) and angular velocities of a network.

    A port that a latch just stopped, or that lies in the origin, still sums terms of that size.
    """

    reach: float
    rate: float

    @classmethod
    def of(cls, motions: Iterable[Vector]) -> Extent:
        """From the motions of all ports of every connection, 13 numbers a port."""
        table = np.abs(np.concatenate([motion.reshape(-1, 13) for motion in motions]))
        return cls(max(LEAST_REACH, float(table[:, :3].max())), float(table[:, 7:].max()))


def round_off(stiffness: Matrix, width: Width, extent: Extent, h: float) -> Vector:
    """Wrenches that the rounding of a connection's motions makes: ports cannot agree better than that."""
    sizes = np.full((len(stiffness) // width.wrench, width.coordinates), extent.rate * h)
    sizes[:, :3] = extent.reach
    sizes[:, 3:6] = 1.0
    sizes[:, -6:] = extent.rate
    result: Vector = ROUND_OFF * (np.abs(stiffness) @ sizes.ravel())
    return result


def noise(mobility: Vector, tolerated: Vector, rounded: Vector, reach: float) -> Vector:
    """Errors of the mean wrenches of a body that a solution may leave, all arrays (6 ports,).

    mobility: how far a port moves under its own wrench; tolerated: the last correction; rounded: see `round_off`.
    Rounding of a pose makes no more than the wrench that moves the port by it.
    """
    pose = ROUND_OFF * np.tile(np.repeat((reach, 1.0), 3), len(mobility) // 6)
    moved = rounded * mobility
    free = np.divide(pose, mobility, out=rounded.copy(), where=pose < moved)
    result: Vector = np.maximum(tolerated, free)
    return result


def broyden(direction: Vector, steps: list[Vector]) -> Vector:
    """Broyden's update of a chord Newton direction from the steps taken so far (scaled), without a matrix."""
    for before, after in pairwise(steps):
        direction = direction + after * (float(before @ direction) / float(before @ before))
    if steps:
        newest = steps[-1]
        slope = float(newest @ direction) / float(newest @ newest)
        if slope < STEEPEST:
            direction = direction / (1.0 - slope)
    return direction
