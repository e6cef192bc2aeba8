r"""End stop of a hinge line: a torque that pushes back from an angle on, a spring with a potential, and damping.

$$ T = -\max\left(0,\; k\, p + c\, \mathrm{STEP}\!\left(\frac{p}{p_\mathrm{full}}\right) \dot
p\right),\qquad p = \varphi - \varphi_\mathrm{stop} > 0 $$

with the penetration $p$ of the hinge angle $\varphi$; $\mathrm{STEP}$ is that of a contact.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import Annotated, NamedTuple

from .contract.component import Vector
from .contract.connection import HEAT, Inputs
from .contract.record import Record, flagged, kept, observed, tunable
from .contract.roles import (
    DISSIPATED_ENERGY,
    FAILURE_COMMAND,
    IMPULSE,
    LOAD,
    NUMERICAL_DISSIPATION,
    ORDER,
    PENETRATION,
    POTENTIAL_ENERGY,
)
from .numerics.axial import AxialConnection, Turn
from .numerics.fourth_order_correction import gauss_rates, remembered_path, viscous_load, workless_law
from .numerics.interval_mean import MidStep
from .numerics.laws import SlackSpring, cubic_step, mean_force
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion

OF_HINGE = "_stop"
"""What scenes call the end stop of a hinge, behind its name."""
_GAUSS = sqrt(1.0 / 3.0)


class _Parameters(NamedTuple):
    stop_angle: Annotated[float, tunable("rad", "Angle from which it pushes back")]
    stiffness: Annotated[float, tunable("N.m/rad", "Torque per angle beyond it", 1e4, 1e-9)]
    damping: Annotated[float, tunable("N.m.s/rad", "Torque per rate at full damping", 0.0, 0.0)]
    full_damping_penetration: Annotated[
        float, tunable("rad", "Angle beyond it from which damping is full", 1e-3, 1e-9, 0.5)
    ]
    aligned_angle: Annotated[float, tunable("rad", "Angle where the axes of both ports coincide")]
    stowed_angle: Annotated[float, tunable("rad", "Angle to which the first one is the nearest")]
    order: Annotated[float, ORDER]


class _State(NamedTuple):
    turn: Turn
    memory: Annotated[Memory, kept("rad/s", "Remembered rates of the angle, and roughness")]
    heat: Annotated[float, HEAT]
    slide: Annotated[MidStep, kept("rad/s", "Mean rates of the angle over two steps")]
    load: Annotated[MidStep, kept("N.m", "Mean torques of two steps of order 4")]
    numerical: Annotated[float, kept("J", "What the scheme took away")]
    failed: Annotated[float, kept("1", "1 from a failure on")]
    failure_heat: Annotated[float, kept("J", "Elastic energy held at the failure")]


class _Commands(NamedTuple):
    failure_command: Annotated[float, FAILURE_COMMAND]
    impulse: Annotated[float, IMPULSE]


class _Observations(NamedTuple):
    penetration: Annotated[
        float,
        observed("rad", "Angle beyond the stop's; negative: what is left up to it", PENETRATION),
    ]
    angular_rate: Annotated[float, observed("rad/s", "Rate of the outboard against the inboard port")]
    stop_torque: Annotated[float, observed("N.m", "Torque against opening on the outboard side", LOAD)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]
    in_contact: Annotated[float, flagged("1: the line is at its stop or beyond it")]


class _Constants(NamedTuple):
    p: _Parameters
    spring: SlackSpring
    is_paired: bool

    def torque(self, penetration: float, rate: float) -> float:
        """Torque of an instant, negative as it closes; it never opens."""
        damping = self.p.damping * cubic_step(penetration / self.p.full_damping_penetration)
        return min(self.spring.value(penetration) - damping * rate, 0.0)

    def braking(self, penetration: float, rate: float) -> float:
        """The share of it that only takes energy."""
        return self.torque(penetration, rate) - self.spring.value(penetration)

    def load(self, m: StepMotion) -> MeanLoad:
        """Load of a step: the spring's has a potential, braking is that at both points of Gauss' rule."""
        middle, off = 0.5 * (m.start + m.end - m.moment), 0.5 * _GAUSS * (m.end - m.start)
        before, after = gauss_rates(m.end - m.start, m.moment, m.h)
        forces = self.braking(middle - off, before), self.braking(middle + off, after)
        braking = viscous_load((before, after), forces, m.h)
        if self.is_paired:
            elastic = workless_law(self.spring, 0.0, m, m.memory.roughness)
        else:
            elastic = MeanLoad(mean_force(self.spring, m.start, m.end), 0.0, 0.0)
        return MeanLoad(
            elastic.force + braking.force,
            braking.heat,
            elastic.numerical,
            elastic.slope + (braking.slope if self.is_paired else 0.0),
        )


class EndStop(AxialConnection[_Parameters, _State, _Commands]):
    """Rotational end stop: resists rotation beyond `stop_angle` about `axis`, in the axes of both ports.

    The hinge angle grows with the right-handed turn of the outboard port about the axis; from `stop_angle` on the
    torque is that of a spring, with damping that rises from nothing by a cubic step and never pulls. From a failure on
    there is none, and what the spring stored is heat.
    """

    kind, noun, axis_of = "end_stop", "end stop", "the hinge line"
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(_Commands), Record(_Observations)

    def __init__(self, axis: Sequence[float] = (0.0, 1.0, 0.0), wrench_mode: str = "mean") -> None:
        self._turn_about(axis, {}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        return _Constants(one, SlackSpring(one.stiffness, 0.0), self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[_Commands]) -> _State:
        """At the pose of the inputs."""
        turn, rate = self._turn(u, c.p.stowed_angle, c.p.aligned_angle)
        return _State(
            turn, Memory(rate, rate), 0.0, MidStep.starting(rate), MidStep.starting(0.0), 0.0, 0.0, 0.0
        )

    @staticmethod
    def _commanded(c: _Constants, s: _State, u: Inputs[_Commands]) -> _State:
        """The state after a failure that is commanded."""
        if s.failed or u.commands.failure_command < 0.5:
            return s
        stored = c.spring.potential(s.turn.angle - c.p.stop_angle)
        return s._replace(failed=1.0, failure_heat=stored)

    def advance(self, c: _Constants, s: _State, u: Inputs[_Commands], h: float) -> _State:
        """One step; a command acts from its start."""
        old, is_impulse = self._commanded(c, s, u), u.commands.impulse > 0.5
        turn, rate = self._turn(u, s.turn.angle, c.p.aligned_angle)
        still = old._replace(
            turn=turn,
            memory=Memory(rate, rate),
            slide=MidStep.starting(rate),
            load=MidStep.starting(0.0),
        )
        if old.failed:
            return still
        c = c._replace(is_paired=c.is_paired and not is_impulse)
        arc = self._arc(s.turn, turn, u, c.is_paired)
        before = s.turn.angle - c.p.stop_angle
        motion = StepMotion(before, before + arc.change, h, s.memory, arc.moment)
        load = c.load(motion)
        moved = still._replace(
            turn=arc.under(load), heat=s.heat + load.heat, numerical=s.numerical + load.numerical
        )
        if is_impulse:
            return moved
        if not c.is_paired:
            return moved._replace(slide=s.slide.after(arc.change / h, h))
        memory = remembered_path(motion)
        return moved._replace(
            memory=memory, slide=MidStep.starting(memory.end_rate), load=s.load.after(load.force, h)
        )

    def torque(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> tuple[Turn, float, float]:
        """Of the present angle and its rate."""
        turn, rate = self._turn(u, s.turn.angle, c.p.aligned_angle)
        return turn, rate, 0.0 if s.failed else c.torque(turn.angle - c.p.stop_angle, rate)

    def record(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> _Observations:
        """At the communication point; of order 4 the torque comes from what the last steps' loads were."""
        now = s if self.endpoint else self._commanded(c, s, u)
        turn, rate, torque = self.torque(c, now, u)
        penetration = turn.angle - c.p.stop_angle
        if not self.endpoint and not now.failed:
            torque = c.torque(penetration, s.slide.now())
        if c.is_paired and torque < 0.0:
            torque = min(s.load.load_now(torque, s.memory.roughness), 0.0)
        stored = 0.0 if now.failed else c.spring.potential(penetration)
        heat = s.heat + now.failure_heat
        touches = float(penetration >= 0.0 and not now.failed)
        return _Observations(penetration, rate, 0.0 - torque, stored, heat, s.numerical, touches)

    def powers(self, c: _Constants, s: _State, u: Inputs[_Commands]) -> Sequence[float]:
        """Heat (W) of the braking share."""
        turn, rate = self._turn(u, s.turn.angle, c.p.aligned_angle)
        return (0.0 if s.failed else -c.braking(turn.angle - c.p.stop_angle, rate) * rate,)

    def follow(self, c: _Constants, s: _State, u: Inputs[_Commands], at_event: bool) -> _State:
        """Follow the angle; at an event commands act."""
        turn, _ = self._turn(u, s.turn.angle, c.p.aligned_angle)
        moved = s._replace(turn=s.turn._replace(angle=turn.angle))
        return self._commanded(c, moved, u) if at_event else moved
