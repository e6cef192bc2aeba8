"""How far a body turns in a step: the outcome of the iteration, and Newton's correction of it.

The angular velocity at the end follows from the momentum there in axes that the mean angular velocity turns, so the
mean is found by iteration. From mean to end and back contracts by h/2 times the momentum over the geometric mean of the
moments of inertia across it: a slender body that turns by 0.1 rad a step, a thousand times as hard to turn across as
along, is led away from its motion. Newton's iteration contracts for any inertia.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contract.component import ComponentError, Vector
from ..contract.frames import skew
from .load import Load
from .second_order import solved

MAX_ITERATIONS = 40
_ANGLE_TOLERANCE = 1e-13
_DEFLECTION_TOLERANCE = 1e-14  # energies of bending follow from deflections that are small angles themselves
_ANGLE_ROUNDING = 1e-9  # rad that a slender body's turn may keep changing by from iteration to iteration
_SLENDER = 20.0  # ratio of moments of inertia from which what a body turns by in a step tells in its mobility


class Turned(NamedTuple):
    """Outcome of a step's iteration: angular velocity, mean and end, arms at both ends, modes at the end, heat.

    omega, arms and rate_moment, the first moment of the angular velocity (rad), are in body axes, that of mid-step;
    world_arms are those of the start. modal_moment: of the modal rates. eta_mean: where wrenches acted.
    """

    omega: Vector
    end: Vector
    world_arms: Vector
    arms: Vector
    eta: Vector
    pi: Vector
    heat: float
    rate_moment: Vector
    modal_moment: Vector
    eta_mean: Vector


class Ending(NamedTuple):
    """A step's end, by the present iterate: J - B B^T (3, 3), momentum (3,) and arms (ports, 3) in body axes there.

    moment_slope (3,): of the moment over the step, in the axes of mid-step; axes (3, 3): rotation of the end.
    """

    inertia: Vector
    momentum: Vector
    arms: Vector
    moment_slope: Vector
    axes: Vector


def is_slender(inertia: Vector) -> bool:
    """Whether the mobility of a body of this inertia (3, 3) hangs on its angular velocity."""
    return bool(np.linalg.cond(inertia) > _SLENDER)


def newton_turn(end: Ending, load: Load, omega: Vector, missing: Vector, h: float) -> Vector:
    """What takes the mean angular velocity omega of a step h (s) on, from by how much the next one misses it."""
    # slopes change the mean moment and their own by turns that cancel
    force = load.force @ end.axes
    lever = end.arms.T @ force - np.diag((float(np.vdot(end.arms, force)),) * 3)
    by_end = skew(0.5 * h * end.momentum) + (0.25 * h * h) * lever
    tangent = end.inertia - by_end @ _turn_of_end(h * omega) + skew((h * h / 12.0) * end.moment_slope)
    return solved(tangent, end.inertia @ missing)


def is_found(change: Vector, h: float) -> bool:
    """Whether an iteration that changed the mean angular velocity of a step h (s) by this, (3,), has come to rest."""
    return h * float(abs(change).max()) < _ANGLE_TOLERANCE


def change_of(inertia: Vector, last: Vector, end: Vector) -> float:
    """By how much an iteration deflected a body, from modal coordinates to others (M,): as an angle (rad).

    It is the angle whose turn moves the mass as far; inertia: (3, 3).
    """
    return float(np.linalg.norm(end - last) / np.sqrt(0.5 * np.trace(inertia)))


def settled(change: float, before: float) -> bool:
    """Whether the next iteration would change the deflection (rad) by less, if it does as this one did."""
    return change <= _DEFLECTION_TOLERANCE or change * change <= _DEFLECTION_TOLERANCE * before


def refuse_unsettled(change: Vector, h: float, *, deflected: bool = True) -> None:
    """Refuse a step (s) whose iterations are used up, unless only rounding is left; deflected: and the modes rest."""
    if deflected and h * float(abs(change).max()) < _ANGLE_ROUNDING:
        return
    raise ComponentError(
        f"a step of {h:g} s comes to no end in {MAX_ITERATIONS} iterations of turn and deflection;"
        " take smaller steps or loads"
    )


def _turn_of_end(turn: Vector) -> Vector:
    """The right Jacobian (3, 3) of a rotation vector (rad), as a series: by what its changes turn the end of a step."""
    square, cross = float(turn @ turn), skew(turn)
    found: Vector = np.eye(3) - (0.5 - square / 24.0) * cross + (1.0 / 6.0 - square / 120.0) * (cross @ cross)
    return found
