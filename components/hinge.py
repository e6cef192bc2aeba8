"""Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch.

Spherical, revolute, cylindrical, fixed and bushing joints are settings of the six stiffnesses. The wrench
is the mean over the communication step, from the poses at its two ends ("mean"), or the end-point wrench
of the current inputs for hosts that step explicitly ("endpoint").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal, NamedTuple

import numpy as np

from ._component import Component, ComponentError, Port, Quantity, Vector
from ._frames import Quaternion, Vector3, frame_with_x_along, mean, nearest_turn
from ._relative import Pose, Rates, as_floats, mean_direction, pair, relative_pose, relative_rates
from .laws import Law, Linear, Table, mean_force, stiction_factors

LatchKind = Literal["none", "spring", "table", "kinematic"]

_LOCK_RATE_WEIGHT = 1.0 / 3.0
_LOCK_DRIFT_WEIGHT = 0.1
_FORCE_SMOOTHING = 1.0


@dataclass(frozen=True, slots=True)
class _Constants:
    """Parameters as plain numbers and laws."""

    stiffness: Vector3
    damping: Vector3
    turning_stiffness: Vector3
    turning_damping: Vector3
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
    latch: Law
    latch_angle: float
    latch_damping: float
    latch_automatic: bool
    lock_mass: float
    lock_inertia: float
    hold_stiffness: float
    end_weight: float


class _State(NamedTuple):
    """The state array by name; see `_STATE_SIZE` for its length."""

    pose: Pose
    angle: float
    wrench: tuple[float, ...]
    friction_energy: float
    latch_energy: float
    damping_energy: float
    latched: bool
    latched_angle: float
    hold_angle: float
    holding: bool
    lock_torque: float
    lock_step: float
    previous_lock_torque: float
    previous_lock_step: float
    power: tuple[float, float, float]

    def pack(self) -> Vector:
        """As one array."""
        p = self.pose
        return np.array(
            (*p.frame, *p.gap, *p.offset, p.twist, *p.swing, self.angle, *self.wrench, *self[3:14], *self[14])
        )

    @staticmethod
    def unpack(x: Vector) -> _State:
        """From the array."""
        v = as_floats(x)
        pose = Pose((v[0], v[1], v[2], v[3]), (v[4], v[5], v[6]), (v[7], v[8], v[9]), v[10], (v[11], v[12]))
        return _State(
            pose, v[13], tuple(v[14:26]), v[26], v[27], v[28], v[29] > 0.5, v[30], v[31], v[32] > 0.5, *v[33:37],
            (v[37], v[38], v[39]),
        )  # fmt: skip


class _Loads(NamedTuple):
    """Force and torque on B in hinge axes, the torque parts about the hinge line, and energies turned to heat."""

    force: Vector3
    torque: Vector3
    latch_torque: float
    friction_energy: float
    latch_energy: float
    damping_energy: float


class Hinge(Component):
    """A hinge between an inboard and an outboard port.

    axis: direction of the hinge line in the axes of both ports when they coincide; the hinge angle grows
    with the right-handed rotation of the outboard port about it. harness_angle, harness_torque: table of
    the harness torque over the hinge angle (rad, N.m), positive opening; empty for no harness. latch: "none",
    "spring" (linear, zero at the angle where it engages), "table" (latch_deflection, latch_torque: torque
    of the spring over the deflection from there, given as resisting torque) or "kinematic" (an impulse that removes the
    relative rate, then a lock). wrench_mode: "mean" or "endpoint"; in endpoint mode a kinematic latch acts as
    a spring latch, because an explicit host cannot solve for a lock.
    """

    kind = "hinge"

    def __init__(
        self,
        axis: Sequence[float] = (0.0, 1.0, 0.0),
        harness_angle: Sequence[float] = (),
        harness_torque: Sequence[float] = (),
        latch: LatchKind = "none",
        latch_deflection: Sequence[float] = (),
        latch_torque: Sequence[float] = (),
        wrench_mode: Literal["mean", "endpoint"] = "mean",
    ) -> None:
        if latch not in ("none", "spring", "table", "kinematic"):
            raise ComponentError(f"latch is {latch!r}; it must be none, spring, table or kinematic")
        if wrench_mode not in ("mean", "endpoint"):
            raise ComponentError(f"wrench_mode is {wrench_mode!r}; it must be mean or endpoint")
        try:
            self._axis_frame: Quaternion = frame_with_x_along((axis[0], axis[1], axis[2]))
        except ValueError:
            raise ComponentError("axis has no length; give the direction of the hinge line") from None
        self._harness: Law = Table(harness_angle, harness_torque) if len(harness_angle) else Linear(0.0)
        self._latch_table = Table(latch_deflection, [-t for t in latch_torque]) if latch == "table" else None
        self.latch = latch
        self._endpoint = wrench_mode == "endpoint"
        self._locks = latch == "kinematic" and not self._endpoint
        self._declare(
            {
                "axis": tuple(axis),
                "harness_angle": tuple(harness_angle),
                "harness_torque": tuple(harness_torque),
                "latch": latch,
                "latch_deflection": tuple(latch_deflection),
                "latch_torque": tuple(latch_torque),
                "wrench_mode": wrench_mode,
            },
            ports=[Port("inboard", "connection"), Port("outboard", "connection")],
            parameters=_parameters(),
            inputs=_inputs(),
            outputs=_outputs(),
            observations=_observations(),
            feedthrough=self._endpoint,
        )

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        value = {
            q.name: as_floats(p[self.parameter_layout[q.name]]) for q in self.parameter_layout.quantities
        }
        one = {name: values[0] for name, values in value.items()}
        three = {name: (v[0], v[1], v[2]) for name, v in value.items() if len(v) == 3}
        latch: Law = self._latch_table or Linear(one["latch_stiffness"])
        return _Constants(
            stiffness=three["translational_stiffness"],
            damping=three["translational_damping"],
            turning_stiffness=three["rotational_stiffness"],
            turning_damping=three["rotational_damping"],
            aligned_angle=one["aligned_angle"],
            stowed_angle=one["stowed_angle"],
            motor=Linear(one["motor_stiffness"], one["motor_wind_up"]),
            harness=self._harness,
            friction=one["friction_coefficient"],
            static_ratio=one["static_friction_ratio"],
            pin_radius=one["pin_radius"],
            bending_arm=one["friction_bending_arm"],
            friction_preload=one["friction_preload"],
            stiction_velocity=one["stiction_velocity"],
            latch=latch,
            latch_angle=one["latch_angle"],
            latch_damping=one["latch_damping"],
            latch_automatic=one["latch_automatic"] > 0.5,
            lock_mass=one["lock_mass"],
            lock_inertia=one["lock_inertia"],
            hold_stiffness=one["hold_stiffness"],
            end_weight=one["end_weight"],
        )

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """Unlatched, at the pose of the inputs; the angle is the one nearest the stowed angle."""
        pose = relative_pose(as_floats(u), self._axis_frame)
        angle = nearest_turn(c.aligned_angle + pose.twist, c.stowed_angle)
        return _State(
            pose, angle, (0.0,) * 12, 0.0, 0.0, 0.0, False, 0.0, angle, False, 0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0)
        ).pack()  # fmt: skip

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step; the inputs are those of its end. Commands act from its start."""
        values = as_floats(u)
        old = self._commanded(_State.unpack(x), values[26], values[28])
        pose = relative_pose(values, self._axis_frame)
        angle = nearest_turn(c.aligned_angle + pose.twist, old.angle)
        rates = relative_rates(values, pose)
        if self._endpoint:
            return self._endpoint_step(c, old, pose, angle, rates, h)
        impulse = values[27] > 0.5
        loads = (
            self._impulse_loads(c, old, angle, rates, h)
            if impulse
            else self._mean_loads(c, old, pose, angle, rates, h)
        )
        force = mean_direction(old.pose.frame, pose.frame, loads.force)
        torque = mean_direction(old.pose.frame, pose.frame, loads.torque)
        lock = (0.0,) * 4 if impulse else (loads.latch_torque, h, old.lock_torque, old.lock_step)
        return _State(
            pose,
            angle,
            pair(force, torque, mean(old.pose.gap, pose.gap)),
            old.friction_energy + loads.friction_energy,
            old.latch_energy + loads.latch_energy,
            old.damping_energy + loads.damping_energy,
            old.latched,
            old.latched_angle,
            old.hold_angle,
            old.holding,
            *lock,
            old.power,
        ).pack()

    @staticmethod
    def _commanded(state: _State, latch: float, hold: float) -> _State:
        """Latch or hold at the angle where the command arrives."""
        if latch > 0.5 and not state.latched:
            state = state._replace(
                latched=True, latched_angle=state.angle, lock_step=0.0, previous_lock_step=0.0
            )
        holding = hold > 0.5
        if holding and not state.holding:
            state = state._replace(hold_angle=state.angle)
        return state._replace(holding=holding)

    def _mean_loads(
        self, c: _Constants, old: _State, pose: Pose, angle: float, rates: Rates, h: float
    ) -> _Loads:
        """Mean loads over a step from the poses at its ends (discrete gradients and mean rates)."""
        w = c.end_weight
        v = 1.0 - w
        k, d, s0, s1 = c.stiffness, c.damping, old.pose.offset, pose.offset
        step = (s1[0] - s0[0], s1[1] - s0[1], s1[2] - s0[2])
        force = (
            -k[0] * (v * s0[0] + w * s1[0]) - d[0] * step[0] / h,
            -k[1] * (v * s0[1] + w * s1[1]) - d[1] * step[1] / h,
            -k[2] * (v * s0[2] + w * s1[2]) - d[2] * step[2] / h,
        )
        kr, dr, t0, t1 = c.turning_stiffness, c.turning_damping, old.pose.swing, pose.swing
        turn = (t1[0] - t0[0], t1[1] - t0[1])
        bend_y = -kr[1] * (v * t0[0] + w * t1[0]) - dr[1] * turn[0] / h
        bend_z = -kr[2] * (v * t0[1] + w * t1[1]) - dr[2] * turn[1] / h
        change = angle - old.angle
        heat = (
            sum(d[i] * step[i] * step[i] for i in range(3)) / h
            + (dr[0] * change * change + dr[1] * turn[0] * turn[0] + dr[2] * turn[1] * turn[1]) / h
        )
        if w != 0.5:
            heat += (w - 0.5) * (
                sum(k[i] * step[i] * step[i] for i in range(3))
                + kr[1] * turn[0] * turn[0]
                + kr[2] * turn[1] * turn[1]
            )
        friction = self._friction(c, old.latched, force, (bend_y, bend_z), change / h)
        latch, latch_heat = self._latch(c, old, angle, rates, h)
        twist = (
            mean_force(c.motor, old.angle, angle, w)
            + mean_force(c.harness, old.angle, angle, w)
            - kr[0] * (v * (old.angle - c.aligned_angle) + w * (angle - c.aligned_angle))
            - dr[0] * change / h
            + friction
            + latch
        )
        if old.holding:
            twist -= c.hold_stiffness * (angle - old.hold_angle)
        return _Loads(force, (twist, bend_y, bend_z), latch, -friction * change, latch_heat, heat)

    @staticmethod
    def _friction(
        c: _Constants, latched: bool, force: Vector3, bending: tuple[float, float], rate: float
    ) -> float:
        """Coulomb torque mu r_p F_r + T_pre against the sliding rate (Bagnoli 2007, eq 2.2)."""
        preload = 0.0 if latched else c.friction_preload
        normal = sqrt(force[1] * force[1] + force[2] * force[2] + _FORCE_SMOOTHING**2) - _FORCE_SMOOTHING
        if c.bending_arm > 0.0:
            normal += sqrt(bending[0] * bending[0] + bending[1] * bending[1]) / c.bending_arm
        sliding, constant = stiction_factors(rate, c.stiction_velocity, c.static_ratio)
        return -(c.friction * c.pin_radius * normal * sliding + preload * constant)

    def _latch(self, c: _Constants, old: _State, angle: float, rates: Rates, h: float) -> tuple[float, float]:
        """Mean latch torque, and the energy it turned to heat."""
        if not old.latched or self.latch == "none":
            return 0.0, 0.0
        change = angle - old.angle
        if self._locks:
            slip = (
                _LOCK_RATE_WEIGHT * rates.angular_velocity[0]
                + (1.0 - _LOCK_RATE_WEIGHT) * change / h
                + _LOCK_DRIFT_WEIGHT * (angle - old.latched_angle) / h
            )
            torque = -c.lock_inertia * slip / h
            return torque, -torque * change
        s0, s1 = old.angle - old.latched_angle, angle - old.latched_angle
        viscous = -c.latch_damping * change / h
        elastic = mean_force(c.latch, s0, s1, c.end_weight)
        heat = -viscous * change - (elastic - mean_force(c.latch, s0, s1)) * change
        return elastic + viscous, heat

    def _impulse_loads(self, c: _Constants, old: _State, angle: float, rates: Rates, h: float) -> _Loads:
        """Loads that remove the relative rate in every stiff direction at the end of a vanishing step.

        An ideal joint transmits a latch impulse through its constrained directions in no time; a bushing
        would only do so after ringing at its own frequency.
        """
        k, kr, v, w = c.stiffness, c.turning_stiffness, rates.velocity, rates.angular_velocity
        mass, inertia = c.lock_mass / h, c.lock_inertia / h
        locked = old.latched and self._locks
        latch = -inertia * w[0] if locked else 0.0
        twist = latch if locked or kr[0] == 0.0 else -inertia * w[0]
        force = (
            -mass * v[0] if k[0] > 0.0 else 0.0,
            -mass * v[1] if k[1] > 0.0 else 0.0,
            -mass * v[2] if k[2] > 0.0 else 0.0,
        )
        torque = (twist, -inertia * w[1] if kr[1] > 0.0 else 0.0, -inertia * w[2] if kr[2] > 0.0 else 0.0)
        return _Loads(force, torque, 0.0, 0.0, -latch * (angle - old.angle), 0.0)

    def _endpoint_loads(self, c: _Constants, state: _State, pose: Pose, angle: float, rates: Rates) -> _Loads:
        """Loads of one instant; the last three fields are powers (W) instead of energies."""
        k, d, s, v = c.stiffness, c.damping, pose.offset, rates.velocity
        kr, dr, w = c.turning_stiffness, c.turning_damping, rates.angular_velocity
        force = (-k[0] * s[0] - d[0] * v[0], -k[1] * s[1] - d[1] * v[1], -k[2] * s[2] - d[2] * v[2])
        bend_y = -kr[1] * pose.swing[0] - dr[1] * w[1]
        bend_z = -kr[2] * pose.swing[1] - dr[2] * w[2]
        friction = self._friction(c, state.latched, force, (bend_y, bend_z), w[0])
        latch = viscous = 0.0
        if state.latched and self.latch != "none":
            if self._locks:
                latch = _extrapolated(state)
            else:
                viscous = -c.latch_damping * w[0]
                latch = c.latch.value(angle - state.latched_angle) + viscous
        twist = (
            c.motor.value(angle)
            + c.harness.value(angle)
            - kr[0] * (angle - c.aligned_angle)
            - dr[0] * w[0]
            + friction
            + latch
        )
        if state.holding:
            twist -= c.hold_stiffness * (angle - state.hold_angle)
        heat = sum(d[i] * v[i] * v[i] + dr[i] * w[i] * w[i] for i in range(3))
        return _Loads(force, (twist, bend_y, bend_z), latch, -friction * w[0], -viscous * w[0], heat)

    def _endpoint_step(
        self, c: _Constants, old: _State, pose: Pose, angle: float, rates: Rates, h: float
    ) -> Vector:
        """Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule."""
        state = old._replace(pose=pose, angle=angle)
        if c.latch_automatic and not old.latched and self.latch != "none" and angle >= c.latch_angle:
            state = state._replace(latched=True, latched_angle=c.latch_angle)
        loads = self._endpoint_loads(c, state, pose, angle, rates)
        power = (loads.friction_energy, loads.latch_energy, loads.damping_energy)
        added = [0.5 * h * (a + b) for a, b in zip(old.power, power, strict=True)]
        return state._replace(
            friction_energy=old.friction_energy + added[0],
            latch_energy=old.latch_energy + added[1],
            damping_energy=old.damping_energy + added[2],
            power=power,
        ).pack()

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, distance to the latch angle, latched or not."""
        if not self._endpoint:
            latched = x[29]
            return np.concatenate((x[14:26], (c.latch_angle - x[13], latched)))
        values = as_floats(u)
        state = _State.unpack(x)
        pose = relative_pose(values, self._axis_frame)
        angle = nearest_turn(c.aligned_angle + pose.twist, state.angle)
        loads = self._endpoint_loads(c, state, pose, angle, relative_rates(values, pose))
        force = mean_direction(pose.frame, pose.frame, loads.force)
        torque = mean_direction(pose.frame, pose.frame, loads.torque)
        return np.array((*pair(force, torque, pose.gap), c.latch_angle - angle, float(state.latched)))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Angles, torques and forces of this instant (end-point law), and energies."""
        values = as_floats(u)
        state = _State.unpack(x)
        pose = relative_pose(values, self._axis_frame)
        angle = nearest_turn(c.aligned_angle + pose.twist, state.angle)
        rates = relative_rates(values, pose)
        loads = self._endpoint_loads(c, state, pose, angle, rates)
        radial = sqrt(loads.force[1] ** 2 + loads.force[2] ** 2)
        bending = sqrt(loads.torque[1] ** 2 + loads.torque[2] ** 2)
        friction = self._friction(c, state.latched, loads.force, loads.torque[1:], rates.angular_velocity[0])
        stored = self._stored(c, state, pose, angle)
        released = c.motor.potential(c.stowed_angle) - c.motor.potential(angle)
        heat = (state.friction_energy, state.latch_energy, state.damping_energy)
        return np.array(
            (
                angle,
                rates.angular_velocity[0],
                c.motor.value(angle),
                c.harness.value(angle),
                friction,
                loads.latch_torque,
                loads.force[0],
                radial,
                bending,
                released,
                *heat,
                stored,
                sum(heat),
            )
        )

    def _stored(self, c: _Constants, state: _State, pose: Pose, angle: float) -> float:
        """Energy in bushing, motor, harness, latch and hold."""
        energy = sum(0.5 * k * s * s for k, s in zip(c.stiffness, pose.offset, strict=True))
        swing = (angle - c.aligned_angle, *pose.swing)
        energy += sum(0.5 * k * s * s for k, s in zip(c.turning_stiffness, swing, strict=True))
        energy += c.motor.potential(angle) + c.harness.potential(angle)
        if state.latched and not self._locks and self.latch != "none":
            energy += c.latch.potential(angle - state.latched_angle)
        if state.holding:
            energy += 0.5 * c.hold_stiffness * (angle - state.hold_angle) ** 2
        return energy

    @classmethod
    def example(cls) -> Hinge:
        """A hinge with harness and spring latch."""
        return cls(
            axis=(0.0, -1.0, 0.0),
            harness_angle=(0.0, 1.5, 3.2),
            harness_torque=(0.2, 0.05, -0.1),
            latch="spring",
        )


