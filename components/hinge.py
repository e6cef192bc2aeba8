r"""Hinge: a six-axis bushing about a hinge line, with motorisation, harness, friction and latch.

$$ T = T_\mathrm{motor}(\varphi) + T_\mathrm{harness}(\varphi) - \left(\mu\, r_p F_r + T_\mathrm{pre}\right)
\operatorname{sgn} \dot\varphi - T_\mathrm{latch} $$

$$ T_\mathrm{latch} = k_l (\varphi - \varphi_l) + c_l \dot\varphi,\qquad F_i = -k_i q_i - c_i \dot q{}_i $$

about the hinge line and, with $F_i$, along and about all axes, with the pin's radius $r_p$ and its force $F_r$ normal
to the line (Bagnoli 2007, equation 2.2). The latch torque begins with the latch-up. Below its largest torque friction
sticks, by an elastic deflection; with the smooth law it falls with the rate.

Spherical, revolute, cylindrical, fixed and bushing joints are settings of the six stiffnesses. With a clearance they
act on what is beyond it: along and about the line either way, across it in any direction. The wrench
is the mean over the communication step, from the poses at its two ends ("mean"), or the end-point wrench
of the current inputs for hosts that step explicitly ("endpoint"). Of order 4 a mean wrench has a slope, linear in
the moments of the ports' velocities.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees, hypot
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import ComponentError, Vector
from .contract.connection import NO_PAIR, Connection, Inputs
from .contract.frames import nearest_turn, rotate
from .contract.record import Record
from .hinge_parts.friction import FORCE_SMOOTHING, friction_limit, starting_deflection
from .hinge_parts.loads import (
    NO_LOAD,
    driving_energy,
    endpoint_loads,
    held_at,
    held_energy,
    impulse_loads,
    instant_loads,
    lagged_loads,
    latch_energy,
    mean_loads,
    recorded,
    stiff_loads,
    stored_energy,
)
from .hinge_parts.state import (
    Constants,
    StiffLoads,
    bare,
    clearances_of,
    coordinates_of,
    mean_swing,
    motions_of,
    passage_of,
    rates_of,
)
from .hinge_parts.variables import (
    NO_LOADS,
    OUTPUTS,
    Commands,
    MeanObservations,
    Observations,
    Parameters,
    State,
)
from .numerics.fourth_order_correction import memories_after
from .numerics.interval_mean import MidStep, MidStepSlope
from .numerics.laws import Linear, Table
from .numerics.relative_motion import axis_frame, pair, relative_pose, relative_rates
from .numerics.stiff_coordinate import Memory

LatchKind = Literal["none", "spring", "table", "kinematic"]
_LATCH_KINDS = ("none", "spring", "table", "kinematic")

_REACHED = 1e-9  # distance (rad) from the latch angle that a solver may leave when it has found the event
_FOLDED = (
    3.0  # rad across the line: at pi the angle about it is not defined, and near there it turns without bound
)


class Hinge(Connection[Parameters, State, Commands]):
    """Hinge between an inboard and an outboard port, with motor, harness, friction and latch.

    axis: direction of the hinge line in the axes of both ports when they coincide; the hinge angle grows
    with the right-handed rotation of the outboard port about it. harness_angle, harness_torque: table of
    the harness torque over the hinge angle (rad, N.m), positive opening; empty for no harness. motor_angle,
    motor_torque: the same of the motor, in place of its spring. hysteresis_angle, hysteresis_torque: half of what the
    torques of motor and harness differ by between opening and closing, a friction that latches leave as it is. latch:
    "none", "spring" (linear, zero at the angle where it engages), "table" (latch_torque, resisting, over
    latch_deflection from that angle, with lines between the points where latch_straight; between points without torque
    the latch has play, and no damping) or "kinematic" (an impulse that removes the relative rate, then a
    lock). wrench_mode: "mean" or "endpoint"; in endpoint mode a kinematic latch acts as a spring latch,
    because an explicit host cannot solve for a lock.

    A latch that an unlatch command opens lets go, and what it stored is heat. It engages again after the command has
    ended. From a failure on there is no load of any kind. What bushing, latch, friction and hold stored is heat; motor
    and harness keep what they have, as nothing turns them any more.
    """

    kind, own_outputs = "hinge", OUTPUTS
    parameters, states = Record(Parameters), Record(State)
    commands = Record(Commands)
    scheme: ClassVar = {"REACHED": _REACHED, "FORCE_SMOOTHING": FORCE_SMOOTHING, "FOLDED": _FOLDED} | {
        f"{kind.upper()}_LATCH": number for number, kind in enumerate(_LATCH_KINDS)
    }

    def __init__(
        self,
        axis: Sequence[float] = (0.0, 1.0, 0.0),
        harness_angle: Sequence[float] = (),
        harness_torque: Sequence[float] = (),
        motor_angle: Sequence[float] = (),
        motor_torque: Sequence[float] = (),
        hysteresis_angle: Sequence[float] = (),
        hysteresis_torque: Sequence[float] = (),
        latch: LatchKind = "none",
        latch_deflection: Sequence[float] = (),
        latch_torque: Sequence[float] = (),
        latch_straight: bool = False,
        wrench_mode: Literal["mean", "endpoint"] = "mean",
    ) -> None:
        if latch not in _LATCH_KINDS:
            raise ComponentError(f"latch is {latch!r}; it must be none, spring, table or kinematic")
        self._axis_frame = axis_frame(axis, "the hinge line")
        if any(torque < 0.0 for torque in hysteresis_torque):
            raise ComponentError(f"hysteresis_torque is {tuple(hysteresis_torque)}; none may be negative")
        self._tables = {
            name: Table(angle, torque)
            for name, angle, torque in (
                ("motor", motor_angle, motor_torque),
                ("harness", harness_angle, harness_torque),
                ("hysteresis", hysteresis_angle, hysteresis_torque),
            )
            if len(angle) or len(torque)
        }
        self._latch_table = None
        if latch == "table":
            self._latch_table = Table(latch_deflection, [-t for t in latch_torque], straight=latch_straight)
        loose = [s for s, torque in zip(latch_deflection, latch_torque, strict=False) if torque == 0.0]
        self._play = (min(loose), max(loose)) if loose else (0.0, 0.0)
        self.latch = latch
        self.indicator_count = int(latch != "none")
        structure = {
            "axis": tuple(axis),
            "harness_angle": tuple(harness_angle),
            "harness_torque": tuple(harness_torque),
            "motor_angle": tuple(motor_angle),
            "motor_torque": tuple(motor_torque),
            "hysteresis_angle": tuple(hysteresis_angle),
            "hysteresis_torque": tuple(hysteresis_torque),
            "latch": latch,
            "latch_deflection": tuple(latch_deflection),
            "latch_torque": tuple(latch_torque),
            "latch_straight": latch_straight,
        }
        self.observations = Record(Observations if wrench_mode == "endpoint" else MeanObservations)
        super().__init__(structure, wrench_mode)
        self._locks = latch == "kinematic" and not self.endpoint

    def prepare(self, p: Vector) -> Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        stiffness, damping = one.latch_stiffness, one.latch_damping
        if self._locks:
            stiffness, damping = one.lock_stiffness, one.lock_damping
        clearances = clearances_of(one)
        loose = {i for clearance in clearances for i in clearance.members}
        return Constants(
            p=one,
            stiffness=bare(one.stiffness, loose),
            damping=bare(one.damping, loose),
            clearances=clearances,
            motor=self._tables.get("motor")
            or Linear(one.motor_stiffness, one.motor_wind_up, one.motor_constant_torque),
            harness=self._tables.get("harness") or Linear(0.0),
            hysteresis=self._tables.get("hysteresis") or Linear(0.0),
            latches=self.latch != "none",
            locks=self._locks,
            latch=self._latch_table or Linear(stiffness),
            play=self._play,
            latch_stiffness=stiffness,
            latch_damping=damping,
            paired=self._is_paired(one.order),
        )

    def start(self, c: Constants, u: Inputs[Commands]) -> State:
        """Unlatched, at the pose of the inputs; the angle is the one nearest the stowed angle."""
        pose = relative_pose(u.motions, self._axis_frame)
        turning = relative_rates(u.motions, pose)
        angle, rates = nearest_turn(c.p.aligned_angle + pose.twist, c.p.stowed_angle), rates_of(turning)
        return State(
            frame=pose.frame,
            gap=pose.gap,
            coordinates=coordinates_of(pose, angle),
            rates=rates,
            memories=tuple(Memory(rate, rate) for rate in rates),
            slide=MidStep.starting(turning.twist),
            friction_heat=0.0,
            latch_heat=0.0,
            damping_heat=0.0,
            hold_angle=angle,
            sliding=MidStepSlope.starting(turning.twist),
            presliding=starting_deflection(c, angle),
        )

    def _moved(self, c: Constants, s: State, u: Inputs[Commands]) -> State:
        """The state moved to the motion of the inputs; of an end point, friction that sticks with it."""
        pose = relative_pose(u.motions, self._axis_frame)
        rates = rates_of(relative_rates(u.motions, pose))
        coordinates = coordinates_of(pose, nearest_turn(c.p.aligned_angle + pose.twist, s.angle))
        moved = s._replace(frame=pose.frame, gap=pose.gap, coordinates=coordinates, rates=rates)
        if not self.endpoint or s.failed or c.p.presliding_stiffness == 0.0:
            return moved
        return moved._replace(presliding=s.presliding + moved.angle - s.angle)

    def advance(self, c: Constants, s: State, u: Inputs[Commands], h: float) -> State:
        """One step; the inputs are those of its end. Commands act from its start."""
        old = self._commanded(c, s, u.commands)
        moved = self._moved(c, old, u)
        if old.failed:
            return self._freed(moved)
        _refuse_folded(c, moved)
        if self.endpoint:
            return self._endpoint_step(c, old, moved, h)
        is_impulse, passage = u.commands.impulse > 0.5, passage_of(old, moved)
        moments = (0.0,) * 6
        if c.paired:
            moments = rates_of(passage.rate_moments(u.moments, mean_swing(old, moved)))
        motions = motions_of(old, moved, moments, h)
        lasting, sliding = NO_LOADS, MidStepSlope.starting(moved.rate)
        if is_impulse:
            loads = impulse_loads(c, old, moved, h)
        else:
            stiff = stiff_loads(c, old, motions)
            loads = mean_loads(c, old, moved, motions, stiff)
            if c.paired:
                turn = motions[3]
                lasting = self._loads(c, old, stiff, loads.driving, h)
                sliding = old.sliding.after((turn.end - turn.start) / h, 3.0 * turn.moment / h, h)
        wrench, slopes = passage.wrench(loads.force, loads.torque), NO_PAIR
        if c.paired:
            wrench, slopes = passage.wrenches(
                loads.force, loads.torque, loads.force_slope, loads.torque_slope
            )
        struck = h * loads.latch_torque if is_impulse else 0.0
        memories = memories_after(motions, moved.rates, is_paired=c.paired, is_impulse=is_impulse)
        slide = old.slide.after(memories[3].mean_rate, h)
        return moved.heated(loads.heat)._replace(
            memories=memories,
            slide=MidStep.starting(moved.rate) if is_impulse else slide,
            latched_angle=moved.angle if is_impulse and self._locks and not s.latched else old.latched_angle,
            wrench=wrench,
            slopes=slopes,
            loads=lasting,
            sliding=sliding,
            numerical=old.numerical + loads.numerical,
            latch_impulse=old.latch_impulse + struck,
            presliding=loads.friction.deflection,
        )

    @staticmethod
    def _commanded(c: Constants, s: State, commands: Commands) -> State:
        """The state under commands; one that has failed heeds none.

        What a joint stores that fails, and a latch that lets go, becomes heat.
        """
        if s.failed:
            return s
        if commands.failure_command > 0.5:
            return s._replace(failed=1.0, failure_angle=s.angle, failure_heat=held_energy(c, s))
        lost = latch_energy(c, s) if commands.unlatch_command > 0.5 else 0.0
        return s.heated((0.0, lost, 0.0)).commanded(commands)

    @staticmethod
    def _freed(moved: State) -> State:
        """The moved state of a joint that has failed."""
        return moved._replace(
            memories=tuple(Memory(rate, rate) for rate in moved.rates),
            slide=MidStep.starting(moved.rate),
            power=(0.0, 0.0, 0.0),
            wrench=NO_PAIR,
            slopes=NO_PAIR,
            loads=NO_LOADS,
            sliding=MidStepSlope.starting(moved.rate),
        )

    @staticmethod
    def _loads(
        c: Constants, old: State, loads: StiffLoads, driving: tuple[float, float], h: float
    ) -> tuple[MidStepSlope, ...]:
        """Loads with one step more; that of the latch begins where it engages, and ends where it lets go."""
        *bushing, latch, rest = old.loads
        is_engaged = old.latched and c.latches
        latch = latch.after(loads.latch.force, loads.latch.slope, h) if is_engaged else NO_LOADS[-2]
        added = zip(bushing, loads.bushing, strict=True)
        return (*(b.after(load.force, load.slope, h) for b, load in added), latch, rest.after(*driving, h))

    def _endpoint_step(self, c: Constants, old: State, moved: State, h: float) -> State:
        """Follow the angle, latch where it is reached, and add up heat by the trapezoidal rule."""
        moved = self._latched(c, moved, c.p.latch_angle)
        loads = endpoint_loads(c, moved)
        friction, latch, damping = (0.5 * h * (a + b) for a, b in zip(old.power, loads.heat, strict=True))
        return moved.heated((friction, latch, damping))._replace(
            power=loads.heat, presliding=loads.friction.deflection
        )

    def _awaits_latch(self, c: Constants, state: State) -> bool:
        """Whether the latch engages by itself and has not yet."""
        is_free = not (state.latched or state.opened or state.failed)
        return c.p.latch_automatic > 0.5 and is_free and c.latches

    def _latched(self, c: Constants, state: State, reached: float) -> State:
        """The state with the latch engaged at its angle, if it awaits that and the angle `reached` is reached."""
        if not self._awaits_latch(c, state) or state.angle < reached:
            return state
        return state._replace(latched=1.0, latched_angle=c.p.latch_angle)

    def _now(self, c: Constants, s: State, u: Inputs[Commands]) -> State:
        """The state moved to the motion of the present inputs, under the present hold command."""
        return self._moved(c, s, u)._replace(holding=float(u.commands.hold > 0.5))

    def outputs(self, c: Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, distance to the latch angle, latched or not, slopes of mean wrenches."""
        s = self.states.read(x)
        if not self.endpoint:
            return np.array((*s.wrench, c.p.latch_angle - s.angle, s.latched, *s.slopes))
        s = self._now(c, s, self.inputs(u))
        loads = NO_LOAD if s.failed else endpoint_loads(c, s)
        wrench = pair(rotate(s.frame, loads.force), rotate(s.frame, loads.torque), s.gap)
        return np.array((*wrench, c.p.latch_angle - s.angle, s.latched))

    def record(self, c: Constants, s: State, u: Inputs[Commands]) -> Observations | MeanObservations:
        """Angles, torques and forces at the communication point, and energies.

        Loads follow from the end-point law, of order 4 corrected by what the last steps' loads were.
        """
        now = self._now(c, s, u)
        rate = now.rate
        # a command acts from the next step's start, which is this instant
        old = s if self.endpoint else self._commanded(c, s, u.commands)
        if old.failed:
            return self._record_failed(c, old, now)
        if not self.endpoint:
            x, y, z, _, *swing = (m.end_rate if c.paired else m.mean_rate for m in s.memories)
            turning = s.sliding.now() if c.paired else s.slide.now()
            now = now._replace(
                latched=old.latched,
                latched_angle=old.latched_angle,
                hold_angle=old.hold_angle,
                rates=(x, y, z, turning, swing[0], swing[1]),
            )
        held = recorded(c, now) if c.paired else held_at(c, now)
        loads = instant_loads(c, now, held)
        if self.endpoint:
            now = now._replace(presliding=loads.friction.deflection)
        along, *across = loads.force
        _, *bending = loads.torque
        found = Observations(
            angle=now.angle,
            angular_rate=rate,
            motor_torque=c.motor.value(now.angle),
            harness_torque=c.harness.value(now.angle),
            friction_torque=loads.friction.force,
            friction_limit=friction_limit(c, now, held.bushing),
            latch_torque=loads.latch_torque,
            axial_force=along,
            radial_force=hypot(*across),
            bending_moment=hypot(*bending),
            hinge_force=rotate(self._axis_frame, loads.force),
            hinge_torque=rotate(self._axis_frame, loads.torque),
            motor_energy=c.motor.potential(c.p.stowed_angle) - c.motor.potential(now.angle),
            friction_energy=old.friction_heat,
            latch_energy=old.latch_heat,
            damping_energy=old.damping_heat,
            latch_impulse=s.latch_impulse,
            failure_energy=0.0,
            potential_energy=stored_energy(c, now),
            dissipated_energy=sum(old.heat),
            numerical_dissipation=s.numerical,
        )
        return found if self.endpoint else MeanObservations(found, *lagged_loads(now, self._axis_frame))

    def _record_failed(self, c: Constants, s: State, now: State) -> Observations | MeanObservations:
        """The motion, no loads, and the energies as they were at the failure."""
        found = Observations(
            *(now.angle, now.rate, *(0.0,) * 8, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            motor_energy=c.motor.potential(c.p.stowed_angle) - c.motor.potential(s.failure_angle),
            friction_energy=s.friction_heat,
            latch_energy=s.latch_heat,
            damping_energy=s.damping_heat,
            latch_impulse=s.latch_impulse,
            failure_energy=s.failure_heat,
            potential_energy=driving_energy(c, s.failure_angle),
            dissipated_energy=sum(s.heat) + s.failure_heat,
            numerical_dissipation=s.numerical,
        )
        return found if self.endpoint else MeanObservations(found, *lagged_loads(s, self._axis_frame))

    def powers(self, c: Constants, s: State, u: Inputs[Commands]) -> Sequence[float]:
        """Heat (W) of friction, latch and damping."""
        return NO_LOAD.heat if s.failed else endpoint_loads(c, self._now(c, s, u)).heat

    def indicate(self, c: Constants, s: State, u: Inputs[Commands]) -> Sequence[float]:
        """Angle left up to where the latch engages by itself; one where it does not."""
        if not c.latches:
            return ()
        state = self._now(c, s, u)
        return (c.p.latch_angle - state.angle if self._awaits_latch(c, state) else 1.0,)

    def follow(self, c: Constants, s: State, u: Inputs[Commands], at_event: bool) -> State:
        """Follow the angle; at an event commands act, and a latch that is reached engages at its angle."""
        state = self._moved(c, s, u)
        if not s.failed:
            now = endpoint_loads(c, self._now(c, s, u))
            state = state._replace(presliding=now.friction.deflection)
        if at_event:
            state = self._latched(c, self._commanded(c, state, u.commands), c.p.latch_angle - _REACHED)
        return state

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Hinge line, kind of latch, mode and tables."""
        return {
            **super().native_data(),
            "axis_frame": self._axis_frame,
            "latch_kind": _LATCH_KINDS.index(self.latch),
            "latch_play": self._play,
            **{f"has_{name}": name in self._tables for name in ("motor", "harness", "hysteresis")},
            **{k: v for name, table in self._tables.items() for k, v in table.native_data(name).items()},
            **(self._latch_table.native_data("latch") if self._latch_table else {}),
        }

    @classmethod
    def example(cls) -> Hinge:
        """A hinge with harness, hysteresis and spring latch."""
        return cls(
            axis=(0.0, -1.0, 0.0),
            harness_angle=(0.0, 1.5, 3.2),
            harness_torque=(0.2, 0.05, -0.1),
            hysteresis_angle=(0.0, 1.0, 3.2),
            hysteresis_torque=(0.02, 0.05, 0.03),
            latch="spring",
        )


def _refuse_folded(c: Constants, moved: State) -> None:
    """ComponentError where a hinge that bends against springs is folded across its line."""
    if not any(c.p.rotational_stiffness[1:]):
        return
    bent = hypot(*moved.swing)
    if bent > _FOLDED:
        raise ComponentError(
            f"the hinge is bent by {degrees(bent):.0f} deg across its line, where the angle about it has no meaning; "
            "stiffen it across (cross_stiffness of a scene's joints), or stop a universal joint before"
        )
