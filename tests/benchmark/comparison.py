"""Work and precision of one panel: our masters, libcosim on the same FMUs, and a monolithic Exudyn model.

    python -m tests.benchmark.comparison [SUBJECT ...] [--rounds N]

Subjects are `rigid`, `flexible` and `lock` of `one_panel`. Our master runs with its step control and, as Exudyn does,
with one step size before the latch and one after it; both get the same pairs of these. Every setting runs in each of
the interleaved rounds (settings slower than a second once) and keeps its best wall time; nothing that loads, builds
or assembles is timed. Errors are relative, of latch time and latch torque peak, against a tight run of our master and
a tight run of Exudyn. Explicit masters on the flexible panel need minutes to hours: their largest stable step is
searched, steps are timed, the whole is estimated (~); larger steps being unstable, it stands at every error level. So
are PythonFMUs on the rigid panel, whose errors are those of native ones. Endpoint wrenches cannot lock, so the lock
has no explicit masters.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from fmus import Backend, native_library
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from tests.benchmark import exudyn_panel
from tests.benchmark.exudyn_panel import tight_steps
from tests.benchmark.hosts.libcosim_wing import Attempt, Lines, co_simulate, cost_of_step, largest_step
from tests.benchmark.models.exudyn_model import Steps
from tests.benchmark.models.one_panel import UNTIL, Subject, Trial, couple, subjects
from tests.benchmark.stability import MasterName

TOLERANCES: dict[Backend, tuple[float, ...]] = {
    "native": (1.0, 3e-1, 1e-1, 6e-2, 4e-2, 2.5e-2, 1e-2, 5e-3, 3e-3, 1e-3, 1e-4, 1e-5),
    "python": (1e-1, 1e-2),
}
EXPLICIT: tuple[MasterName, ...] = ("jacobi", "gauss-seidel")
EXPLICIT_STEPS = (1e-4, 5e-5, 2e-5)
TWO_STEPS = (
    *product((1e-1, 5e-2, 2e-2), (2e-2, 1e-2, 5e-3, 2.5e-3)),
    (1e-2, 5e-3),
    (1e-2, 3e-3),
    (5e-3, 2.5e-3),
    (5e-3, 2e-3),
    (2e-3, 1e-3),
    (1e-3, 5e-4),
    (5e-4, 2.5e-4),
)
"""Before the latch and after it, s: of ours and of Exudyn's alike."""
ONE_STEP = (1e-2, 5e-3, 4e-3, 3e-3, 2e-3, 1e-3, 5e-4)
PYTHON_WINDOW = 300
LEVELS = (2e-2, 6e-3, 1e-3, 1e-4)
OURS, TWO_STEPS_OF_OURS, MONOLITH = "fanfold, native", "fanfold, native, two steps", "exudyn"
_OFF = 0.5
"""A larger relative error is no answer: the run diverged."""


class Entry(NamedTuple):
    """One setting of one series; `run` gives a trial, an estimate of its wall time only where `estimated`."""

    series: str
    setting: str
    run: Callable[[], Trial]
    estimated: bool = False


class Row(NamedTuple):
    """What an entry gave: errors of latch time and of peak against our reference, then against Exudyn's."""

    entry: Entry
    trial: Trial
    ours: tuple[float, float]
    theirs: tuple[float, float]

    @property
    def worst(self) -> float:
        """The larger error against our reference."""
        return max(self.ours)


def plan(subject: Subject) -> Iterator[Entry]:
    """All settings of a subject."""
    backends: tuple[Backend, ...] = ("native", "python") if native_library() else ("python",)
    for backend in backends:
        for tolerance in TOLERANCES[backend]:
            yield Entry(f"fanfold, {backend}", f"tol {tolerance:g}", _implicit(subject, backend, tolerance))
    for free, latched in TWO_STEPS:
        setting = f"H {free * 1e3:g}, {latched * 1e3:g} ms"
        if native_library():
            yield Entry(TWO_STEPS_OF_OURS, setting, _planned(subject, free, latched))
        yield Entry(MONOLITH, setting, _monolith(subject, Steps(free, latched)))
    for h in ONE_STEP:
        yield Entry(f"{MONOLITH}, one step", f"H {h * 1e3:g} ms", _monolith(subject, Steps(h, h)))
    if not subject.locks:
        yield from _explicit(subject, backends)


def _implicit(subject: Subject, backend: Backend, tolerance: float) -> Callable[[], Trial]:
    assembly = subject.assembly()
    return lambda: couple(as_fmus(assembly, backend), assembly, Settings(tolerance=tolerance))[1]


def _planned(subject: Subject, free: float, latched: float) -> Callable[[], Trial]:
    assembly, settings = subject.assembly(), Settings(tolerance=1e-2, step_plan=[[free], [latched]])
    return lambda: couple(as_fmus(assembly, "native"), assembly, settings)[1]


def _monolith(subject: Subject, steps: Steps) -> Callable[[], Trial]:
    return lambda: exudyn_panel.deploy(subject, steps)


def _explicit(subject: Subject, backends: Sequence[Backend]) -> Iterator[Entry]:
    """Explicit masters, ours and libcosim: whole runs of rigid native FMUs, estimates of all others."""
    for name in (*EXPLICIT, "libcosim"):
        found: float | None = None
        for backend in backends:
            attempt = _attempt(subject, name, backend)
            series = f"{name}, {backend}"
            if backend == "native" and not subject.data.frequency.size:
                for h in EXPLICIT_STEPS:
                    yield Entry(series, f"H {h * 1e6:g} us", lambda a=attempt, h=h: _whole(a, h))
                found = EXPLICIT_STEPS[1]
                continue
            if found is None:
                cost = largest_step(attempt, UNTIL)
            else:
                cost = cost_of_step(attempt, found, UNTIL, PYTHON_WINDOW) or largest_step(attempt, UNTIL)
            found = cost.h
            trial = Trial(np.nan, np.nan, cost.total, round(UNTIL / cost.h))
            yield Entry(series, f"H {cost.h * 1e6:g} us", lambda t=trial: t, estimated=True)


