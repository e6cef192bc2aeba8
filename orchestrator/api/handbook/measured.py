"""Sections with figures of this machine, which the pages on validation and performance get when they are built."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from math import acos, pi, sqrt
from platform import machine, python_version
from time import perf_counter
from typing import Any

from ..analyses import modes
from ..result import Result
from ..simulate import simulate
from ..warnings import FanfoldWarning

_PUBLISHED = {"bepicolombo": {"HL2": 4.24}, "amos3": {"HL3": 7.4, "HL2": 8.5, "HL1": 11.6}}
"""Latch times (s) of rigid wings by scene and line, read from diagrams of Bagnoli (2007)."""
_MOTOR = (2.304, 1.434)
"""Torques (N.m) of the workbench's spring, stowed and deployed."""
_INERTIA, _LATCH = 6.2514, 4147.8
"""Inertia (kg.m2) of its panel about the hinge line by the data sheet, and its latch (N.m/rad)."""
_RUNS = (("rigid", "all", 1e-4), ("flexible", (), 1e-3), ("flexible", (), 1e-4))
_UNTIL = "12 s"


def validation() -> str:
    """Latch times against published ones, closed forms of one panel, and balances of energy, as Markdown."""
    lines = [
        "## On this machine",
        "",
        "Computed during the build of this page, with rigid bodies and friction that sticks. `workbench` is one panel "
        "that a spring opens by 180 deg without friction. Its closed forms are the mean torque times the travel, a "
        "part of a swing, and the latch spring on the inertia of the data sheet.",
        "",
        "| scene | quantity | expected | here | source |",
        "|---|---|---|---|---|",
    ]
    lines += (
        f"| `workbench` | {quantity} | {expected:.5g} | {here:.5g} | closed form |"
        for quantity, expected, here in _workbench()
    )
    for scene, times in _PUBLISHED.items():
        result = _quiet(scene, rigid="all")
        for line, time in times.items():
            here = result.latch_times[line]
            lines.append(f"| `{scene}` | latch time of {line}, s | {time:g} | {here:.3f} | Bagnoli (2007) |")
        numbers = result.headline
        lines.append(
            f"| `{scene}` | energy not balanced, J | 0 | {numbers.energy_residual:.1e} of "
            f"{numbers.energy_exchanged:.4g} exchanged | conservation |"
        )
    return "\n".join(lines) + "\n"


def _workbench() -> Iterator[tuple[str, float, float]]:
    """Quantity, closed form and computed value."""
    fall = (_MOTOR[0] - _MOTOR[1]) / pi
    run, latched = _quiet("workbench", rigid="all"), modes("workbench", "deployed", rigid="all")
    yield "work of the motor, J", 0.5 * sum(_MOTOR) * pi, run.headline.motor_energy
    latch_time = acos(1.0 - pi * fall / _MOTOR[0]) / sqrt(fall / _INERTIA)
    yield "latch time, s", latch_time, run.latch_times["HL"]
    yield (
        "frequency of the latched panel, Hz",
        sqrt(_LATCH / _INERTIA) / (2.0 * pi),
        float(latched.frequencies[0]),
    )


def performance() -> str:
    """Wall times of AMOS-3, as Markdown."""
    lines = [
        "## On this machine",
        "",
        "Measured during the build of this page: one process, without the coarser run that shows errors, with "
        f"reading of the scene and building of the FMUs (Python {python_version()}, {machine()}).",
        "",
        "| AMOS-3, 12 s | tolerance | wall time, s | steps |",
        "|---|---|---|---|",
    ]
    for name, rigid, tolerance in _RUNS:
        start = perf_counter()
        result = _quiet("amos3", rigid=rigid, tolerance=tolerance, until=_UNTIL, estimate=False)
        wall = perf_counter() - start
        lines.append(f"| {name} | {tolerance:g} | {wall:.2f} | {len(result.time) - 1} |")
    return "\n".join(lines) + "\n"


def _quiet(scene: str, **options: Any) -> Result:  # noqa: ANN401 - those of `simulate`
    """A run whose warnings are not the page's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FanfoldWarning)
        return simulate(scene, **options)
