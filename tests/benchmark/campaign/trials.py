"""Trials of random wings, a line each, and what they come to; see the command beside it."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time

from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.hinges import line_latch
from orchestrator.cosim.settings import Settings
from orchestrator.results.energy_ledger import tolerance_taken
from orchestrator.run.error_estimate import with_estimates
from orchestrator.run.progress import Watch
from orchestrator.run.run import Outcome, RunError, run
from tests.benchmark.campaign.errors import (
    GROUPS,
    LARGEST,
    LOCK,
    Deviation,
    deviations,
    is_covered,
    misses,
    with_settled,
    worst,
)
from tests.references.random_wings import BODIES, load_wing

REFERENCES = (0.01, 0.1)
"""Tolerances of the reference over that of the run: what is wanted, and what replaces it where it fails."""
COLUMNS = {
    **dict(zip(GROUPS, ("time", "impulse", "torque", "largest", "force", "moment", "stop"), strict=True)),
    LOCK: "lock",
}


@dataclass(frozen=True)
class Trial:
    """What came of one wing. latches: kinds by line. reference: its share of the tolerance, 0 without one.

    steps: of run and reference. failure, reference_failure: sentences, empty where there was none.
    """

    seed: int
    bodies: int
    flexible: int
    free: bool
    latches: tuple[str, ...]
    tolerance: float
    steps: tuple[int, int] = (0, 0)
    reference: float = 0.0
    deviations: tuple[Deviation, ...] = ()
    failure: str = ""
    reference_failure: str = ""

    @property
    def counts(self) -> bool:
        """Whether there is a reference that is a hundred times as tight."""
        return self.reference == REFERENCES[0]

    def over_tolerance(self, group: str) -> float | None:
        """The largest error of a group over the tolerance."""
        found = worst(self.deviations, group)
        return None if found is None else found.error / self.tolerance


class _TooLong(Exception):
    """A run that takes more than its processor time."""


def _attempt(
    assembly: Assembly, tolerance: float, limit: float, path: Path, *, estimated: bool = False
) -> Outcome | str:
    """A run, or the sentence it failed with; a fault of the program is told by its type."""
    start, among = process_time(), ""

    def watch(time: float, h: float) -> None:
        if process_time() - start > limit:
            raise _TooLong(
                f"takes more than {limit:g} s{among}, is at t = {time:.4g} s with steps of {h:.1e} s"
            )

    @contextmanager
    def progress(_: str, __: float) -> Iterator[Watch]:
        nonlocal among
        among = " with its repetition"
        yield watch

    try:
        settings = Settings(tolerance, assembly.largest_step)
        outcome = run(assembly, path, settings, watch=watch)
        if estimated:
            outcome, _ = with_estimates(assembly, outcome, settings, progress=progress)
        return outcome
    except (RunError, _TooLong) as error:
        return str(error).removeprefix(f"{assembly.name}: ").partition("; results up to")[0]
    except Exception as error:  # whatever it is, the campaign goes on and tells of it
        return f"FAULT {type(error).__name__}: {error}"
    finally:
        path.unlink(missing_ok=True)


def try_wing(
    seed: int,
    tolerance: float | None = None,
    limit: float = 120.0,
    bodies: tuple[int, int] = BODIES,
    *,
    stops: bool = False,
) -> Trial:
    """Run the wing of a seed, and its reference; at the wing's own tolerance unless one is given."""
    scene = load_wing(seed, bodies, stops=stops)
    flexible = {body.name: body.default_fidelity != "rigid" for body in scene.bodies}
    kinds = {line.name: line_latch(scene, line, flexible, "mean").kind for line in scene.hinge_lines}
    wanted = tolerance or scene.header.tolerance
    told = partial(
        Trial,
        seed,
        len(scene.bodies),
        sum(flexible.values()),
        scene.base.free is not None,
        tuple(kinds.values()),
        wanted,
    )
    assembly = assemble(scene)
    with TemporaryDirectory(prefix="fanfold_campaign_") as folder:
        found = _attempt(assembly, wanted, limit, Path(folder) / "run.h5", estimated=True)
        if isinstance(found, str):
            return told(failure=found)
        sentence = ""
        path = Path(folder) / "reference.h5"
        for share in REFERENCES:
            tight = min(share * wanted, 0.1 * (tolerance_taken(found.result) or wanted))
            true = _attempt(assembly, tight, limit, path)
            if isinstance(true, str):
                sentence = sentence or true
                continue
            off = deviations(found, true)
            if misses(off, wanted, 10.0):
                off = _settled(off, true, _attempt(assembly, 3.0 * tight, limit, path), wanted)
            steps = found.costs.steps, true.costs.steps
            return told(steps=steps, reference=share, deviations=tuple(off), reference_failure=sentence)
    return told(steps=(found.costs.steps, 0), reference_failure=sentence)


