"""Local error of a coupled step from the curvature of its wrenches; coupling/prediction.h computes it for FMUs.

The mean over a step of size h errs by a twelfth of h^2 u'', less the part that slopes cover. The work of such wrenches
on the motion that they cause, over an energy, is the square of a relative error in velocity.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..network import Network
from ..participant import Matrix, Vector
from .convergence import noise
from .history import Bend
from .interface_jacobian import first_port_axes

NO_LOAD = 1e-6
"""Of the load of a step: what was less than this in the step before was none."""


class WeightedLoad(NamedTuple):
    """A torque, or a force, along an axis fixed in a port of a connection, weighted by an energy of its own.

    connection, port: by number, the port within the connection; row: of its first component in the unknown; axis
    (3,): in the axes of the port, unit length; weight: 1 over (2 effective inertia x energy), 1/(kg.m2.J), or mass.
    """

    connection: int
    port: int
    row: int
    axis: tuple[float, float, float]
    weight: float


class Loads(NamedTuple):
    """Mean wrenches (size,) of the step accepted last and of the one at hand."""

    before: Vector
    now: Vector


class Accuracy(NamedTuple):
    """How well the solutions know the wrenches: what the last correction and rounding leave (size,), reach (m)."""

    tolerated: Vector
    rounded: Vector
    reach: float


def error_square(
    network: Network,
    mobilities: Sequence[Matrix],
    bend: Bend,
    accuracy: Accuracy,
    watched: Sequence[WeightedLoad],
    loads: Loads,
    h: float,
    energy: float,
) -> float:
    """Square of the relative error that what bends wrenches makes of velocities.

    Its work over an energy (J), or what it is at a watched load, whichever is larger. What errors left by the
    solutions have in it does not count. mobilities: of all bodies at the present orientations.
    """
    total, left = 0.0, np.zeros(network.size)
    for rows, mobility in zip(network.rows, mobilities, strict=True):
        means, mean_mobility = _of_means(network, rows, mobility)
        change = bend.change[rows][means]
        own = np.diag(mean_mobility)
        unknown = noise(own, accuracy.tolerated[rows][means], accuracy.rounded[rows][means], accuracy.reach)
        left[rows.start + means] = unknown
        total += float(change @ mean_mobility @ change) - bend.gain**2 * float(own @ unknown**2)
    squares = [_watched_square(network, w, bend, left, loads, h) for w in watched]
    return max(0.0, total / energy, *squares)


def jump_work(network: Network, mobilities: Sequence[Matrix], change: Vector) -> float:
    """Work (J) of a jump of wrenches (size,) on the motion that it causes over a step of these mobilities."""
    total = 0.0
    for rows, mobility in zip(network.rows, mobilities, strict=True):
        means, mean_mobility = _of_means(network, rows, mobility)
        total += float(change[rows][means] @ mean_mobility @ change[rows][means])
    return total


def _of_means(network: Network, rows: slice, mobility: Matrix) -> tuple[NDArray[np.intp], Matrix]:
    """Places of mean wrenches among a body's rows, and the mobility (means, means) of poses under them."""
    wrench, coordinates = network.width
    means = np.flatnonzero(np.arange(rows.stop - rows.start) % wrench < 6)
    poses = means // wrench * coordinates + means % wrench
    return means, mobility[np.ix_(poses, means)]


def _watched_square(
    network: Network, w: WeightedLoad, bend: Bend, left: Vector, loads: Loads, h: float
) -> float:
    """All of a load bends in a step that strikes: steps before tell nothing of it, and by chance a part of a jump."""
    along = first_port_axes(network.connections[w.connection].inputs[13 * w.port :]) @ np.array(w.axis)
    rows = slice(w.row, w.row + 3)
    load, unknown = float(along @ bend.change[rows]), bend.gain * float(left[rows].max())
    before, now = (abs(float(along @ wrenches[rows])) for wrenches in loads)
    if before <= NO_LOAD * now:
        load = max(abs(load), now)
    return w.weight * h * h * max(0.0, load**2 - unknown**2)
