"""Error over step size of one flexible panel on a latch spring or a lock, at orders 2 and 4, over joint stiffness.

The workbench panel with 16 modes on two hinges, as native FMUs. It latches at its rate and goes on in steps of
`SETTLING`, at the order under test, until what the latch stirs up in the highest modes has died; from there the step
is H. What is compared are mean wrenches, the unknowns of the coupling, over the longest H, which all runs have in
common: at one hinge the force normal to the panel and the torque about the hinge line, their relative rms errors over
`WINDOW` against a run with steps `FINEST` from the same instant, the larger of the two.

Where errors at order 4 come down to 1e-6 the rotation's order 2 takes over: that part goes with the square of the
panel's rate. The centrifugal force along the panel, all rotation, is of order 2 throughout and not compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace
from typing import Literal

import numpy as np

from orchestrator.assembly import HingeLine, Link, Part
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.ports import Order
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from tests.benchmark.stability import panel_data, panel_scene
from tests.references.record import Record

Holds = Literal["spring", "lock"]

STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
"""H (s)."""
FINEST, SETTLING, SETTLED, WINDOW = 2.5e-5, 1e-4, 0.1, 0.2
LATCH = 2e3
"""N.m/rad."""
_ITERATION, _ROUND_OFF = 1e-6, 1e-14
"""Tolerance (1) that has wrenches iterated to 1e-8, and what it is for each N/m of a joint where that is more."""
_ROWS = [2, 4]
"""Of the wrench on the panel: force along z, torque about y."""
_LEFT = 2
"""Of the bodies' ports, the panel's left one: those of the base come first."""


@dataclass
class Followed:
    """What a run recorded; of its steps the ends (s), the sizes (s) and the wrenches on bodies, (steps, ports, 6)."""

    record: Record
    ends: np.ndarray
    sizes: np.ndarray
    wrenches: np.ndarray

    def means(self, points: np.ndarray) -> np.ndarray:
        """Mean wrenches between times (s) at which steps ended, (points - 1, ports, 6)."""
        rows = np.searchsorted(self.ends, points + 0.5 * FINEST)
        impulses = np.cumsum(self.wrenches * self.sizes[:, None, None], axis=0)[rows - 1]
        result: np.ndarray = np.diff(impulses, axis=0) / np.diff(points)[:, None, None]
        return result


def follow(
    parts: Sequence[Part],
    links: Sequence[Link],
    lines: Sequence[HingeLine],
    until: float,
    plan: Sequence[Sequence[float]],
    order: Order,
    tolerance: float = _ITERATION,
) -> Followed:
    """Native FMUs in planned steps."""
    steps: list[tuple[float, float, np.ndarray]] = []

    def keep(time: float, size: float) -> None:
        table = master.coupling.accepted.reshape(len(network.port_names), -1)
        steps.append((time, size, table[:, :6].copy()))

    settings = Settings(tolerance=tolerance, step_plan=plan, order=order, progress=keep)
    with as_fmus(SimpleNamespace(name="scene", parts=parts), "native") as participants:  # type: ignore[arg-type]
        network = Network(participants, links, order)
        record = Record(network)
        master = Master(network, lines, record, settings)
        advance = master.coupling.advance
        # it comes back after every step
        master.coupling.advance = lambda until, event, _, sizes: advance(until, event, 0.0, sizes)  # type: ignore[method-assign]
        master.initialize(preload=False)
        master.run(until)
    ends, sizes, wrenches = (np.array(values) for values in zip(*steps, strict=True))
    return Followed(record, ends, sizes, wrenches)


def scene(joint: float, holds: Holds) -> tuple[list[Part], list[Link], list[HingeLine]]:
    """The panel of the stability sweep, with a kinematic latch where it is locked."""
    parts, links, (line,) = panel_scene(panel_data(16), joint, LATCH)
    if holds == "spring":
        return parts, links, [line]
    parts = [
        replace(p, structure={**p.structure, "latch": "kinematic"}) if p.kind == "hinge" else p for p in parts
    ]
    return parts, links, [replace(line, kinematic=True)]


@cache
def run(joint: float, holds: Holds, h: float, order: Order) -> Followed:
    """Latched, settled, and then followed in steps of h (s) until all have passed the window."""
    parts, links, lines = scene(joint, holds)
    plan = ((SETTLING,), (SETTLING,) * round(SETTLED / SETTLING) + (h,) * round(WINDOW / h))
    tolerance = max(_ITERATION, _ROUND_OFF * joint)
    return follow(parts, links, lines, SETTLED + WINDOW + 0.5 * h, plan, order, tolerance)


def means(found: Followed) -> np.ndarray:
    """Loads over the common steps of the window, (steps, 2)."""
    points = found.record.events[0][0] + SETTLED + STEPS[0] * np.arange(round(WINDOW / STEPS[0]))
    result: np.ndarray = found.means(points)[:, _LEFT][:, _ROWS]
    return result
