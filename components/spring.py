r"""Spring and damper along the line between two points, which pulls and pushes.

$$ F = P + k\,(l - l_P) + T(l - l_P) + c\, \dot l $$

with the distance $l$ of the ports, $l_P$ at the preload $P$, and a table $T$ of the tension over the elongation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple

from numpy.typing import ArrayLike

from .contract.component import Vector
from .contract.record import Record, tunable
from .contract.roles import ORDER
from .numerics.fourth_order_correction import workless_law
from .numerics.laws import Linear, Sum, Table, mean_force
from .numerics.span import SpanConnection, SpanConstants
from .numerics.stiff_coordinate import MeanLoad, StepMotion, damped_load


class _Parameters(NamedTuple):
    stiffness: Annotated[float, tunable("N/m", "Stiffness along the line", 0.0, 0.0)]
    preload: Annotated[float, tunable("N", "Tension at the preload length, negative if it pushes", 0.0)]
    preload_length: Annotated[
        float, tunable("m", "Distance of the ports with the preload, from which elongations count", 0.0, 0.0)
    ]
    damping: Annotated[float, tunable("N.s/m", "Damping along the line", 0.0, 0.0)]
    order: Annotated[float, ORDER]


class Spring(SpanConnection[_Parameters, Sum]):
    """Spring and damper between two ports: a force along the line between them, without torque.

    elongation, tension: table of the tension (N, positive pulling) over the elongation (m), added to stiffness and
    preload; monotone cubics (PCHIP) between the points, the last slope beyond.
    """

    kind = "spring"
    parameters = Record(_Parameters)

    def __init__(
        self, elongation: Sequence[float] = (), tension: Sequence[float] = (), wrench_mode: str = "mean"
    ) -> None:
        is_table = len(elongation) > 0 or len(tension) > 0
        self._table = Table(elongation, [-force for force in tension]) if is_table else None
        super().__init__({"elongation": tuple(elongation), "tension": tuple(tension)}, wrench_mode)

    def prepare(self, p: Vector) -> SpanConstants[Sum]:
        """Constants of the given parameters."""
        one = self._checked(p)
        linear, tables = Linear(one.stiffness, 0.0, -one.preload), (self._table,) if self._table else ()
        return SpanConstants(one, Sum(linear, *tables), self._is_paired(one.order))

    def tension(self, c: SpanConstants[Sum], elongation: float, rate: float) -> float:
        """Of the law and the damper."""
        damper: float = c.p.damping * rate
        return damper - c.law.value(elongation)

    def load(self, c: SpanConstants[Sum], motion: StepMotion, is_paired: bool) -> MeanLoad:
        """With numerical damping of what steps do not resolve; of order 2 that of the linear part."""
        if is_paired:
            return workless_law(c.law, c.p.damping, motion, motion.memory.roughness)
        elastic = mean_force(c.law, motion.start, motion.end)
        return damped_load(elastic, c.p.stiffness, c.p.damping, motion)

    def native_data(self) -> Mapping[str, ArrayLike]:
        """Mode and table."""
        table = self._table.native_data("tension") if self._table else {}
        return {**super().native_data(), "has_table": self._table is not None, **table}

    @classmethod
    def example(cls) -> Spring:
        """A progressive spring."""
        return cls((-0.5, -0.1, 0.0, 0.1, 0.5), (-60.0, -8.0, 0.0, 8.0, 60.0))
