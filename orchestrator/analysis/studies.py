"""Studies: the same scene run several times with one thing changed, and what differs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..assembly import Assembly
from ..cosim.settings import Settings
from ..records import short_repr
from ..run.progress import Progress, followed
from ..run.run import Outcome, RunError, run


@dataclass(frozen=True)
class Case:
    """One run of a study: what it is called, what it changed, how it went."""

    label: str
    value: float
    outcome: Outcome


@short_repr
@dataclass(frozen=True)
class LatchStudy:
    """Finished runs of a scene with one thing changed; RunError where no line latched in the last, the reference.

    changed: label of what was changed, with its unit. title, against: what the study and its reference are called.
    """

    scene: str
    title: str
    against: str
    changed: str
    cases: Sequence[Case]
    beside: Sequence[Case] = ()
    """runs without a value of what was changed, told of first"""

    def __post_init__(self) -> None:
        refuse_unlatched(self.reference)

    @property
    def reference(self) -> Case:
        """What all others are set against."""
        return self.cases[-1]

    @property
    def shown(self) -> list[Case]:
        """All runs, in the order in which they are told of."""
        return [*self.beside, *self.cases]

    def as_dicts(self) -> list[dict[str, object]]:
        """One plain record per run, for JSON."""
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
                    for line, time, shift, peak, change in latch_rows(case, self.reference)
                },
            }
            for case in self.shown
        ]


def run_case(
    label: str,
    value: float,
    assembly: Assembly,
    path: Path | None,
    settings: Settings,
    progress: Progress,
) -> Case:
    """Run an assembly as a case of a study, into a folder that is made if missing; RunError if it does not finish."""
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
    with followed(progress, f"{assembly.name}, {label}", assembly.until) as watch:
        return Case(label, value, run(assembly, path, settings, assembly.until, watch=watch))


def refuse_without_latches(assembly: Assembly) -> None:
    """RunError where no hinge line of an assembly has a latch, so that there is nothing to run for."""
    if not any(line.latches for line in assembly.hinge_lines):
        raise RunError(
            f"{assembly.name}: no hinge line of it has a latch, and latch-ups are what is compared"
        )


def refuse_unlatched(reference: Case) -> None:
    """RunError where no line latched, so that there is nothing to compare."""
    if not reference.outcome.headline.latch_times:
        end = reference.outcome.headline.end_time
        raise RunError(
            f"{reference.label}: no hinge line latched within {end:g} s, so there is nothing to compare; "
            f"run longer, such as with the setting scene.until={2.0 * end:g}"
        )


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
