"""Pages whose numbers are computed while they are built: validation and performance, and the tests behind them."""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterator
from math import acos, pi, sqrt
from pathlib import Path
from platform import machine, python_version
from time import perf_counter
from typing import Any, NamedTuple

from ..analyses import modes
from ..result import Result
from ..simulate import simulate
from ..warnings import FanfoldWarning

_NOT_RUN = "-"


class _LatchTime(NamedTuple):
    """A latch time (s) that is known from elsewhere."""

    scene: str
    line: str
    time: float
    source: str


_BAGNOLI = "Bagnoli (2007)"
_LATCH_TIMES = (
    _LatchTime("bepicolombo", "HL2", 4.24, _BAGNOLI),
    _LatchTime("amos3", "HL3", 7.4, _BAGNOLI),
    _LatchTime("amos3", "HL2", 8.5, _BAGNOLI),
    _LatchTime("amos3", "HL1", 11.6, _BAGNOLI),
)
_RUNS = (("rigid", "all", 1e-4), ("flexible", (), 1e-3), ("flexible", (), 1e-4))
_UNTIL = "12 s"
_TESTS = {
    "validation.md": ("tests/regression", "tests/property", "tests/unit/components"),
    "performance.md": ("tests/benchmark",),
}


_MOTOR = (2.304, 1.434)
"""Torques (N.m) of the workbench's spring, stowed and deployed."""
_INERTIA, _LATCH = 6.2514, 4147.8
"""Inertia (kg.m2) of its panel about the hinge line by the data sheet, and its latch (N.m/rad)."""


def _workbench(measure: bool) -> Iterator[str]:
    """Rows of closed forms of one rigid panel that a spring opens by half a turn, without friction."""
    fall = (_MOTOR[0] - _MOTOR[1]) / pi
    known = {
        "energy of the motor, J": 0.5 * sum(_MOTOR) * pi,
        "latch-up, s": acos(1.0 - pi * fall / _MOTOR[0]) / sqrt(fall / _INERTIA),
        "frequency latched, Hz": sqrt(_LATCH / _INERTIA) / (2.0 * pi),
    }
    here = [_NOT_RUN] * len(known)
    if measure:
        run, found = _quiet("workbench", rigid="all"), modes("workbench", "deployed", rigid="all")
        numbers = (run.headline.motor_energy, run.latch_times["HL"], float(found.frequencies[0]))
        here = [f"{number:.5g}" for number in numbers]
    return (
        f"| {what} | {value:.5g} | {got} |" for (what, value), got in zip(known.items(), here, strict=True)
    )


def validation_page(measure: bool) -> str:
    """Latch times compared with published ones, closed forms, energy balances."""
    scenes = sorted({one.scene for one in _LATCH_TIMES})
    found = {scene: _quiet(scene, rigid="all") for scene in scenes} if measure else {}
    lines = ["# Validation", "", _VALIDATION, "", "## Latch times of rigid wings", ""]
    lines += ["| scene | line | published, s | here, s | source |", "|---|---|---|---|---|"]
    for one in _LATCH_TIMES:
        here = f"{found[one.scene].latch_times[one.line]:.3f}" if measure else _NOT_RUN
        lines.append(f"| `{one.scene}` | {one.line} | {one.time:g} | {here} | {one.source} |")
    lines += ["", "## Closed forms", "", _WORKBENCH, "", "| | closed form | here |", "|---|---|---|"]
    lines += _workbench(measure)
    lines += ["", "## Balance of energy", "", _BALANCE, ""]
    lines += ["| scene, rigid | energy exchanged, J | left open, J |", "|---|---|---|"]
    for scene in scenes:
        numbers = found[scene].headline if measure else None
        cells = (numbers.energy_exchanged, numbers.energy_residual) if numbers else None
        lines.append(
            f"| `{scene}` | "
            + (f"{cells[0]:.4g} | {cells[1]:.1e} |" if cells else f"{_NOT_RUN} | {_NOT_RUN} |")
        )
    return "\n".join(lines) + "\n\n"


_VALIDATION = """What Fanfold computes is compared with closed forms, conservation laws, data sheets, published results
and other programs. Numbers of the first three sections are computed while this page is built; published latch times are
read from diagrams or given with two or three digits."""
_WORKBENCH = """The rigid panel of `workbench`, which a spring opens by 180 deg without friction: the motor's mean
torque times the travel, a part of a swing under a torque that falls along a line, and the latch spring on the inertia
of the data sheet."""
_BALANCE = (
    "What motors, heat, latches, motion and the scheme itself have of the energy, each computed on its own."
)


def readme_section(root: Path, page: str) -> str:
    """Further text of the README; empty if there is none."""
    title, readme = _SECTIONS.get(page), root / "README.md"
    if title is None or not readme.is_file():
        return ""
    text = readme.read_text(encoding="utf-8").split(f"\n## {title}\n", 1)[1].split("\n## ", 1)[0]
    return f"## {title}\n{text}\n"


_SECTIONS = {"validation.md": "Against the thesis"}


def performance_page(measure: bool) -> str:
    """Wall times of AMOS-3 on this machine, and the programs that measure more."""
    lines = ["# Performance", "", _performance(), ""]
    lines += ["| AMOS-3, 12 s | tolerance | wall time, s | steps |", "|---|---|---|---|"]
    for name, rigid, tolerance in _RUNS:
        wall, steps = _NOT_RUN, _NOT_RUN
        if measure:
            start = perf_counter()
            result = _quiet("amos3", rigid=rigid, tolerance=tolerance, until=_UNTIL, estimate=False)
            wall, steps = f"{perf_counter() - start:.2f}", str(len(result.time) - 1)
        lines.append(f"| {name} | {tolerance:g} | {wall} | {steps} |")
    return "\n".join(lines) + "\n\n"


def _performance() -> str:
    return (
        "Measured while this page was built, by one process, without the companion run that estimates errors; reading "
        f"the scene and building the FMUs are included (Python {python_version()}, {machine()}). The programs below "
        "measure where the time goes, how it grows with the size of a wing, and what others take at equal error."
    )


def _quiet(scene: str, **options: Any) -> Result:  # noqa: ANN401 - those of `simulate`
    """A run whose warnings are not the page's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FanfoldWarning)
        return simulate(scene, **options)


def tests_page(root: Path, page: str) -> str:
    """The files of tests that belong to a page, each with its first sentence; empty where there are no sources."""
    rows = [row for folder in _TESTS[page] for row in _files(root, root / folder)]
    if not rows:
        return ""
    lines = [
        "## Tests and programs behind it",
        "",
        _TESTS_RUN,
        "",
        "| file | what it does |",
        "|---|---|",
        *rows,
    ]
    return "\n".join(lines) + "\n"


_TESTS_RUN = """`python -m pytest FILE` runs a test; a program runs as a module, such as
`python -m tests.benchmark.deployment --error`."""


def _files(root: Path, folder: Path) -> Iterator[str]:
    for path in sorted(folder.rglob("*.py")):
        told = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
        if told:
            sentence = " ".join(told.split("\n\n")[0].split()).replace("|", "\\|")
            yield f"| `{path.relative_to(root).as_posix()}` | {sentence} |"
