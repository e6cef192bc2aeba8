"""Curves of the interactive plots: recorded rows as they are, in single precision; of long runs, extremes of spans."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from components.contract.component import Vector

from ....results.key_figures import line_latch_torque
from ....results.result import Result
from ...plots import ENERGIES, curves_of, dissipated_by_cause, loads_by_kind, loads_title, one_a_line
from ...viewers.surface import Indices
from .numbers import single, whole

_MOST = 14
"""Curves in a plot, beyond which none can be told from another."""
_LARGEST = 1_600_000
"""Bytes of all curves of a result."""


class Panel:
    """A plot: title, unit, and curves (N,) by label."""

    def __init__(self, title: str, unit: str, curves: list[tuple[str, Vector]]) -> None:
        self.title, self.unit = title, unit
        self.curves = [(label, values) for label, values in curves if np.all(np.isfinite(values))][:_MOST]


def panels(result: Result) -> list[Panel]:
    """Plots that have something to show: angles, latch torques, loads, energies."""
    return [panel for panel in _panels(result) if panel.curves]


def _panels(result: Result) -> Iterator[Panel]:
    lines = {line.sensor: line.name for line in result.hinge_lines}
    names = one_a_line(result, result.recording("angle"))
    angles = [(lines.get(name, name), np.rad2deg(result.signal(name, "angle"))) for name in names]
    yield Panel("Deployment angles", "deg", angles)
    torques = [(line.name, line_latch_torque(result, line)) for line in result.hinge_lines]
    yield Panel(
        "Latch torques, sum over the hinges of a line", "N.m", [one for one in torques if one[1].any()]
    )
    for found in loads_by_kind(result).values():
        many = len({name for name, _ in found}) > 1
        for unit in dict.fromkeys(result.unit(*of) for of in found):
            shown = [of for of in found if result.unit(*of) == unit]
            curves = [curve for of in shown for curve in curves_of(result, *of, many)]
            yield Panel(f"{loads_title(result, found)}, {unit}", unit, curves)
    totals = [
        (label, result.signal("scene", name)) for name, label in ENERGIES.items() if result.has("scene", name)
    ]
    yield Panel("Energy", "J", totals)
    yield Panel("Dissipated energy by cause", "J", dissipated_by_cause(result))
    if result.has("scene", "energy_residual"):
        yield Panel(
            "Residual of the energy balance", "J", [("residual", result.signal("scene", "energy_residual"))]
        )


def contents(found: list[Panel]) -> list[dict[str, object]]:
    """Plots for the page. A curve of a run with many rows keeps the lowest and the highest of every span of rows."""
    count = sum(len(panel.curves) for panel in found)
    most = _LARGEST // (4 * max(count, 1))
    return [
        {
            "title": panel.title,
            "unit": panel.unit,
            "curves": [_curve(label, values, most) for label, values in panel.curves],
        }
        for panel in found
    ]


def _curve(label: str, values: Vector, most: int) -> dict[str, object]:
    if values.size <= most:
        return {"label": label, "values": single(values), "rows": None}
    rows = extremes_of_spans(values, most // 4)  # a row number is as long as a value
    return {"label": label, "values": single(values[rows]), "rows": whole(rows)}


def extremes_of_spans(values: Vector, count: int) -> Indices:
    """First and last row, and those of the lowest and highest value in `count` equal spans of rows."""
    bounds = np.linspace(0, values.size, max(count, 1) + 1).astype(np.int64)
    spans = [(a, values[a:b]) for a, b in pairwise(bounds) if b > a]
    rows = [a + np.array([part.argmin(), part.argmax()]) for a, part in spans]
    found: Indices = np.unique(np.concatenate([[0, values.size - 1], *rows]))
    return found
