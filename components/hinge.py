"""Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch.

Spherical, revolute, cylindrical, fixed and bushing joints are settings of the six stiffnesses. The wrench
is the mean over the communication step, from the poses at its two ends ("mean"), or the end-point wrench
of the current inputs for hosts that step explicitly ("endpoint").
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ._bushing import StepMotion, bushing_force, inertial_force, remembered
from ._component import Component, ComponentError, Port, Vector
from ._frames import Vector3, mean, nearest_turn, rotate
from ._hinge_state import (
    ANGLE,
    HEAT,
    HEATS,
    HOLDING,
    LATCHED,
    WRENCH,
    Constants,
    Loads,
    State,
    coordinates_of,
    mean_swing,
    motion_of,
    rates_of,
    shifted,
)
from ._hinge_variables import inputs, observations, outputs, parameters
from ._midstep import MidStepRate
from ._relative import (
    as_floats,
    axis_frame,
    conjugate_torque,
    dissipated_energies,
    gives_end_point,
    mean_direction,
    pair,
    relative_pose,
    relative_rates,
)
from .laws import Law, Linear, Table, mean_force, stiction_factors

LatchKind = Literal["none", "spring", "table", "kinematic"]
_LATCH_KINDS = ("none", "spring", "table", "kinematic")

_FORCE_SMOOTHING = 1.0
_REACHED = 1e-9  # distance (rad) from the latch angle that a solver may leave when it has found the event


class Hinge(Component):
    """A hinge between an inboard and an outboard port.

    axis: direction of the hinge line in the axes of both ports when they coincide; the hinge angle grows
    with the right-handed rotation of the outboard port about it. harness_angle, harness_torque: table of
    the harness torque over the hinge angle (rad, N.m), positive opening; empty for no harness. latch:
    "none", "spring" (linear, zero at the angle where it engages), "table" (latch_torque, resisting, over
    latch_deflection from that angle) or "kinematic" (an impulse that removes the relative rate, then a
    lock). wrench_mode: "mean" or "endpoint"; in endpoint mode a kinematic latch acts as a spring latch,
    because an explicit host cannot solve for a lock.
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
        if latch not in _LATCH_KINDS:
            raise ComponentError(f"latch is {latch!r}; it must be none, spring, table or kinematic")
        self._endpoint = gives_end_point(wrench_mode)
        self._axis_frame = axis_frame(axis, "the hinge line")
        self._harness: Law = Table(harness_angle, harness_torque) if len(harness_angle) else Linear(0.0)
        self._latch_table = Table(latch_deflection, [-t for t in latch_torque]) if latch == "table" else None
        self.latch = latch
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
            parameters=parameters(),
            inputs=inputs(),
            outputs=outputs(),
            observations=observations(),
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = dissipated_energies(HEAT, HEATS, indicators=int(latch != "none"))

    def prepare(self, p: Vector) -> Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        value = {
            q.name: as_floats(p[self.parameter_layout[q.name]]) for q in self.parameter_layout.quantities
        }
        one = {name: values[0] for name, values in value.items()}
        three = {name: (v[0], v[1], v[2]) for name, v in value.items() if len(v) == 3}
        stiffness, damping = one["latch_stiffness"], one["latch_damping"]
        if self._locks:
            stiffness, damping = one["lock_stiffness"], 0.0
        return Constants(
            stiffness=(*three["translational_stiffness"], *three["rotational_stiffness"]),
            damping=(*three["translational_damping"], *three["rotational_damping"]),
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
            latch=self._latch_table or Linear(stiffness),
            latch_angle=one["latch_angle"],
            latch_stiffness=stiffness,
            latch_damping=damping,
            latch_automatic=one["latch_automatic"] > 0.5,
            lock_mass=one["lock_mass"],
            lock_inertia=one["lock_inertia"],
            hold_stiffness=one["hold_stiffness"],
            end_weight=one["end_weight"],
        )

    def initial(self, c: Constants, u: Vector) -> Vector:
        """Unlatched, at the pose of the inputs; the angle is the one nearest the stowed angle."""
        values = as_floats(u)
        pose = relative_pose(values, self._axis_frame)
        rates = relative_rates(values, pose)
        angle = nearest_turn(c.aligned_angle + pose.twist, c.stowed_angle)
        return State(
            pose.frame,
            pose.gap,
            coordinates_of(pose, angle),
            *((rates_of(rates),) * 3),
            (0.0,) * 12,
            (0.0,) * 3,
            MidStepRate.starting(rates.twist),
            *((0.0,) * 6),
            angle,
        ).pack()

    def step(self, c: Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step; the inputs are those of its end. Commands act from its start."""
        values = as_floats(u)
        old = State.unpack(x).commanded(values[26], values[28])
        pose = relative_pose(values, self._axis_frame)
        end = coordinates_of(pose, nearest_turn(c.aligned_angle + pose.twist, old.angle))
        rates = rates_of(relative_rates(values, pose))
        moved = old._replace(frame=pose.frame, gap=pose.gap, coordinates=end, rates=rates)
        if self._endpoint:
            return self._endpoint_step(c, old, moved, h).pack()
        impulse = values[27] > 0.5
        motions = [motion_of(old, moved, i, h) for i in range(6)]
        loads = (
            self._impulse_loads(c, old, moved, h) if impulse else self._mean_loads(c, old, moved, motions, h)
        )
        force = mean_direction(old.frame, pose.frame, loads.force)
        torque = mean_direction(old.frame, pose.frame, loads.torque)
        memories = [remembered(m, rate) for m, rate in zip(motions, rates, strict=True)]
        return moved._replace(
            mean_rates=rates if impulse else tuple(m.mean_rate for m in memories),
            end_rates=rates if impulse else tuple(m.end_rate for m in memories),
            slide=MidStepRate.starting(rates[3]) if impulse else old.slide.after(memories[3].mean_rate, h),
            latched_angle=moved.angle if impulse and self._locks else old.latched_angle,
            wrench=pair(force, torque, mean(old.gap, pose.gap)),
            friction_energy=old.friction_energy + loads.heat[0],
            latch_energy=old.latch_energy + loads.heat[1],
            damping_energy=old.damping_energy + loads.heat[2],
        ).pack()

    def _mean_loads(self, c: Constants, old: State, new: State, motions: list[StepMotion], h: float) -> Loads:
        """Mean loads over a step from both its ends (discrete gradients and mean rates)."""
        elastic: list[float] = []
        heat = 0.0
        for i, motion in enumerate(motions):
            moved = shifted(motion, c.aligned_angle) if i == 3 else motion
            force, lost = bushing_force(c.stiffness[i], c.damping[i], moved, c.end_weight)
            elastic.append(force)
            heat += lost
        force_on_b = (elastic[0], elastic[1], elastic[2])
        change = new.angle - old.angle
        friction = self._friction(c, old.latched > 0.5, force_on_b, (elastic[4], elastic[5]), change / h)
        latch, latch_heat = self._latch(c, old, motions[3])
        twist = (
            elastic[3]
            + mean_force(c.motor, old.angle, new.angle, c.end_weight)
            + mean_force(c.harness, old.angle, new.angle, c.end_weight)
            + friction
            + latch
        )
        if old.holding:
            twist -= c.hold_stiffness * (new.angle - old.hold_angle)
        return Loads(
            force_on_b,
            conjugate_torque(twist, (elastic[4], elastic[5]), mean_swing(old, new)),
            latch,
            friction,
            (-friction * change, latch_heat, heat),
        )

    @staticmethod
    def _friction(
        c: Constants, latched: bool, force: Vector3, bending: tuple[float, float], rate: float
    ) -> float:
        """Coulomb torque mu r_p F_r + T_pre against the sliding rate (Bagnoli 2007, eq 2.2)."""
        preload = 0.0 if latched else c.friction_preload
        square = force[1] * force[1] + force[2] * force[2]
        normal = square / sqrt(square + _FORCE_SMOOTHING**2)
        if c.bending_arm > 0.0:
            normal += sqrt(bending[0] * bending[0] + bending[1] * bending[1]) / c.bending_arm
        sliding, constant = stiction_factors(rate, c.stiction_velocity, c.static_ratio)
        return -(c.friction * c.pin_radius * normal * sliding + preload * constant)

    def _latch(self, c: Constants, old: State, motion: StepMotion) -> tuple[float, float]:
        """Mean latch torque, and the energy it turned to heat."""
        if not old.latched or self.latch == "none":
            return 0.0, 0.0
        deflection = shifted(motion, old.latched_angle)
        change = deflection.end - deflection.start
        extra = -c.latch_damping * change / motion.h
        if c.end_weight == 0.5:
            extra += inertial_force(c.latch_stiffness, deflection)
        return mean_force(c.latch, deflection.start, deflection.end) + extra, -extra * change

    def _impulse_loads(self, c: Constants, old: State, new: State, h: float) -> Loads:
        """Loads that remove the relative rate in every stiff direction at the end of a vanishing step.

        An ideal joint transmits a latch impulse through its constrained directions in no time; a bushing
        would only do so after ringing at its own frequency.
        """
        locked = old.latched > 0.5 and self._locks
        stiff = [k > 0.0 for k in c.stiffness]
        load = [
            -(c.lock_mass if i < 3 else c.lock_inertia) / h * new.rates[i]
            if stiff[i] or (i == 3 and locked)
            else 0.0
            for i in range(6)
        ]
        work = [-f * (b - a) for f, a, b in zip(load, old.coordinates, new.coordinates, strict=True)]
        latch = work[3] if locked else 0.0
        return Loads(
            (load[0], load[1], load[2]),
            conjugate_torque(load[3], (load[4], load[5]), mean_swing(old, new)),
            0.0,
            0.0,
            (0.0, latch, sum(work) - latch),
        )

    def _endpoint_loads(self, c: Constants, s: State) -> Loads:
        """Loads of one instant from coordinates and rates; heat as power (W)."""
        q, w = list(s.coordinates), s.rates
        q[3] -= c.aligned_angle
        load = [-c.stiffness[i] * q[i] - c.damping[i] * w[i] for i in range(6)]
        force = (load[0], load[1], load[2])
        friction = self._friction(c, s.latched > 0.5, force, (load[4], load[5]), w[3])
        latch = viscous = 0.0
        if s.latched and self.latch != "none":
            viscous = -c.latch_damping * w[3]
            latch = c.latch.value(s.angle - s.latched_angle) + viscous
        twist = load[3] + c.motor.value(s.angle) + c.harness.value(s.angle) + friction + latch
        if s.holding:
            twist -= c.hold_stiffness * (s.angle - s.hold_angle)
        damping = sum(d * rate * rate for d, rate in zip(c.damping, w, strict=True))
        return Loads(
            force,
            conjugate_torque(twist, (load[4], load[5]), (q[4], q[5])),
            latch,
            friction,
            (-friction * w[3], -viscous * w[3], damping),
        )

    def _endpoint_step(self, c: Constants, old: State, moved: State, h: float) -> State:
        """Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule."""
        moved = self._latched(c, moved, c.latch_angle)
        power = self._endpoint_loads(c, moved).heat
        added = [0.5 * h * (a + b) for a, b in zip(old.power, power, strict=True)]
        return moved._replace(
            friction_energy=old.friction_energy + added[0],
            latch_energy=old.latch_energy + added[1],
            damping_energy=old.damping_energy + added[2],
            power=power,
        )

    def _awaits_latch(self, c: Constants, state: State) -> bool:
        """Whether the latch engages by itself and has not yet."""
        return c.latch_automatic and not state.latched and self.latch != "none"

    def _latched(self, c: Constants, state: State, reached: float) -> State:
        """The state with the latch engaged at its angle, if it awaits that and the angle `reached` is reached."""
        if not self._awaits_latch(c, state) or state.angle < reached:
            return state
        return state._replace(latched=1.0, latched_angle=c.latch_angle)

    def _now(self, c: Constants, x: Vector, u: Vector) -> State:
        """The state moved to the motion of the present inputs."""
        values = as_floats(u)
        state = State.unpack(x)
        pose = relative_pose(values, self._axis_frame)
        rates = relative_rates(values, pose)
        angle = nearest_turn(c.aligned_angle + pose.twist, state.angle)
        return state._replace(
            frame=pose.frame,
            gap=pose.gap,
            coordinates=coordinates_of(pose, angle),
            rates=rates_of(rates),
            holding=1.0 if values[28] > 0.5 else 0.0,
        )

    def outputs(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, distance to the latch angle, latched or not."""
        if not self._endpoint:
            return np.concatenate((x[WRENCH], (c.latch_angle - x[ANGLE], x[LATCHED])))
        s = self._now(c, x, u)
        loads = self._endpoint_loads(c, s)
        wrench = pair(rotate(s.frame, loads.force), rotate(s.frame, loads.torque), s.gap)
        return np.array((*wrench, c.latch_angle - s.angle, s.latched))

    def observe(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Angles, torques and forces at the communication point (end-point law), and energies."""
        s = self._now(c, x, u)
        rate = s.rates[3]
        if not self._endpoint:
            s = s._replace(rates=(*s.mean_rates[:3], s.slide.now(), *s.mean_rates[4:]))
        loads = self._endpoint_loads(c, s)
        heat = (s.friction_energy, s.latch_energy, s.damping_energy)
        return np.array(
            (
                s.angle,
                rate,
                c.motor.value(s.angle),
                c.harness.value(s.angle),
                loads.friction_torque,
                loads.latch_torque,
                loads.force[0],
                sqrt(loads.force[1] ** 2 + loads.force[2] ** 2),
                sqrt(loads.torque[1] ** 2 + loads.torque[2] ** 2),
                c.motor.potential(c.stowed_angle) - c.motor.potential(s.angle),
                *heat,
                self._stored(c, s),
                sum(heat),
            )
        )

    def _stored(self, c: Constants, s: State) -> float:
        """Energy in bushing, motor, harness, latch and hold."""
        q = list(s.coordinates)
        q[3] -= c.aligned_angle
        energy = sum(0.5 * k * v * v for k, v in zip(c.stiffness, q, strict=True))
        energy += c.motor.potential(s.angle) + c.harness.potential(s.angle)
        if s.latched and self.latch != "none":
            energy += c.latch.potential(s.angle - s.latched_angle) - c.latch.potential(0.0)
        if s.holding:
            energy += 0.5 * c.hold_stiffness * (s.angle - s.hold_angle) ** 2
        return energy

    def rates(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Heat (W) of friction, latch and damping."""
        return np.array(self._endpoint_loads(c, self._now(c, x, u)).heat)

    def indicators(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Angle left up to where the latch engages by itself; one where it does not."""
        if self.latch == "none":
            return np.zeros(0)
        state = self._now(c, x, u)
        return np.array((c.latch_angle - state.angle if self._awaits_latch(c, state) else 1.0,))

    def update(self, c: Constants, x: Vector, u: Vector, at_event: bool) -> Vector:
        """Follow the angle; at an event commands act, and a latch that is reached engages at its angle."""
        state = self._now(c, x, u)._replace(holding=float(x[HOLDING]))
        if at_event:
            state = state.commanded(float(u[26]), float(u[28]))
            state = self._latched(c, state, c.latch_angle - _REACHED)
        return state.pack()

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Hinge line, kind of latch, mode and tables."""
        return {
            "axis_frame": self._axis_frame,
            "latch_kind": _LATCH_KINDS.index(self.latch),
            "endpoint": self._endpoint,
            "has_harness": isinstance(self._harness, Table),
            **(self._harness.native_data("harness") if isinstance(self._harness, Table) else {}),
            **(self._latch_table.native_data("latch") if self._latch_table else {}),
        }

    @classmethod
    def example(cls) -> Hinge:
        """A hinge with harness and spring latch."""
        return cls(
            axis=(0.0, -1.0, 0.0),
            harness_angle=(0.0, 1.5, 3.2),
            harness_torque=(0.2, 0.05, -0.1),
            latch="spring",
        )
