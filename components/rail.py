"""Rail: a trolley guided in a plane at its orientation, with Coulomb friction against its sliding."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Annotated, NamedTuple

from numpy.typing import ArrayLike

from .contract.connection import WRENCH, Connection, Impulse, Inputs
from .contract.frames import (
    Quaternion,
    Vector3,
    conjugate,
    exponential,
    multiply,
    nearest_turn,
    rotate,
    rotation_vector,
    subtract,
)
from .contract.ports import WRENCH_SIZE, PortMotion
from .contract.record import Record, fixed, integrated, kept, observed, tunable
from .contract.roles import (
    DISSIPATED_ENERGY,
    DISSIPATION,
    END_WEIGHT,
    LOAD,
    NUMERICAL_DISSIPATION,
    POTENTIAL_ENERGY,
)
from .numerics.laws import stiction_factors
from .numerics.mid_step import MidStep
from .numerics.relative_motion import Pose, axis_frame, conjugate_torque, relative_pose, relative_rates
from .numerics.stiff_coordinate import Memory, StepMotion, bushing_load, remembered

Four = tuple[float, float, float, float]

_AT_REST: Vector3 = (0.0, 0.0, 0.0)


class _Parameters(NamedTuple):
    normal_stiffness: Annotated[float, tunable("N/m", "Stiffness normal to the plane", 1e6, 0.0)]
    normal_damping: Annotated[float, tunable("N.s/m", "Damping normal to the plane", 0.0, 0.0)]
    rotational_stiffness: Annotated[float, tunable("N.m/rad", "Stiffness against any rotation", 1e4, 0.0)]
    rotational_damping: Annotated[float, tunable("N.m.s/rad", "Damping of any rotation", 0.0, 0.0)]
    friction_force: Annotated[float, tunable("N", "Coulomb friction against sliding", 0.0, 0.0)]
    stiction_velocity: Annotated[float, tunable("m/s", "Speed from which friction is full", 2e-2, 1e-9)]
    initial_offset: Annotated[
        Vector3, fixed("m", "Of the trolley at the start, from its free place, world axes")
    ]
    initial_turn: Annotated[
        Vector3, fixed("rad", "The same of its orientation, rotation vector in world axes")
    ]
    end_weight: Annotated[float, END_WEIGHT]

    @property
    def stiffness(self) -> Four:
        """Of the four stiff coordinates in order."""
        return (self.normal_stiffness, *(self.rotational_stiffness,) * 3)

    @property
    def damping(self) -> Four:
        """The same of damping."""
        return (self.normal_damping, *(self.rotational_damping,) * 3)

    def friction(self, speed: float) -> float:
        """Friction force at a sliding speed."""
        return self.friction_force * stiction_factors(abs(speed), self.stiction_velocity, 1.0).constant

    def resistance(self, speed: float) -> float:
        """Friction force over the sliding speed (N.s/m), finite at rest."""
        if speed == 0.0:
            return 1.5 * self.friction_force / self.stiction_velocity
        return self.friction(speed) / speed


class _State(NamedTuple):
    position: Annotated[Vector3, kept("m", "Free place of the trolley, world axes")]
    orientation: Annotated[Quaternion, kept("1", "Its orientation there")]
    offset: Annotated[Vector3, kept("m", "Offset from there, the first along the normal")]
    turn: Annotated[Vector3, kept("rad", "Turn from there: twist about the normal, swing")]
    memories: Annotated[tuple[Memory, ...], kept("1", "Memories of the stiff coordinates").sized(4)]
    slide: Annotated[MidStep, kept("m/s", "Mean sliding speeds of two steps")]
    friction_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    damping_heat: Annotated[float, integrated("J", "W", "Energy dissipated since the start")]
    numerical: Annotated[float, kept("J", "What inertial terms took away")]
    wrench: Annotated[tuple[float, ...], WRENCH.sized(WRENCH_SIZE)] = (0.0,) * WRENCH_SIZE

    @property
    def stiff(self) -> Four:
        """The four stiff coordinates."""
        return (self.offset[0], *self.turn)


class _Observations(NamedTuple):
    normal_force: Annotated[float, observed("N", "Force on the trolley along the normal", LOAD)]
    friction_force_magnitude: Annotated[
        float, observed("N", "Friction force on the trolley, against its sliding")
    ]
    sliding_speed: Annotated[float, observed("m/s", "Speed of the trolley in the plane")]
    friction_energy: Annotated[float, observed("J", "Energy dissipated by friction", DISSIPATION)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY.saying("Elastic energy of the guidance")]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class _Instant(NamedTuple):
    """Pose against the start, in axes with x along the normal; stiff coordinates (normal, twist, swing y, z).

    velocity: the sliding velocity in the plane's two axes.
    """

    pose: Pose
    stiff: Four
    rates: Four
    velocity: tuple[float, float]

    @property
    def speed(self) -> float:
        """Sliding speed."""
        return _length(*self.velocity)


class Rail(Connection[_Parameters, _State, Impulse]):
    """Guides the trolley port in the plane through its place at the start, at its orientation there.

    A scene that starts in equilibrium has an initial offset and turn from there.

    normal: direction normal to the plane, world axes; the plane is fixed to the ground, so the rail has one port
    only. Stiffness and damping act along the normal and on all rotations; in the plane there is only friction.
    """

    kind, port_names, order = "rail", ("trolley",), 2
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)

    def __init__(self, normal: Sequence[float] = (0.0, 0.0, 1.0), wrench_mode: str = "mean") -> None:
        self._axes = axis_frame(normal, "the normal to the rail's plane", "normal")
        super().__init__({"normal": tuple(normal)}, wrench_mode)

    def start(self, c: _Parameters, u: Inputs[Impulse]) -> _State:
        """The plane goes through the place of the inputs, less the initial offset and turn."""
        (trolley,) = u.motions
        position = subtract(trolley.position, c.initial_offset)
        orientation = multiply(conjugate(exponential(c.initial_turn)), trolley.orientation)
        now = self._instant(position, orientation, u, 0.0)
        memories = tuple(Memory(rate, rate) for rate in now.rates)
        slide = MidStep.starting(now.speed)
        place = (position, orientation, now.pose.offset, now.stiff[1:])
        return _State(*place, memories, slide, 0.0, 0.0, 0.0)

    def led(self, before: Sequence[PortMotion], now: Sequence[PortMotion]) -> Mapping[str, Sequence[float]]:
        """How the trolley has moved and turned."""
        (then,), (here,) = before, now
        turn = multiply(here.orientation, conjugate(then.orientation))
        return {
            "initial_offset": subtract(here.position, then.position),
            "initial_turn": rotation_vector(turn),
        }

    def _instant(
        self, position: Vector3, orientation: Quaternion, u: Inputs[Impulse], reference: float
    ) -> _Instant:
        """The instant of the inputs, seen from a place; the twist is the one nearest the reference."""
        axes = multiply(conjugate(orientation), self._axes)
        motions = (PortMotion(position, orientation, _AT_REST, _AT_REST), *u.motions)
        pose = relative_pose(motions, axes)
        rates = relative_rates(motions, pose)
        twist = nearest_turn(pose.twist, reference)
        return _Instant(
            pose,
            (pose.offset[0], twist, *pose.swing),
            (rates.offset[0], rates.twist, *rates.swing),
            rates.offset[1:],
        )

    def _now(self, s: _State, u: Inputs[Impulse]) -> _Instant:
        return self._instant(s.position, s.orientation, u, s.turn[0])

    def advance(self, c: _Parameters, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """Mean loads of the stiff coordinates, and friction against the mean sliding velocity."""
        now, is_impulse = self._now(s, u), u.commands.impulse > 0.5
        motions = [
            StepMotion(start, end, h, memory)
            for start, end, memory in zip(s.stiff, now.stiff, s.memories, strict=True)
        ]
        if self.endpoint:
            motions = [motion.without_inertia() for motion in motions]
        loads = [
            bushing_load(k, d, motion, c.end_weight)
            for k, d, motion in zip(c.stiffness, c.damping, motions, strict=True)
        ]
        slip_y, slip_z = ((a - b) / h for a, b in zip(now.pose.offset[1:], s.offset[1:], strict=True))
        speed = _length(slip_y, slip_z)
        resistance = c.resistance(speed)
        swing_y, swing_z = (0.5 * (a + b) for a, b in zip(s.stiff[2:], now.stiff[2:], strict=True))
        wrench = _wrench(
            now, [load.force for load in loads], resistance, (slip_y, slip_z), (swing_y, swing_z)
        )
        memories = tuple(
            Memory(rate, rate) if is_impulse else remembered(motion, rate)
            for motion, rate in zip(motions, now.rates, strict=True)
        )
        return s._replace(
            offset=now.pose.offset,
            turn=now.stiff[1:],
            memories=memories,
            slide=MidStep.starting(now.speed) if is_impulse else s.slide.after(speed, h),
            friction_heat=s.friction_heat + resistance * speed * speed * h,
            damping_heat=s.damping_heat + sum(load.heat for load in loads),
            numerical=s.numerical + sum(load.numerical for load in loads),
            wrench=wrench,
        )

    def wrenches(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """On the trolley."""
        now = self._now(s, u)
        load = [
            -k * q - d * w for k, d, q, w in zip(c.stiffness, c.damping, now.stiff, now.rates, strict=True)
        ]
        return _wrench(now, load, c.resistance(now.speed), now.velocity, now.pose.swing)

    def record(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> _Observations:
        """Forces at the communication point, and energies."""
        now = self._now(s, u)
        rate, speed = now.rates[0], now.speed
        if not self.endpoint:
            rate, speed = s.memories[0].mean_rate, s.slide.now()
        return _Observations(
            normal_force=-c.normal_stiffness * now.pose.offset[0] - c.normal_damping * rate,
            friction_force_magnitude=c.friction(speed),
            sliding_speed=now.speed,
            friction_energy=s.friction_heat,
            potential_energy=sum(0.5 * k * q * q for k, q in zip(c.stiffness, now.stiff, strict=True)),
            dissipated_energy=s.friction_heat + s.damping_heat,
            numerical_dissipation=s.numerical,
        )

    def powers(self, c: _Parameters, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat (W) of friction and of damping."""
        now = self._now(s, u)
        damping = sum(d * w * w for d, w in zip(c.damping, now.rates, strict=True))
        return c.resistance(now.speed) * now.speed * now.speed, damping

    def follow(self, c: _Parameters, s: _State, u: Inputs[Impulse], at_event: bool) -> _State:
        """Follow the trolley's turn."""
        twist = self._now(s, u).stiff[1]
        return s._replace(turn=(twist, s.turn[1], s.turn[2]))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Axes of the plane, normal first, and mode."""
        return {**super().native_data(), "axis_frame": self._axes}


def _length(y: float, z: float) -> float:
    return sqrt(y * y + z * z)


def _wrench(
    now: _Instant,
    load: Sequence[float],
    resistance: float,
    velocity: tuple[float, float],
    swing: tuple[float, float],
) -> tuple[float, ...]:
    """Of the loads of the stiff coordinates and of friction against a velocity, world axes."""
    normal, twist, bending_y, bending_z = load
    force = (normal, -resistance * velocity[0], -resistance * velocity[1])
    torque = conjugate_torque(twist, (bending_y, bending_z), swing)
    return (*rotate(now.pose.frame, force), *rotate(now.pose.frame, torque))