def _settled(
    found: Sequence[Deviation], true: Outcome, coarser: Outcome | str, tolerance: float
) -> list[Deviation]:
    """The deviations, marked by a run at three times the tolerance of the reference."""
    if isinstance(coarser, str):
        return list(found)
    return with_settled(found, deviations(coarser, true), tolerance)


def campaign(
    seeds: Sequence[int], tolerance: float | None, limit: float, jobs: int, *, stops: bool = False
) -> Generator[Trial, None, None]:
    """All wings, in the order of their seeds, so many at a time; with end stops in place of most latches or not."""
    work = partial(try_wing, tolerance=tolerance, limit=limit, stops=stops)
    pool = ProcessPoolExecutor(jobs, mp_context=get_context("spawn"))
    try:
        yield from pool.map(work, seeds)
    finally:
        pool.shutdown(cancel_futures=True)


HEAD = (
    f"{'seed':>5} {'bodies':>6} {'flex':>4} {'base':5} {'latches':7} {'tolerance':>9} {'steps':>8} {'reference':>9} "
    + " ".join(f"{name:>8}" for name in COLUMNS.values())
)


def row(trial: Trial) -> str:
    """One line of the table; errors over tolerance."""
    latches = "".join({"none": "-"}.get(kind, kind[0]) for kind in trial.latches)
    errors = " ".join(f"{_text(trial.over_tolerance(group)):>8}" for group in COLUMNS)
    notes = [trial.failure] if trial.failure else []
    if trial.reference_failure:
        instead = f"a tenth instead of the reference, which {trial.reference_failure}"
        notes.append(instead if trial.reference else f"no reference: {trial.reference_failure}")
    notes += [f"{d.group} {d.of} off{'' if d.settled else ', not settled'}" for d in _worst_misses(trial)]
    return (
        f"{trial.seed:5d} {trial.bodies:6d} {trial.flexible:4d} {'free' if trial.free else 'fixed':5} {latches:7} "
        f"{trial.tolerance:9.1e} {trial.steps[0]:8d} {trial.steps[1]:9d} {errors}  {'; '.join(notes)}"
    )


def _text(value: float | None) -> str:
    return "." if value is None else f"{value:.2g}"


def _worst_misses(trial: Trial) -> list[Deviation]:
    missed = misses(trial.deviations, trial.tolerance, 10.0)
    return sorted(missed, key=lambda d: -d.error)[:1]


def summary(trials: Sequence[Trial]) -> Iterator[str]:
    """The campaign in a table and a few sentences."""
    ran = [trial for trial in trials if not trial.failure]
    counted = [trial for trial in ran if trial.counts]
    yield f"{len(trials)} wings: {len(ran)} ran, {len(counted)} of them have a reference at a hundredth"
    yield f"{'largest error over tolerance':28} {'wings':>6} {'median':>8} {'> 10':>6} {'> 100':>6}  worst (seed)"
    for group in COLUMNS:
        yield _group_row(group, counted)
    for factor in (10.0, 100.0):
        missed = [trial for trial in counted if misses(trial.deviations, trial.tolerance, factor)]
        settled = [t for t in missed if any(d.settled for d in misses(t.deviations, t.tolerance, factor))]
        yield f"{_missing(settled, factor)} miss {factor:g} tolerances in any but locks"
        restless = [trial for trial in missed if trial not in settled]
        yield f"{_missing(restless, factor)} miss them only in numbers that no tolerance settles"
    yield _doubt_sentence(counted)
    yield _estimate_sentence(counted)
    yield from _failures("runs", [(trial.seed, trial.failure) for trial in trials])
    yield from _failures("references", [(trial.seed, trial.reference_failure) for trial in trials])


