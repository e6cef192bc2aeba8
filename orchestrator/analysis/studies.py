"""Studies: the same scene run several times with one thing changed, and what differs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..run.run import Outcome, RunError

Vector = NDArray[np.float64]


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
