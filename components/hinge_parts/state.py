"""Constants and state of a hinge by name, the motion of its six coordinates over a step, and the loads that follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..contract.component import Vector
from ..contract.frames import Quaternion, Vector3
from ..numerics.laws import Law
from ..numerics.mid_step import MidStep, MidStepSlope
from ..numerics.relative_motion import Passage, Pose, Rates, as_floats
from ..numerics.stiff_coordinate import MeanLoad, Memory, StepMotion

Six = tuple[float, float, float, float, float, float]

NO_LOADS: tuple[MidStepSlope, ...] = (MidStepSlope.starting(0.0),) * 7


@dataclass(frozen=True, slots=True)
class Constants:
    """Parameters as plain numbers and laws; stiffness and damping of the six coordinates in order.

    paired: whether loads are of order 4; static solutions, with an end weight above one half, are of order 2.
    """

    stiffness: Six
    damping: Six
    aligned_angle: float
    stowed_angle: float
    motor: Law
    harness: Law
    friction: float
    static_ratio: float
    pin_radius: float
    bending_arm: float
    friction_preload: float
    stiction_velocity: float
    latches: bool
    locks: bool
    latch: Law
    latch_angle: float
    latch_stiffness: float
    latch_damping: float
    latch_automatic: bool
    lock_mass: float
    lock_inertia: float
    hold_stiffness: float
    end_weight: float
    paired: bool


class State(NamedTuple):
    """The state array by name. Six coordinates: offset x, y, z, hinge angle, swing y, z (hinge axes).

    Of order 4, `loads` are those of the bushing in the six coordinates and of the latch over the last steps, and
    `sliding` is the hinge rate, of which `slide` knows means only.
    """

    frame: Quaternion
    gap: Vector3
    coordinates: tuple[float, ...]
    rates: tuple[float, ...]
    mean_rates: tuple[float, ...]
    end_rates: tuple[float, ...]
    wrench: tuple[float, ...]
    power: tuple[float, ...]
    slide: MidStep
    friction_energy: float
    latch_energy: float
    damping_energy: float
    latched: float
    latched_angle: float
    holding: float
    hold_angle: float
    numerical_dissipation: float
    roughness: tuple[float, ...] = (0.0,) * 6
    slopes: tuple[float, ...] = (0.0,) * 12
    loads: tuple[MidStepSlope, ...] = NO_LOADS
    sliding: MidStepSlope = MidStepSlope.starting(0.0)

    def pack(self) -> Vector:
        """As one array."""
        return np.array(
            (
                *self.frame,
                *self.gap,
                *self.coordinates,
                *self.rates,
                *self.mean_rates,
                *self.end_rates,
                *self.wrench,
                *self.power,
                *self.slide,
                *self[9:17],
                *self.roughness,
                *self.slopes,
                *(value for load in self.loads for value in load),
                *self.sliding,
            )
        )

    @staticmethod
    def unpack(x: Vector) -> State:
        """From the array."""
        v = as_floats(x)
        return State(
            (v[0], v[1], v[2], v[3]),
            (v[4], v[5], v[6]),
            tuple(v[7:13]),
            tuple(v[13:19]),
            tuple(v[19:25]),
            tuple(v[25:31]),
            tuple(v[WRENCH]),
            tuple(v[43:46]),
            MidStep(*v[46:50]),
            *(v[50], v[51], v[52], v[53], v[54], v[55], v[56], v[57]),
            tuple(v[58:64]),
            tuple(v[SLOPES]),
            tuple(MidStepSlope(*v[i : i + 6]) for i in range(_LOADS.start, _LOADS.stop, 6)),
            MidStepSlope(*v[_SLIDING]),
        )

    @property
    def angle(self) -> float:
        """Hinge angle, unwrapped."""
        return self.coordinates[3]

    def commanded(self, latch: float, hold: float) -> State:
        """Latched or held at the angle where the command arrives."""
        state = self
        if latch > 0.5 and not state.latched:
            state = state._replace(latched=1.0, latched_angle=state.angle)
        if hold > 0.5 and not state.holding:
            state = state._replace(hold_angle=state.angle)
        return state._replace(holding=1.0 if hold > 0.5 else 0.0)


WRENCH, SLOPES, _LOADS, _SLIDING = slice(31, 43), slice(64, 76), slice(76, 118), slice(118, 124)
ANGLE, HEAT, LATCHED, HOLDING = 10, 50, 53, 55
HEATS = ("friction_heat", "latch_heat", "damping_heat")


class Loads(NamedTuple):
    """Force and torque on B in hinge axes, torque of latch and of friction, heat of three causes, numerical loss.

    The slopes of force and torque are zero of order 2.
    """

    force: Vector3
    torque: Vector3
    latch_torque: float
    friction_torque: float
    heat: tuple[float, float, float]
    numerical: float
    force_slope: Vector3 = (0.0, 0.0, 0.0)
    torque_slope: Vector3 = (0.0, 0.0, 0.0)


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
    y, z = (0.5 * (a + b) for a, b in zip(old.coordinates[4:], new.coordinates[4:], strict=True))
    return y, z


def motions_of(old: State, new: State, moments: Six, h: float) -> list[StepMotion]:
    """Motions of the six coordinates, with the moments of their rates."""
    memories = map(Memory, old.mean_rates, old.end_rates, old.roughness)
    ends = zip(old.coordinates, new.coordinates, memories, moments, strict=True)
    return [StepMotion(start, end, h, memory, moment) for start, end, memory, moment in ends]


def passage_of(old: State, new: State) -> Passage:
    """Frame and gap at both ends of a step."""
    return Passage(old.frame, new.frame, old.gap, new.gap)


def shifted(motion: StepMotion, origin: float) -> StepMotion:
    """The same motion counted from another origin."""
    return motion._replace(start=motion.start - origin, end=motion.end - origin)


def coordinates_of(pose: Pose, angle: float) -> Six:
    """The six coordinates of a hinge: offset along its axes, angle, swing."""
    return (*pose.offset, angle, *pose.swing)


def rates_of(rates: Rates) -> Six:
    """Rates of the six coordinates."""
    return (*rates.offset, rates.twist, *rates.swing)
