"""Rows of the ablations: a run of an assembly, its wall time, and its errors against a tight run of the full model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from time import perf_counter

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from orchestrator.assembly import Assembly
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import Participant
from orchestrator.cosim.settings import Settings
from orchestrator.results.recorder import NoRecorder
from orchestrator.run.run import Outcome, as_fmus, run

_MARKERS = "os^vDPX*<>hpd8H"
Loading = Callable[[Assembly], AbstractContextManager[Sequence[Participant]]]


@dataclass
class Row:
    """What is run, and what came of it: wall times of all repeats (s), the outcome of the last."""

    name: str
    assembly: Assembly
    tolerance: float | None = None
    fixed_step: float | None = None
    load: Loading = as_fmus
    recorded: bool = True
    walls: list[float] = field(default_factory=list)
    outcome: Outcome | None = None

    @property
    def wall(self) -> float:
        """Median wall time (s)."""
        return median(self.walls)

    def measure(self, folder: Path, tolerance: float, until: float) -> None:
        """Run once more, at its own tolerance if it has one."""
        settings = Settings(
            tolerance=self.tolerance or tolerance,
            largest_step=self.assembly.largest_step,
            fixed_step=self.fixed_step,
        )
        if self.recorded:
            self.outcome = run(self.assembly, folder / "run.h5", settings, until, load=self.load)
            self.walls.append(self.outcome.costs.wall_time)
            return
        with self.load(self.assembly) as participants:
            network = Network(participants, self.assembly.links, 4)
            master = Master(network, self.assembly.hinge_lines, NoRecorder(), settings)
            start = perf_counter()
            master.initialize(preload=self.assembly.preload)
            master.run(until)
            self.walls.append(perf_counter() - start)


def measure_all(rows: Sequence[Row], folder: Path, tolerance: float, until: float, repeats: int) -> None:
    """Run all rows in turn, so many times over."""
    for _ in range(repeats):
        for row in rows:
            row.measure(folder, tolerance, until)


def error(outcome: Outcome, reference: Outcome) -> tuple[float, float]:
    """Largest error of a latch time (s), largest relative error of a latch torque peak; NaN where one is missing."""
    found, true = outcome.headline, reference.headline
    times = [abs(found.latch_times.get(k, np.nan) - v) for k, v in true.latch_times.items()]
    peaks = [
        abs(found.latch_torque_peaks.get(k, np.nan) / v - 1.0) for k, v in true.latch_torque_peaks.items()
    ]
    return float(np.max(times)), float(np.max(peaks))


def print_table(rows: Sequence[Row], reference: Outcome, base: Row) -> None:
    """Every row: median wall time, its ratio to that of `base`, what it took, its errors."""
    heads = f"{'wall s':>7} {'ratio':>6} {'steps':>7} {'iterations':>11} {'time, ms':>9} {'peak':>8}"
    print(f"{'':36} {heads}")
    for row in rows:
        line = f"{row.name:36} {row.wall:7.2f} {row.wall / base.wall:6.2f}"
        if row.outcome is not None:
            late, peak = error(row.outcome, reference)
            costs = row.outcome.costs
            line += f" {costs.steps:7d} {costs.iterations:11d} {1e3 * late:9.3f} {peak:8.1e}"
        print(line)


def draw(tables: dict[str, tuple[Sequence[Row], Outcome]], path: Path) -> None:
    """Wall time against the error in latch torque peaks, one picture per table of rows and their reference."""
    figure = Figure(figsize=(8.5, 4.5 * len(tables)), layout="constrained")
    axes = figure.subplots(len(tables), 1, squeeze=False)[:, 0]
    for axis, (title, (rows, reference)) in zip(axes, tables.items(), strict=True):
        for number, row in enumerate(rows):
            if row.outcome is not None:
                peak = error(row.outcome, reference)[1]
                color, marker = f"C{number % 10}", _MARKERS[number % len(_MARKERS)]
                axis.loglog(row.wall, peak, marker, color=color, label=row.name)
        axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.set(title=title, xlabel="wall time, s", ylabel="largest relative error of a latch torque peak")
        axis.grid(which="both", alpha=0.3)
        axis.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=120)
