"""Suspension: a spring that only pulls, along the line between two points, for gravity compensation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .contract.component import Component, ComponentError, Port, Quantity, Vector
from .contract.frames import Vector3, add, dot, mean, norm, scaled, subtract
from .numerics.laws import SlackSpring, mean_force
from .numerics.mid_step import MidStep
from .numerics.relative_motion import (
    Line,
    as_floats,
    dissipated_energies,
    gives_end_point,
    is_of_order_four,
    order_parameter,
)
from .numerics.stiff_coordinate import MeanLoad, Memory, StepMotion
from .numerics.workless_pair import workless_law

_HEAT, _SLIDE, _WRENCH, _SLOPES = 3, slice(4, 8), slice(8, 20), slice(20, 32)
_IMPULSE, _MOMENTS = 26, 27


@dataclass(frozen=True, slots=True)
class _Constants:
    spring: SlackSpring
    preload_length: float
    damping: float
    end_weight: float
    paired: bool

    def elongation(self, length: float) -> float:
        """Elongation from the length of the preload."""
        return length - self.preload_length

    def tension(self, elongation: float, rate: float) -> float:
        """Tension of an instant; damping never pushes, and a slack spring has none."""
        elastic = -self.spring.value(elongation)
        return max(elastic + self.damping * rate, 0.0) if elastic > 0.0 else 0.0


class _Instant(NamedTuple):
    """Centre line from the upper to the lower port (world axes), its length and rate of change."""

    span: Vector3
    length: float
    rate: float


class Suspension(Component):
    """Hangs the lower port on the upper one: a force along the line between their origins, no torque.

    Its tension is the preload at the preload length, and grows with the stiffness. The mean force over a step
    is the discrete gradient of the energy in the length: with the centre lines d0 and d1 at both ends it is
    T (d0 + d1) / (l0 + l1), whose work on d1 - d0 is T (l1 - l0).
    """

    kind = "suspension"

    def __init__(self, wrench_mode: str = "mean") -> None:
        self._endpoint = gives_end_point(wrench_mode)
        self._declare(
            {"wrench_mode": wrench_mode},
            ports=[Port(name, "connection", 2 if self._endpoint else 4) for name in ("upper", "lower")],
            parameters=_parameters(),
            inputs=[Quantity("impulse", "1", "1: the next step is an impulse", variability="discrete")],
            observations=[
                Quantity("length", "m", "Distance of the ports"),
                Quantity("tension", "N", "Force that pulls the ports together"),
                Quantity("potential_energy", "J", "Elastic energy, zero where the spring is slack"),
                Quantity("dissipated_energy", "J", "Energy dissipated since the start"),
            ],
            feedthrough=self._endpoint,
        )
        if self._endpoint:
            self.continuous = dissipated_energies(_HEAT)

    def prepare(self, p: Vector) -> _Constants:
        """Constants of the given parameters."""
        self.check_ranges(p)
        one = {q.name: float(p[self.parameter_layout[q.name]][0]) for q in self.parameter_layout.quantities}
        spring = SlackSpring(one["stiffness"], one["preload"])
        paired = is_of_order_four(one["order"]) and one["end_weight"] == 0.5 and not self._endpoint
        return _Constants(spring, one["preload_length"], one["damping"], one["end_weight"], paired)

    def initial(self, c: _Constants, u: Vector) -> Vector:
        """At the place of the inputs."""
        inputs = as_floats(u)
        span = _span(inputs)
        if norm(span) == 0.0:
            raise ComponentError("the ports of the suspension are at one point; it hangs along no line")
        rate = self._instant(inputs).rate
        return np.array((*span, 0.0, *MidStep.starting(rate), *(0.0,) * 24))

    @staticmethod
    def _instant(u: list[float]) -> _Instant:
        span = _span(u)
        length = norm(span)
        velocity = (u[20] - u[7], u[21] - u[8], u[22] - u[9])
        return _Instant(span, length, dot(velocity, span) / length)

    def step(self, c: _Constants, x: Vector, u: Vector, h: float) -> Vector:
        """One step: the mean tension of the lengths at both ends along the mean of the line."""
        v, inputs = as_floats(x), as_floats(u)
        old, now = (v[0], v[1], v[2]), self._instant(inputs)
        length = norm(old)
        before, after = c.elongation(length), c.elongation(now.length)
        rate = (now.length - length) / h
        if c.paired and inputs[_IMPULSE] < 0.5:
            line = Line(mean(old, now.span), subtract(now.span, old), 2.0 / (length + now.length))
            a, b = (inputs[i : i + 3] for i in (_MOMENTS, _MOMENTS + 6))
            moment = line.moment((b[0] - a[0], b[1] - a[1], b[2] - a[2]))
            load = self._pair(c, StepMotion(before, after, h, Memory(0.0, 0.0), moment))
            force, slope = line.forces(-load.force, -load.slope)
            slide = MidStep.starting(rate + 3.0 * moment / h)
            return np.array((*now.span, v[_HEAT] + load.heat, *slide, *_wrenches(force), *_wrenches(slope)))
        elastic = -mean_force(c.spring, before, after)
        tension = -mean_force(c.spring, before, after, c.end_weight)
        tension = max(tension + c.damping * c.spring.taut_share(before, after) * rate, 0.0)
        heat = v[_HEAT] + (tension - elastic) * (now.length - length)
        force = scaled(-tension / (length + now.length), add(old, now.span))
        slide = MidStep(*v[_SLIDE]).after(rate, h)
        if inputs[_IMPULSE] > 0.5:
            slide = MidStep.starting(now.rate)
        return np.array((*now.span, heat, *slide, *_wrenches(force), *(0.0,) * 12))

    @staticmethod
    def _pair(c: _Constants, motion: StepMotion) -> MeanLoad:
        """Load on the length at order 4; damping never turns the mean tension into a push."""
        elastic, change = workless_law(c.spring, 0.0, motion), motion.end - motion.start
        damping = c.damping * c.spring.taut_share(motion.start, motion.end)
        if change < 0.0 and -elastic.force * motion.h < -damping * change:
            damping = max(-elastic.force, 0.0) * motion.h / -change
        return workless_law(c.spring, damping, motion)

    def outputs(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Wrenches on both ports, slopes of mean wrenches."""
        if not self._endpoint:
            return np.concatenate((x[_WRENCH], x[_SLOPES]))
        now = self._instant(as_floats(u))
        tension = c.tension(c.elongation(now.length), now.rate)
        return np.array(_wrenches(scaled(-tension / now.length, now.span)))

    def observe(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Length and tension at the communication point, and energies."""
        now = self._instant(as_floats(u))
        elongation = c.elongation(now.length)
        rate = now.rate if self._endpoint else MidStep(*as_floats(x[_SLIDE])).now()
        return np.array(
            (now.length, c.tension(elongation, rate), c.spring.potential(elongation), float(x[_HEAT]))
        )

    def rates(self, c: _Constants, x: Vector, u: Vector) -> Vector:
        """Heat of the end-point tension (W)."""
        now = self._instant(as_floats(u))
        elongation = c.elongation(now.length)
        return np.array(((c.tension(elongation, now.rate) + c.spring.value(elongation)) * now.rate,))

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Mode."""
        return {"endpoint": self._endpoint}

    @classmethod
    def example(cls) -> Suspension:
        """A taut spring."""
        return cls()


def _span(u: list[float]) -> Vector3:
    return subtract((u[13], u[14], u[15]), (u[0], u[1], u[2]))


def _wrenches(force: Vector3) -> tuple[float, ...]:
    """Wrenches on both ports from the force on the lower one."""
    return (*scaled(-1.0, force), 0.0, 0.0, 0.0, *force, 0.0, 0.0, 0.0)


def _parameters() -> list[Quantity]:
    def tunable(name: str, unit: str, text: str, start: float, minimum: float) -> Quantity:
        return Quantity(name, unit, text, 1, start, minimum, variability="tunable")

    return [
        tunable("stiffness", "N/m", "Stiffness along the line", 50.0, 1e-9),
        tunable("preload", "N", "Tension at the preload length", 10.0, 0.0),
        tunable("preload_length", "m", "Distance of the ports at which the tension is the preload", 0.5, 0.0),
        tunable("damping", "N.s/m", "Damping along the line while the spring is taut", 0.0, 0.0),
        Quantity("end_weight", "1", "Weight of the end value in mean wrenches", 1, 0.5, 0.5, 1.0, "tunable"),
        order_parameter(),
    ]
