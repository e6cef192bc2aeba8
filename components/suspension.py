r"""Suspension: a spring that only pulls, along the line between two points, for gravity compensation.

$$ F = \max\!\left(0,\; P + k\,(l - l_P) + c\, \dot l\right) \text{ while the spring is taut} $$

with the distance $l$ of the ports, $l_P$ at the preload $P$.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

from .contract.component import ComponentError, Vector
from .contract.connection import HEAT, NO_PAIR, SLOPES, WRENCH, Connection, Impulse, Inputs
from .contract.frames import Vector3, add, dot, mean, norm, scaled, subtract
from .contract.record import Record, kept, observed, tunable
from .contract.roles import DISSIPATED_ENERGY, LOAD, ORDER, POTENTIAL_ENERGY
from .numerics.interval_mean import MidStep
from .numerics.laws import SlackSpring
from .numerics.relative_motion import Line
from .numerics.stiff_coordinate import Memory, StepMotion
from .numerics.strand import damping_power, mean_tension, strand_load, tension_at


class _Parameters(NamedTuple):
    stiffness: Annotated[float, tunable("N/m", "Stiffness along the line", 50.0, 1e-9)]
    preload: Annotated[float, tunable("N", "Tension at the preload length", 10.0, 0.0)]
    preload_length: Annotated[float, tunable("m", "Distance of the ports with the preload", 0.5, 0.0)]
    damping: Annotated[float, tunable("N.s/m", "Damping along the line while the spring is taut", 0.0, 0.0)]
    order: Annotated[float, ORDER]


class _State(NamedTuple):
    span: Annotated[Vector3, kept("m", "Centre line from the upper to the lower port, world axes")]
    heat: Annotated[float, HEAT]
    slide: Annotated[MidStep, kept("m/s", "Mean rates of the length over two steps")]
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR
    slopes: Annotated[tuple[float, ...], SLOPES] = NO_PAIR


class _Observations(NamedTuple):
    length: Annotated[float, observed("m", "Distance of the ports")]
    tension: Annotated[float, observed("N", "Force that pulls the ports together", LOAD)]
    potential_energy: Annotated[
        float, POTENTIAL_ENERGY.saying("Elastic energy, zero where the spring is slack")
    ]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]


class _Constants(NamedTuple):
    p: _Parameters
    spring: SlackSpring
    is_paired: bool

    def elongation(self, length: float) -> float:
        """Elongation from the length of the preload."""
        return length - self.p.preload_length

    def tension(self, elongation: float, rate: float) -> float:
        """Tension of an instant."""
        return tension_at(self.spring, self.p.damping, elongation, rate)


class _Instant(NamedTuple):
    """Centre line from the upper to the lower port (world axes), its length and rate of change."""

    span: Vector3
    length: float
    rate: float


class Suspension(Connection[_Parameters, _State, Impulse]):
    """Suspension of the lower from the upper port: a force along the line between them, without torque.

    Its tension is the preload at the preload length, and grows with the stiffness. The mean force over a step
    is the discrete gradient of the energy in the length: with the centre lines d0 and d1 at both ends it is
    T (d0 + d1) / (l0 + l1), whose work on d1 - d0 is T (l1 - l0).
    """

    kind, port_names = "suspension", ("upper", "lower")
    parameters, states = Record(_Parameters), Record(_State)
    commands, observations = Record(Impulse), Record(_Observations)

    def __init__(self, wrench_mode: str = "mean") -> None:
        super().__init__({}, wrench_mode)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        one = self._checked(p)
        return _Constants(one, SlackSpring(one.stiffness, one.preload), self._is_paired(one.order))

    def start(self, c: _Constants, u: Inputs[Impulse]) -> _State:
        """At the place of the inputs."""
        if norm(_span(u)) == 0.0:
            raise ComponentError("the ports of the suspension are at one point; it hangs along no line")
        now = self._instant(u)
        return _State(now.span, 0.0, MidStep.starting(now.rate))

    @staticmethod
    def _instant(u: Inputs[Impulse]) -> _Instant:
        upper, lower = u.motions
        span = _span(u)
        length = norm(span)
        return _Instant(span, length, dot(subtract(lower.velocity, upper.velocity), span) / length)

    def advance(self, c: _Constants, s: _State, u: Inputs[Impulse], h: float) -> _State:
        """The mean tension of the lengths at both ends along the mean of the line."""
        now, length, is_impulse = self._instant(u), norm(s.span), u.commands.impulse > 0.5
        before, after = c.elongation(length), c.elongation(now.length)
        rate = (now.length - length) / h
        if c.is_paired and not is_impulse:
            line = Line(mean(s.span, now.span), subtract(now.span, s.span), 2.0 / (length + now.length))
            upper, lower = u.moments
            moment = line.moment(subtract(lower.velocity, upper.velocity))
            motion = StepMotion(before, after, h, Memory(0.0, 0.0), moment)
            load = strand_load(c.spring, c.p.damping, motion)
            force, slope = line.forces(-load.force, -load.slope)
            slide = MidStep.starting(rate + 3.0 * moment / h)
            return _State(now.span, s.heat + load.heat, slide, _wrenches(force), _wrenches(slope))
        tension, heat = mean_tension(c.spring, c.p.damping, before, after, h)
        force = scaled(-tension / (length + now.length), add(s.span, now.span))
        slide = MidStep.starting(now.rate) if is_impulse else s.slide.after(rate, h)
        return _State(now.span, s.heat + heat, slide, _wrenches(force))

    def wrenches(self, c: _Constants, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Of the present tension."""
        now = self._instant(u)
        tension = c.tension(c.elongation(now.length), now.rate)
        return _wrenches(scaled(-tension / now.length, now.span))

    def record(self, c: _Constants, s: _State, u: Inputs[Impulse]) -> _Observations:
        """Length and tension at the communication point, and energies."""
        now = self._instant(u)
        elongation = c.elongation(now.length)
        tension = c.tension(elongation, now.rate if self.endpoint else s.slide.now())
        return _Observations(now.length, tension, c.spring.potential(elongation), s.heat)

    def powers(self, c: _Constants, s: _State, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat of the end-point tension (W)."""
        now = self._instant(u)
        elongation = c.elongation(now.length)
        return (damping_power(c.spring, c.p.damping, elongation, now.rate),)


def _span(u: Inputs[Impulse]) -> Vector3:
    upper, lower = u.motions
    return subtract(lower.position, upper.position)


def _wrenches(force: Vector3) -> tuple[float, ...]:
    """Wrenches on both ports from the force on the lower one."""
    return (*scaled(-1.0, force), 0.0, 0.0, 0.0, *force, 0.0, 0.0, 0.0)
