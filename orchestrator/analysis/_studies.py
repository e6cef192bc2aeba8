"""Studies: the same scene run several times with one thing changed, and what differs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter, NullLocator
from numpy.typing import NDArray
from rich.table import Table

from ..assembly import Assembly
from ..cli.progress import progress
from ..cosim.master import Settings
from ..results.key_figures import line_latch_torque
from ..results.result import Result
from ..run.run import Outcome, RunError, run
from ..views.style import STYLE, draw, new_figure
from ._tables import plain_table

Vector = NDArray[np.float64]

_NUMBER = 7


@dataclass(frozen=True)
class Case:
    """One run of a study: what it is called, what it changed, how it went."""

    label: str
    value: float
    outcome: Outcome


def refuse_unlatched(reference: Case) -> None:
    """RunError where no line latched, so that there is nothing to compare."""
    if not reference.outcome.headline.latch_times:
        end = reference.outcome.headline.end_time
        raise RunError(
            f"{reference.label}: no hinge line latched within {end:g} s, so there is nothing to compare; "
            f"run longer, such as --set scene.until={2.0 * end:g}"
        )


def run_case(
    label: str, value: float, assembly: Assembly, path: Path, settings: Settings, until: float
) -> Case:
    """Run an assembly with a progress bar; RunError where it does not finish."""
    with progress(f"{assembly.name}, {label}", until) as watch:
        return Case(label, value, run(assembly, path, settings, until, watch=watch))


def latch_table(title: str, cases: Sequence[Case], reference: Case) -> Table:
    """Latch times and latch torque peaks of every case, with their differences from the reference."""
    table = plain_table(title)
    table.add_column("case")
    for heading in (
        "line",
        "latch-up, s",
        "change, s",
        "peak, N.m",
        "change, %",
        "steps",
    ):
        table.add_column(heading, justify="right", min_width=_NUMBER)
    for case in cases:
        first = True
        for line, time, shift, peak, change in latch_rows(case, reference):
            steps = str(case.outcome.costs.steps) if first else ""
            name = case.label if first else ""
            table.add_row(name, line, f"{time:.6f}", f"{shift:+.2e}", f"{peak:.5g}", f"{change:+.3f}", steps)
            first = False
    return table


def latch_rows(case: Case, reference: Case) -> list[tuple[str, float, float, float, float]]:
    """Line, latch time (s), its shift (s), latch torque peak (N.m), its change (%), for lines that both latched.

    A run that ends at latch-up has no torque to compare with, so such a line is left out.
    """
    here, there = case.outcome.headline, reference.outcome.headline
    return [
        (
            line,
            time,
            time - there.latch_times[line],
            here.latch_torque_peaks[line],
            100.0 * (here.latch_torque_peaks[line] / there.latch_torque_peaks[line] - 1.0),
        )
        for line, time in here.latch_times.items()
        if line in there.latch_times and there.latch_torque_peaks[line]
    ]


def as_dict(cases: Iterable[Case], reference: Case) -> list[dict[str, object]]:
    """For JSON."""
    return [
        {
            "case": case.label,
            "value": case.value,
            "steps": case.outcome.costs.steps,
            "lines": {
                line: {
                    "latch_time": time,
                    "shift": shift,
                    "latch_torque_peak": peak,
                    "change_percent": change,
                }
                for line, time, shift, peak, change in latch_rows(case, reference)
            },
        }
        for case in cases
    ]


def draw_latch_torques(path: Path, title: str, cases: Sequence[Case], ringing: float) -> None:
    """Latch torque of every line that latched, all cases over each other, for a time (s) after latch-up."""
    lines = list(cases[-1].outcome.headline.latch_times)
    with mpl.rc_context(STYLE):
        figure, axes = new_figure(title, [1.0] * len(lines))
        for panel, name in zip(axes, lines, strict=True):
            for k, case in enumerate(cases):
                result = Result.open(case.outcome.path)
                start = case.outcome.headline.latch_times.get(name)
                if start is None:
                    continue
                line = next(line for line in result.hinge_lines if line.name == name)
                shown = (result.time >= start - 0.05 * ringing) & (result.time <= start + ringing)
                torque = line_latch_torque(result, line)[shown]
                draw(panel, 1e3 * (result.time[shown] - start), [(case.label, torque)], first=k)
            panel.set(xlabel="time since latch-up, ms", ylabel=f"{name} latch torque, N.m")
            panel.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, frameon=False)
        figure.savefig(path)


def draw_changes(
    path: Path, title: str, label: str, cases: Sequence[Case], reference: Case, *, log: bool
) -> None:
    """Change of every latch torque peak (%) over what the study changed, the reference left out."""
    curves: dict[str, tuple[list[float], list[float]]] = {}
    for case in cases:
        if case is reference:
            continue
        for line, _, _, _, change in latch_rows(case, reference):
            values, changes = curves.setdefault(line, ([], []))
            values.append(case.value)
            changes.append(abs(change))
    with mpl.rc_context(STYLE):
        figure, (axes,) = new_figure(title, [1.2])
        for k, (line, (values, changes)) in enumerate(curves.items()):
            draw(axes, np.array(values), [(line, np.array(changes))], first=k)
            axes.lines[-1].set_marker("o")
        axes.set(xlabel=label, ylabel="change of latch torque peak, %")
        _plain_decades(axes, [change for _, changes in curves.values() for change in changes])
        studied = sorted({value for values, _ in curves.values() for value in values})
        if log and studied and studied[0] > 0.0:
            axes.set_xscale("log")
            axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticks(studied, [f"{value:g}" for value in studied])
        axes.margins(x=0.05)
        axes.legend(loc="best", frameon=False)
        figure.savefig(path)


def _plain_decades(axes: Axes, changes: Sequence[float]) -> None:
    """A logarithmic y axis over whole decades, at least one, with plain numbers; linear where nothing changed."""
    above = [change for change in changes if change > 0.0]
    if not above:
        return
    low, high = np.floor(np.log10(min(above))), np.ceil(np.log10(max(above)))
    axes.set(yscale="log", ylim=(10.0**low, 10.0 ** max(high, low + 1.0)))
    axes.yaxis.set_major_locator(LogLocator(numticks=8))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