def _extrapolated(state: _State) -> float:
    """Lock torque at the communication point: mean torques belong to mid-step, so extrapolate the last two."""
    if state.lock_step == 0.0 or state.previous_lock_step == 0.0:
        return state.lock_torque
    slope = (state.lock_torque - state.previous_lock_torque) / (state.lock_step + state.previous_lock_step)
    return state.lock_torque + slope * state.lock_step


def _parameters() -> list[Quantity]:
    def tunable(
        name: str, unit: str, text: str, start: float = 0.0, minimum: float | None = 0.0, size: int = 1
    ) -> Quantity:
        return Quantity(name, unit, text, size, start, minimum, variability="tunable")

    return [
        tunable(
            "translational_stiffness",
            "N/m",
            "Stiffness along hinge line and the two radial directions",
            size=3,
        ),
        tunable(
            "translational_damping", "N.s/m", "Damping along hinge line and the two radial directions", size=3
        ),
        tunable(
            "rotational_stiffness", "N.m/rad", "Stiffness about hinge line and the two cross axes", size=3
        ),
        tunable("rotational_damping", "N.m.s/rad", "Damping about hinge line and the two cross axes", size=3),
        tunable("aligned_angle", "rad", "Hinge angle where the axes of both ports coincide", minimum=None),
        tunable("stowed_angle", "rad", "Hinge angle of the stowed configuration", minimum=None),
        tunable("motor_stiffness", "N.m/rad", "Rate of the motorisation spring"),
        tunable(
            "motor_wind_up", "rad", "Hinge angle at which the motorisation spring is relaxed", minimum=None
        ),
        tunable("friction_coefficient", "1", "Coulomb friction coefficient of the hinge pin, sliding"),
        tunable("static_friction_ratio", "1", "Static over sliding friction coefficient", 1.2, 1.0),
        tunable("pin_radius", "m", "Radius of the hinge pin", 0.006),
        tunable(
            "friction_bending_arm", "m", "Arm that turns bending moment into pin force; 0 switches it off"
        ),
        tunable("friction_preload", "N.m", "Constant friction torque; 0 from latch-up on"),
        tunable("stiction_velocity", "rad/s", "Stiction transition velocity as a hinge rate", 0.0167, 1e-9),
        tunable("latch_angle", "rad", "Hinge angle where the latch engages", minimum=None),
        tunable("latch_stiffness", "N.m/rad", "Stiffness of a spring latch"),
        tunable("latch_damping", "N.m.s/rad", "Damping of a spring or table latch"),
        tunable("latch_automatic", "1", "1: latch at the latch angle without command (endpoint mode)", 1.0),
        tunable(
            "lock_mass", "kg", "Numerical: mass that an ideal joint sets against residual velocity", 1e6, 1.0
        ),
        tunable(
            "lock_inertia", "kg.m2", "Numerical: inertia that a lock sets against residual rate", 1e6, 1.0
        ),
        tunable("hold_stiffness", "N.m/rad", "Stiffness that holds the angle while hold is 1", 1e7),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
    ]


