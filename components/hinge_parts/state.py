"""Constants of a hinge, the motion of its six coordinates over a step, and the loads that follow."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

from ..contract.component import ComponentError
from ..contract.frames import Vector3
from ..numerics.clearance import Clearance
from ..numerics.laws import Law
from ..numerics.presliding import Presliding
from ..numerics.relative_motion import Passage, Pose, Rates
from ..numerics.stiff_coordinate import MeanLoad, StepMotion
from .variables import CLEARANCES, Parameters, Six, State


class Constants(NamedTuple):
    """Parameters, laws, and what follows from the structure.

    stiffness, damping: of the six coordinates in order, 0 where clearances have theirs. play: deflections (rad) of the
    latch between which it has no torque. latch_stiffness, latch_damping: those of a lock where the latch is one.
    paired: whether loads are of order 4.
    """

    p: Parameters
    stiffness: Six
    damping: Six
    clearances: tuple[Clearance, ...]
    motor: Law
    harness: Law
    hysteresis: Law
    latches: bool
    locks: bool
    latch: Law
    play: tuple[float, float]
    latch_stiffness: float
    latch_damping: float
    paired: bool


def clearances_of(p: Parameters) -> tuple[Clearance, ...]:
    """Clearances of a joint, each of the coordinates that have stiffness."""
    found = []
    for name, members in CLEARANCES:
        size, held = float(getattr(p, name)), tuple(i for i in members if p.stiffness[i] > 0.0)
        if size == 0.0:
            continue
        if not held:
            raise ComponentError(f"{name} is {size:g}, but the joint has no stiffness there; give it some")
        first, *others = ((p.stiffness[i], p.damping[i]) for i in held)
        if others and others != [first]:
            raise ComponentError(f"{name} needs equal stiffness, and equal damping, along both cross axes")
        found.append(Clearance(held, size, *first))
    return tuple(found)


def bare(values: Six, loose: Collection[int]) -> Six:
    """The values, 0 of coordinates that clearances have."""
    x, y, z, twist, *swing = (0.0 if i in loose else value for i, value in enumerate(values))
    return (x, y, z, twist, swing[0], swing[1])


class Loads(NamedTuple):
    """Force and torque on B in hinge axes, torque of the latch, friction, heat of three causes, numerical loss.

    The slopes of force and torque are zero of order 2. driving: what turns about the hinge line beside bushing and
    latch, and its slope.
    """

    force: Vector3
    torque: Vector3
    latch_torque: float
    friction: Presliding
    heat: tuple[float, float, float]
    numerical: float
    force_slope: Vector3 = (0.0, 0.0, 0.0)
    torque_slope: Vector3 = (0.0, 0.0, 0.0)
    driving: tuple[float, float] = (0.0, 0.0)


class StiffLoads(NamedTuple):
    """Mean loads of the bushing in the six coordinates and of the latch."""

    bushing: tuple[MeanLoad, ...]
    latch: MeanLoad


class Held(NamedTuple):
    """What bushing (six coordinates) and latch exert at one instant."""

    bushing: tuple[float, ...]
    latch: float


def mean_swing(old: State, new: State) -> tuple[float, float]:
    """Swing in the middle of a step."""
    y, z = (0.5 * (a + b) for a, b in zip(old.swing, new.swing, strict=True))
    return y, z


def motions_of(old: State, new: State, moments: Six, h: float) -> list[StepMotion]:
    """Motions of the six coordinates, with the moments of their rates."""
    ends = zip(old.coordinates, new.coordinates, old.memories, moments, strict=True)
    return [StepMotion(start, end, h, memory, moment) for start, end, memory, moment in ends]


def passage_of(old: State, new: State) -> Passage:
    """Frame and gap at both ends of a step."""
    return Passage(old.frame, new.frame, old.gap, new.gap)


def from_aligned(c: Constants, coordinates: Six) -> Six:
    """The coordinates with the angle counted from where the axes of both ports coincide."""
    x, y, z, angle, *swing = coordinates
    return (x, y, z, angle - c.p.aligned_angle, swing[0], swing[1])


def shifted(motion: StepMotion, origin: float) -> StepMotion:
    """The same motion counted from another origin."""
    return motion._replace(start=motion.start - origin, end=motion.end - origin)


def coordinates_of(pose: Pose, angle: float) -> Six:
    """The six coordinates of a hinge: offset along its axes, angle, swing."""
    return (*pose.offset, angle, *pose.swing)


def rates_of(rates: Rates) -> Six:
    """Rates of the six coordinates."""
    return (*rates.offset, rates.twist, *rates.swing)
