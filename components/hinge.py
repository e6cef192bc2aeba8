"""Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch.

Spherical, revolute, cylindrical, fixed and bushing joints are settings of the six stiffnesses. The wrench
is the mean over the communication step, from the poses at its two ends ("mean"), or the end-point wrench
of the current inputs for hosts that step explicitly ("endpoint"). Of order 4 a mean wrench has a slope, linear in
the moments of the ports' velocities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ComponentError, Port, Vector
from .contract.frames import nearest_turn, rotate
from .hinge_parts.loads import (
    endpoint_loads,
    impulse_loads,
    instant_loads,
    lagged_loads,
    mean_loads,
    recorded,
    stiff_loads,
    stored_energy,
)
from .hinge_parts.state import (
    ANGLE,
    HEAT,
    HEATS,
    HOLDING,
    LATCHED,
    NO_LOADS,
    SLOPES,
    WRENCH,
    Constants,
    State,
    StiffLoads,
    coordinates_of,
    mean_swing,
    motions_of,
    passage_of,
    rates_of,
)
from .hinge_parts.variables import inputs, observations, outputs, parameters
from .numerics.laws import Law, Linear, Table
from .numerics.mid_step import MidStep, MidStepSlope
from .numerics.relative_motion import (
    as_floats,
    axis_frame,
    dissipated_energies,
    gives_end_point,
    is_of_order_four,
    pair,
    relative_pose,
    relative_rates,
)
from .numerics.stiff_coordinate import Memory, StepMotion, remembered
from .numerics.workless_pair import remembered_path

LatchKind = Literal["none", "spring", "table", "kinematic"]
_LATCH_KINDS = ("none", "spring", "table", "kinematic")

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
            ports=[Port(name, "connection", 2 if self._endpoint else 4) for name in ("inboard", "outboard")],
            parameters=parameters(),
            inputs=inputs(),
            outputs=outputs(),
            observations=observations(self._endpoint),
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
            latches=self.latch != "none",
            locks=self._locks,
            latch=self._latch_table or Linear(stiffness),
            latch_angle=one["latch_angle"],
            latch_stiffness=stiffness,
            latch_damping=damping,
            latch_automatic=one["latch_automatic"] > 0.5,
            lock_mass=one["lock_mass"],
            lock_inertia=one["lock_inertia"],
            hold_stiffness=one["hold_stiffness"],
            end_weight=one["end_weight"],
            paired=is_of_order_four(one["order"]) and one["end_weight"] == 0.5 and not self._endpoint,
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
            MidStep.starting(rates.twist),
            *((0.0,) * 6),
            hold_angle=angle,
            numerical_dissipation=0.0,
            sliding=MidStepSlope.starting(rates.twist),
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
        passage = passage_of(old, moved)
        moments = (0.0,) * 6
        if c.paired:
            moments = rates_of(passage.rate_moments(values[29:41], mean_swing(old, moved)))
        motions = motions_of(old, moved, moments, h)
        lasting, sliding = NO_LOADS, MidStepSlope.starting(rates[3])
        if impulse:
            loads = impulse_loads(c, old, moved, h)
        else:
            stiff = stiff_loads(c, old, motions)
            loads = mean_loads(c, old, moved, motions, stiff, h)
            if c.paired:
                lasting = self._loads(c, old, stiff, h)
                sliding = old.sliding.after((moved.angle - old.angle) / h, 3.0 * moments[3] / h, h)
        slopes: tuple[float, ...] = (0.0,) * 12
        if c.paired:
            wrench, slopes = passage.wrenches(
                loads.force, loads.torque, loads.force_slope, loads.torque_slope
            )
        else:
            wrench = passage.wrench(loads.force, loads.torque)
        memories = self._memories(c, motions, rates, impulse)
        return moved._replace(
            mean_rates=tuple(m.mean_rate for m in memories),
            end_rates=tuple(m.end_rate for m in memories),
            roughness=tuple(m.roughness for m in memories),
            slide=MidStep.starting(rates[3]) if impulse else old.slide.after(memories[3].mean_rate, h),
            latched_angle=moved.angle if impulse and self._locks else old.latched_angle,
            wrench=wrench,
            slopes=slopes,
            loads=lasting,
            sliding=sliding,
            friction_energy=old.friction_energy + loads.heat[0],
            latch_energy=old.latch_energy + loads.heat[1],
            damping_energy=old.damping_energy + loads.heat[2],
            numerical_dissipation=old.numerical_dissipation + loads.numerical,
        ).pack()

    @staticmethod
    def _memories(
        c: Constants, motions: list[StepMotion], rates: tuple[float, ...], impulse: bool
    ) -> list[Memory]:
        """What the six coordinates remember of a step; after an impulse only the rates of its end are known."""
        if impulse:
            return [Memory(rate, rate) for rate in rates]
        if c.paired:
            return [remembered_path(m) for m in motions]
        return [remembered(m, rate) for m, rate in zip(motions, rates, strict=True)]

    @staticmethod
    def _loads(c: Constants, old: State, loads: StiffLoads, h: float) -> tuple[MidStepSlope, ...]:
        """Loads with one step more; that of the latch begins where it engages."""
        *bushing, latch = old.loads
        if old.latched and c.latches:
            latch = latch.after(loads.latch.force, loads.latch.slope, h)
        added = zip(bushing, loads.bushing, strict=True)
        return (*(b.after(load.force, load.slope, h) for b, load in added), latch)

    def _endpoint_step(self, c: Constants, old: State, moved: State, h: float) -> State:
        """Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule."""
        moved = self._latched(c, moved, c.latch_angle)
        power = endpoint_loads(c, moved).heat
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
        """Wrenches on both ports, distance to the latch angle, latched or not, slopes of mean wrenches."""
        if not self._endpoint:
            return np.concatenate((x[WRENCH], (c.latch_angle - x[ANGLE], x[LATCHED]), x[SLOPES]))
        s = self._now(c, x, u)
        loads = endpoint_loads(c, s)
        wrench = pair(rotate(s.frame, loads.force), rotate(s.frame, loads.torque), s.gap)
        return np.array((*wrench, c.latch_angle - s.angle, s.latched))

    def observe(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Angles, torques and forces at the communication point, and energies.

        Loads follow from the end-point law, of order 4 corrected by what the last steps' loads were.
        """
        s = self._now(c, x, u)
        rate = s.rates[3]
        if not self._endpoint:
            # a command acts from the next step's start, which is this instant
            old = State.unpack(x).commanded(float(u[26]), float(u[28]))
            s = s._replace(latched=old.latched, latched_angle=old.latched_angle, hold_angle=old.hold_angle)
            felt, slide = (s.end_rates, s.sliding) if c.paired else (s.mean_rates, s.slide)
            s = s._replace(rates=(*felt[:3], slide.now(), *felt[4:]))
        loads = instant_loads(c, s, recorded(c, s)) if c.paired else endpoint_loads(c, s)
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
                stored_energy(c, s),
                sum(heat),
                s.numerical_dissipation,
                *(() if self._endpoint else lagged_loads(s)),
            )
        )

    def rates(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Heat (W) of friction, latch and damping."""
        return np.array(endpoint_loads(c, self._now(c, x, u)).heat)

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