def _attempt(subject: Subject, name: str, backend: Backend) -> Attempt:
    assembly = subject.assembly("endpoint")
    if name == "libcosim":
        return lambda h, until: co_simulate(assembly, backend, h, until)

    def attempt(h: float, until: float) -> Lines:
        master: MasterName = "jacobi" if name == "jacobi" else "gauss-seidel"
        record, trial = couple(as_fmus(assembly, backend), assembly, Settings(fixed_step=h), master, until)
        return Lines([trial] if record.times[-1] > until - 0.5 * h else None, trial.wall)

    return attempt


def _whole(attempt: Attempt, h: float) -> Trial:
    found = attempt(h, UNTIL)
    return found.trials[0] if found.trials else Trial(np.nan, np.nan, found.wall, 0)


def rounds(entries: Sequence[Entry], count: int) -> list[Trial]:
    """Run all entries one after the other, so many times over; the best wall time of each."""
    best = [entry.run() for entry in entries]
    for _ in range(count - 1):
        for i, entry in enumerate(entries):
            if best[i].wall < 1.0 and not entry.estimated:
                again = entry.run()
                best[i] = best[i]._replace(wall=min(best[i].wall, again.wall))
    return best


def errors(trial: Trial, reference: Trial) -> tuple[float, float]:
    """Relative errors of latch time and peak; NaN where there is no answer."""
    found = abs(trial.latch / reference.latch - 1.0), abs(trial.peak / reference.peak - 1.0)
    return found if max(found) < _OFF else (np.nan, np.nan)


def compare(subject: Subject, count: int) -> None:
    """Run and print one subject."""
    assembly = subject.assembly()
    _, ours = couple(as_fmus(assembly), assembly, Settings(tolerance=1e-6))
    theirs = exudyn_panel.deploy(subject, tight_steps()[1])
    print(f"\n{subject.name}, {UNTIL:g} s")
    for name, tight in (("fanfold, tol 1e-6", ours), ("exudyn, tight", theirs)):
        print(f"  reference {name}: latch {tight.latch:.7f} s, peak {tight.peak:.4f} N.m")
    apart = errors(theirs, ours)
    print(f"  they differ by {apart[0]:.1e} in latch time and {apart[1]:.1e} in peak")
    entries = list(plan(subject))
    rows = [
        Row(entry, trial, errors(trial, ours), errors(trial, theirs))
        for entry, trial in zip(entries, rounds(entries, count), strict=True)
    ]
    print_rows(rows)
    print_levels(rows)


def print_rows(rows: Sequence[Row]) -> None:
    """Every setting."""
    print(f"{'':<42}{'against fanfold':>22}{'against exudyn':>22}")
    print(
        f"{'series':<28}{'setting':<14}" + f"{'latch':>11}{'peak':>11}" * 2 + f"{'wall, s':>12}{'steps':>11}"
    )
    for row in rows:
        numbers = (*row.ours, *row.theirs)
        missing = "estimate" if row.entry.estimated else "diverged"
        texts = "".join(f"{missing if np.isnan(e) else f'{e:.1e}':>11}" for e in numbers)
        wall = f"{'~' if row.entry.estimated else ''}{row.trial.wall:.4g}"
        print(f"{row.entry.series:<28}{row.entry.setting:<14}{texts}{wall:>12}{row.trial.steps:>11}")


def print_levels(rows: Sequence[Row]) -> None:
    """The quickest setting of every series at error levels, as ratios to ours on native FMUs, and Exudyn over ours."""
    series = list(dict.fromkeys(row.entry.series for row in rows))
    print("wall time in s at errors of both kinds below a level, and ratio to our master on native FMUs")
    print(f"{'series':<28}" + "".join(f"{f'{level:g}':>23}" for level in LEVELS))
    fastest = {name: [_fastest(rows, name, level) for level in LEVELS] for name in series}
    base = fastest.get(OURS, [np.nan] * len(LEVELS))
    for name, walls in fastest.items():
        mark = "~" if any(row.entry.estimated for row in rows if row.entry.series == name) else ""
        cells = [
            "-" if np.isnan(w) else f"{mark}{w:.3g} ({w / b:.3g})" for w, b in zip(walls, base, strict=True)
        ]
        print(f"{name:<28}" + "".join(f"{cell:>23}" for cell in cells))
    for name in (OURS, TWO_STEPS_OF_OURS):
        if name in fastest:
            over = [theirs / ours for theirs, ours in zip(fastest[MONOLITH], fastest[name], strict=True)]
            print(f"{MONOLITH} over {name:<18}" + "".join(f"{ratio:>23.3g}" for ratio in over))


def _fastest(rows: Sequence[Row], series: str, level: float) -> float:
    walls = [
        row.trial.wall
        for row in rows
        if row.entry.series == series and (row.entry.estimated or row.worst <= level)
    ]
    return min(walls, default=np.nan)


def main() -> None:
    """Command line."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    known = subjects()
    parser.add_argument("subject", nargs="*", default=list(known), help=", ".join(known))
    parser.add_argument("--rounds", type=int, default=3)
    chosen = parser.parse_args()
    for name in chosen.subject:
        compare(known[name], chosen.rounds)


if __name__ == "__main__":
    main()
