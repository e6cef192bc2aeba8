"""Connections with a force along the line between two ports: a law of their distance, nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Generic, NamedTuple, TypeVar

from ..contract.component import ComponentError
from ..contract.connection import HEAT, NO_PAIR, SLOPES, WRENCH, Connection, Impulse, Inputs
from ..contract.frames import Vector3, dot, mean, norm, scaled, subtract
from ..contract.record import Record, kept, observed
from ..contract.roles import DISSIPATED_ENERGY, LOAD, NUMERICAL_DISSIPATION, POTENTIAL_ENERGY
from .fourth_order_correction import memories_after
from .interval_mean import MidStep
from .laws import Law
from .relative_motion import Line
from .scheme import LEAST_SPAN
from .stiff_coordinate import MeanLoad, Memory, StepMotion

P = TypeVar("P", bound=tuple[Any, ...])
L = TypeVar("L", bound=Law)


class SpanState(NamedTuple):
    """States: the centre line, and what the last step exerted."""

    span: Annotated[Vector3, kept("m", "Centre line from the first to the second port, world axes")]
    heat: Annotated[float, HEAT]
    slide: Annotated[MidStep, kept("m/s", "Mean rates of the length over two steps")]
    memory: Annotated[Memory, kept("m/s", "Remembered rates of the length, and roughness")]
    numerical: Annotated[float, kept("J", "What the scheme took away")] = 0.0
    wrench: Annotated[tuple[float, ...], WRENCH] = NO_PAIR
    slopes: Annotated[tuple[float, ...], SLOPES] = NO_PAIR


class SpanObservations(NamedTuple):
    """What is recorded for people."""

    length: Annotated[float, observed("m", "Distance of the ports")]
    tension: Annotated[float, observed("N", "Force that pulls the ports together", LOAD)]
    potential_energy: Annotated[float, POTENTIAL_ENERGY]
    dissipated_energy: Annotated[float, DISSIPATED_ENERGY]
    numerical_dissipation: Annotated[float, NUMERICAL_DISSIPATION]


class SpanConstants(NamedTuple, Generic[L]):
    """Parameters, and the law of the elongation from the length of the preload."""

    p: Any
    law: L
    is_paired: bool


class _Instant(NamedTuple):
    """Centre line (world axes), its length and rate of change."""

    span: Vector3
    length: float
    rate: float


class SpanConnection(Connection[P, SpanState, Impulse], Generic[P, L]):
    """A force along the line between two ports, without torque.

    The mean force over a step is the discrete gradient of the energy in the length: with the centre lines d0 and d1 at
    both ends it is T (d0 + d1) / (l0 + l1), whose work on d1 - d0 is T (l1 - l0).

    Subclasses return the constants from `prepare`, and have `tension` of an instant and `load` of a step.
    """

    states, commands = Record(SpanState), Record(Impulse)
    observations = Record(SpanObservations)

    def tension(self, c: SpanConstants[L], elongation: float, rate: float) -> float:
        """Tension (N) of an instant."""
        raise self._lacking("tension")

    def load(self, c: SpanConstants[L], motion: StepMotion, is_paired: bool) -> MeanLoad:
        """Load on the elongation over a step; is_paired: of order 4."""
        raise self._lacking("load")

    def start(self, c: SpanConstants[L], u: Inputs[Impulse]) -> SpanState:
        """At the place of the inputs."""
        if norm(_span(u)) < LEAST_SPAN:
            raise ComponentError(f"the ports of the {self.noun} are at one point; its force has no direction")
        now = self._instant(u)
        return SpanState(now.span, 0.0, MidStep.starting(now.rate), Memory(now.rate, now.rate))

    @staticmethod
    def _instant(u: Inputs[Impulse]) -> _Instant:
        first, second = u.motions
        span = _span(u)
        length = norm(span)
        return _Instant(span, length, dot(subtract(second.velocity, first.velocity), span) / length)

    def advance(self, c: SpanConstants[L], s: SpanState, u: Inputs[Impulse], h: float) -> SpanState:
        """The mean tension of the lengths at both ends along the mean of the line."""
        now, length, is_impulse = self._instant(u), norm(s.span), u.commands.impulse > 0.5
        is_paired = c.is_paired and not is_impulse
        line = Line(mean(s.span, now.span), subtract(now.span, s.span), 2.0 / (length + now.length))
        moment = 0.0
        if is_paired:
            first, second = u.moments
            moment = line.moment(subtract(second.velocity, first.velocity))
        before, after = length - c.p.preload_length, now.length - c.p.preload_length
        motion = StepMotion(before, after, h, s.memory, moment)
        if self.endpoint:
            motion = motion.without_inertia()
        load = self.load(c, motion, is_paired)
        force, slope = line.forces(-load.force, -load.slope)
        (memory,) = memories_after([motion], [now.rate], is_paired=is_paired, is_impulse=is_impulse)
        rate = (now.length - length) / h
        slide = s.slide.after(rate, h)
        if is_paired or is_impulse:
            slide = MidStep.starting(now.rate if is_impulse else rate + 3.0 * moment / h)
        return SpanState(
            now.span,
            s.heat + load.heat,
            slide,
            memory,
            s.numerical + load.numerical,
            _wrenches(force),
            _wrenches(slope) if is_paired else NO_PAIR,
        )

    def wrenches(self, c: SpanConstants[L], s: SpanState, u: Inputs[Impulse]) -> Sequence[float]:
        """Of the present tension."""
        now = self._instant(u)
        tension = self.tension(c, now.length - c.p.preload_length, now.rate)
        return _wrenches(scaled(-tension / now.length, now.span))

    def record(self, c: SpanConstants[L], s: SpanState, u: Inputs[Impulse]) -> SpanObservations:
        """Length and tension at the communication point, and energies."""
        now = self._instant(u)
        elongation = now.length - c.p.preload_length
        tension = self.tension(c, elongation, now.rate if self.endpoint else s.slide.now())
        return SpanObservations(now.length, tension, c.law.potential(elongation), s.heat, s.numerical)

    def powers(self, c: SpanConstants[L], s: SpanState, u: Inputs[Impulse]) -> Sequence[float]:
        """Heat of the end-point tension (W)."""
        now = self._instant(u)
        elongation = now.length - c.p.preload_length
        return ((self.tension(c, elongation, now.rate) + c.law.value(elongation)) * now.rate,)


def _span(u: Inputs[Impulse]) -> Vector3:
    first, second = u.motions
    return subtract(second.position, first.position)


def _wrenches(force: Vector3) -> tuple[float, ...]:
    """Wrenches on both ports from the force on the second one."""
    return (*scaled(-1.0, force), 0.0, 0.0, 0.0, *force, 0.0, 0.0, 0.0)
