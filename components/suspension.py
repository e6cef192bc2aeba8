r"""Suspension: a spring that only pulls, along the line between two points, for gravity compensation.

$$ F = \max\!\left(0,\; P + k\,(l - l_P) + c\, \dot l\right) \text{ while the spring is taut} $$

with the distance $l$ of the ports, $l_P$ at the preload $P$.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from .contract.component import Vector
from .contract.record import Record, tunable
from .contract.roles import ORDER
from .numerics.laws import SlackSpring
from .numerics.span import SpanConnection, SpanConstants
from .numerics.stiff_coordinate import MeanLoad, StepMotion
from .numerics.strand import mean_tension, strand_load, tension_at


class _Parameters(NamedTuple):
    stiffness: Annotated[float, tunable("N/m", "Stiffness along the line", 50.0, 1e-9)]
    preload: Annotated[float, tunable("N", "Tension at the preload length", 10.0, 0.0)]
    preload_length: Annotated[float, tunable("m", "Distance of the ports with the preload", 0.5, 0.0)]
    damping: Annotated[float, tunable("N.s/m", "Damping along the line while the spring is taut", 0.0, 0.0)]
    order: Annotated[float, ORDER]


class Suspension(SpanConnection[_Parameters, SlackSpring]):
    """Suspension of the lower from the upper port: a force along the line between them, without torque.

    Its tension is the preload at the preload length, and grows with the stiffness.
    """

    kind, port_names = "suspension", ("upper", "lower")
    parameters = Record(_Parameters)

    def __init__(self, wrench_mode: str = "mean") -> None:
        super().__init__({}, wrench_mode)

    def prepare(self, p: Vector) -> SpanConstants[SlackSpring]:
        """Constants of the given parameters."""
        one = self._checked(p)
        return SpanConstants(one, SlackSpring(one.stiffness, one.preload), self._is_paired(one.order))

    def tension(self, c: SpanConstants[SlackSpring], elongation: float, rate: float) -> float:
        """Nothing where the spring is slack."""
        return tension_at(c.law, c.p.damping, elongation, rate)

    def load(self, c: SpanConstants[SlackSpring], motion: StepMotion, is_paired: bool) -> MeanLoad:
        """A strand's."""
        if is_paired:
            return strand_load(c.law, c.p.damping, motion)
        tension, heat = mean_tension(c.law, c.p.damping, motion.start, motion.end, motion.h)
        return MeanLoad(-tension, heat, 0.0)