def _missing(trials: Sequence[Trial], factor: float) -> str:
    honest = sum(all(d.told for d in misses(t.deviations, t.tolerance, factor)) for t in trials)
    seeds = ", ".join(str(trial.seed) for trial in trials) or "none"
    return f"{len(trials)} wings ({seeds}), {honest} of which say so themselves,"


def _group_row(group: str, trials: Sequence[Trial]) -> str:
    errors = {trial.seed: error for trial in trials if (error := trial.over_tolerance(group)) is not None}
    if not errors:
        return f"{group:28} {0:6d}"
    top = sorted(errors, key=lambda seed: -errors[seed])[:4]
    return (
        f"{group:28} {len(errors):6d} {median(errors.values()):8.2g} {sum(e > 10.0 for e in errors.values()):6d} "
        f"{sum(e > 100.0 for e in errors.values()):6d}  " + ", ".join(f"{errors[s]:.2g} ({s})" for s in top)
    )


def _estimate_sentence(trials: Sequence[Trial]) -> str:
    of_tolerance = [(d, t.tolerance) for t in trials for d in t.deviations if d.group in GROUPS]
    verdicts = [is_covered(d, tolerance) for d, tolerance in of_tolerance]
    judged = [verdict for verdict in verdicts if verdict is not None]
    if not judged:
        return "no estimated errors to compare"
    sure = sum(v is None and d.estimate is not None for v, (d, _) in zip(verdicts, of_tolerance, strict=True))
    everything = len(judged) + sure
    of_all = (sum(judged) + sure) / everything
    return (
        f"{sum(judged)} of {len(judged)} estimated errors ({sum(judged) / len(judged):.0%}) cover the true ones "
        f"within a factor of two; of all {everything}, {of_all:.0%}, as {sure} are rightly below a tenth of the "
        "tolerance, where the reference errs as well"
    )


def _doubt_sentence(trials: Sequence[Trial]) -> str:
    told = [(d, trial) for trial in trials for d in trial.deviations if d.told and d.group != LARGEST]
    wrong = sum(d.error > 10.0 * trial.tolerance for d, trial in told)
    return f"{len(told)} numbers are not vouched for to 10 tolerances; {wrong} of them miss these"


def _failures(what: str, found: Sequence[tuple[int, str]]) -> Iterator[str]:
    """How many failed by which sentence, numbers and names left out."""
    failed = [(seed, sentence) for seed, sentence in found if sentence]
    yield f"{len(failed)} {what} failed"
    kinds = Counter(_kind(sentence) for _, sentence in failed)
    for kind, count in kinds.most_common():
        seeds = ", ".join(str(seed) for seed, sentence in failed if _kind(sentence) == kind)
        yield f"  {count:4d} {kind}: {seeds}"


def _kind(sentence: str) -> str:
    """A sentence up to its first reason; what is found by an impulse, a step of 1e-07 s, stays apart."""
    first = sentence if sentence.startswith("FAULT") else sentence.partition(": ")[0]
    first = first.replace("step of 1e-07 s", "impulse")
    return re.sub(r"(?<![A-Za-z])[-+]?\d[\d.]*(e[-+]?\d+)?", "...", first)


_OF_TRIAL = (
    "seed", "bodies", "flexible", "free", "latches", "tolerance", "steps", "reference_steps", "reference_share"
)  # fmt: skip
_NOTHING = Deviation("", "", 0.0, None, None, None)


@contextmanager
def kept_in(path: Path | None) -> Iterator[Callable[[Trial], None]]:
    """What writes a trial at once, so that an interrupted campaign leaves its rows; nothing where there is no path."""
    if path is None:
        yield lambda trial: None
        return
    with path.open("w", newline="", encoding="utf-8", buffering=1) as file:
        writer = csv.writer(file)
        writer.writerow((*_OF_TRIAL, *Deviation._fields, "failure"))
        yield lambda trial: writer.writerows(_rows(trial))


def _rows(trial: Trial) -> Iterator[tuple[object, ...]]:
    """Every deviation of a trial, in one row at least, as a failure has none."""
    head = (
        trial.seed, trial.bodies, trial.flexible, trial.free, " ".join(trial.latches), trial.tolerance,
        *trial.steps, trial.reference,
    )  # fmt: skip
    for found in trial.deviations or (_NOTHING,):
        yield (*head, *found, trial.failure or trial.reference_failure)