def _inputs() -> list[Quantity]:
    return [
        Quantity(
            "latch_command", "1", "1: the latch engages at the start of the next step", variability="discrete"
        ),
        Quantity(
            "impulse", "1", "1: the next step is an impulse through ideal joints", variability="discrete"
        ),
        Quantity("hold", "1", "1: the angle is held", variability="discrete"),
    ]


def _outputs() -> list[Quantity]:
    return [
        Quantity("latch_distance", "rad", "Latch angle minus hinge angle; falls through zero at latch-up"),
        Quantity("latched", "1", "1 from latch-up on"),
    ]


def _observations() -> list[Quantity]:
    return [
        Quantity("angle", "rad", "Hinge angle, unwrapped"),
        Quantity("angular_rate", "rad/s", "Hinge rate"),
        Quantity("motor_torque", "N.m", "Torque of the motorisation spring, positive opening"),
        Quantity("harness_torque", "N.m", "Torque of the harness, positive opening"),
        Quantity("friction_torque", "N.m", "Friction torque, positive opening"),
        Quantity("latch_torque", "N.m", "Torque of the latch about the hinge line, positive opening"),
        Quantity("axial_force", "N", "Force on the outboard side along the hinge line"),
        Quantity("radial_force", "N", "Magnitude of the force normal to the hinge line"),
        Quantity("bending_moment", "N.m", "Magnitude of the moment normal to the hinge line"),
        Quantity("motor_energy", "J", "Energy released by the motorisation spring since the stowed angle"),
        Quantity("friction_energy", "J", "Energy dissipated by friction"),
        Quantity("latch_energy", "J", "Energy dissipated by the latch, its impulse included"),
        Quantity("damping_energy", "J", "Energy dissipated by the damping of the joint"),
        Quantity("potential_energy", "J", "Energy in bushing, motorisation spring, harness and latch"),
        Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
    ]
