"""Work and precision: errors of latch times and latch torque peaks against wall time, by master.

python -m tests.benchmark.work_precision [PLOT.png]

Both scenes run in process. The implicit master runs at tolerances and at fixed steps, the explicit ones at
fixed steps; errors are the largest relative ones over all lines, against a tight implicit run.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.scene import find_scene, load_scene
from tests.benchmark.error_plot import Point, error_texts, plot
from tests.benchmark.stability import MasterName, Run, run
from tests.references.panels import one_panel


class Case(NamedTuple):
    """A scene for both kinds of master, and what to run on it."""

    name: str
    mean: Assembly
    endpoint: Assembly
    until: float
    reference: float
    tolerances: tuple[float, ...]
    steps: tuple[float, ...]
    explicit_steps: tuple[float, ...]


def cases() -> list[Case]:
    """One panel on its latch, and the rigid AMOS-3 wing."""
    one = one_panel().check()
    wing = load_scene(find_scene("amos3"))
    return [
        Case(
            "one panel",
            assemble(one),
            assemble(one, wrench_mode="endpoint"),
            4.6,
            2e-7,
            (1e-2, 1e-3, 1e-4, 1e-5, 1e-6),
            (2e-2, 5e-3, 1e-3),
            (2e-3, 1e-3, 5e-4, 2e-4, 1e-4),
        ),
        Case(
            "amos3, rigid",
            assemble(wing, rigid={"all"}),
            assemble(wing, rigid={"all"}, wrench_mode="endpoint"),
            12.5,
            1e-5,
            (1e-2, 1e-3, 1e-4),
            (5e-3,),
            (1e-3, 2e-4),
        ),
    ]


def headline(assembly: Assembly, outcome: Run) -> dict[str, float]:
    """Latch time and latch torque peak (cubic interpolant) by line; lines that did not latch are absent."""
    record, found = outcome.record, {}
    times = np.array(record.times)
    for time, _, text in record.events:
        found[f"time {text.split()[0]}"] = time
    for line in assembly.hinge_lines:
        torque = np.abs(sum(record.signal(hinge, "latch_torque") for hinge in line.hinges))
        top = int(torque.argmax())
        near = slice(max(top - 3, 0), top + 4)
        window, inside = np.unique(times[near], return_index=True)
        if torque[top] > 0.0 and len(window) > 3:
            fine = np.linspace(window[0], window[-1], 2000)
            found[f"peak {line.name}"] = float(CubicSpline(window, torque[near][inside])(fine).max())
    return found


def worst(kind: str, found: dict[str, float], reference: dict[str, float]) -> float:
    """Largest relative error of one kind; NaN where something is missing."""
    errors = [abs(found.get(k, np.nan) / v - 1.0) for k, v in reference.items() if k.startswith(kind)]
    return float(np.max(errors)) if errors else np.nan


def measure(
    case: Case, master: MasterName, setting: str, settings: Settings, reference: dict[str, float]
) -> Point:
    """One timed run."""
    assembly = case.mean if master == "implicit" else case.endpoint
    start = perf_counter()
    outcome = run(
        assembly.parts,
        assembly.links,
        assembly.hinge_lines,
        case.until,
        settings,
        master,
        preload=assembly.preload,
    )
    wall = perf_counter() - start
    steps = outcome.master.statistics.steps
    series = f"{master} {setting.split()[0]}"
    if outcome.failure:
        return Point(series, setting, np.nan, np.nan, wall, steps)
    found = headline(assembly, outcome)
    errors = [worst(kind, found, reference) for kind in ("time", "peak")]
    return Point(series, setting, errors[0], errors[1], wall, steps)


def points(case: Case) -> list[Point]:
    """All runs of a case, printed as they come."""
    tight = Settings(tolerance=case.reference, largest_step=case.mean.largest_step)
    outcome = run(
        case.mean.parts,
        case.mean.links,
        case.mean.hinge_lines,
        case.until,
        tight,
        preload=case.mean.preload,
    )
    reference = headline(case.mean, outcome)
    plan: list[tuple[MasterName, str, Settings]] = [
        ("implicit", f"tol {t:g}", Settings(tolerance=t, largest_step=case.mean.largest_step))
        for t in case.tolerances
    ]
    plan += [("implicit", f"H {h:g} s", Settings(fixed_step=h)) for h in case.steps]
    plan += [
        (master, f"H {h:g} s", Settings(fixed_step=h))
        for master in ("jacobi", "gauss-seidel")
        for h in case.explicit_steps
    ]
    print(f"\n{case.name}, {case.until:g} s; reference: tolerance {case.reference:g}", flush=True)
    print(f"{'master':<14}{'setting':<12}{'latch time':>12}{'latch peak':>12}{'wall, s':>10}{'steps':>8}")
    found = []
    for master, setting, settings in plan:
        point = measure(case, master, setting, settings, reference)
        found.append(point)
        late, peak = error_texts(point)
        print(
            f"{master:<14}{setting:<12}{late:>12}{peak:>12}{point.wall:>10.2f}{point.steps:>8}",
            flush=True,
        )
    return found


def main(arguments: Sequence[str]) -> None:
    """Run everything, print the tables, write the plot."""
    path = Path(arguments[0] if arguments else "work_precision.png")
    plot({case.name: points(case) for case in cases()}, path)
    print(f"\n{path}")


if __name__ == "__main__":
    main(sys.argv[1:])
