"""Feedback loops through an FMU of another tool that are unstable at its step."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from components.contract.component import Vector

from ..assembly import Assembly
from ..results.result import Result

_SWINGS, _GROWN = 16, 100.0
"""Changes of an output in a row, each against the one before and larger, and how many times the first the last of them
is, from which on they are no ringing of a wing that beats with the steps: of a wing at rest in a loop that grows by
1.1 a step 40 and 200, of one that rings at nearly half of the sampling rate 11 and 50."""


def sampled_loop_warnings(assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for each FMU with an output that alternates from step to step with growing amplitude."""
    for fmu in assembly.signal_fmus:
        names = [one.variable for one in fmu.outputs if result.has(fmu.name, one.variable)]
        growing = [name for name in names if _swings(result.signal(fmu.name, name))]
        if growing:
            name = growing[0]
            largest = float(np.abs(result.signal(fmu.name, name)).max())
            yield (
                f"fmu.{fmu.name}: {name} alternates from step to step of {fmu.step:g} s with growing amplitude, up "
                f"to {largest:.3g} {result.unit(fmu.name, name)}, because its feedback loop is unstable at this "
                "step. Use a smaller step or smaller gains."
            )


def _swings(values: Vector) -> bool:
    """Whether a signal (N,) of constant pieces goes to and fro, ever further."""
    if values.ndim != 1:
        return False
    changes = np.diff(values)
    changes = changes[changes != 0.0]
    further = (changes[1:] * changes[:-1] < 0.0) & (np.abs(changes[1:]) > np.abs(changes[:-1]))
    ends = [-1, *np.flatnonzero(~further).tolist(), further.size]
    return any(
        stop - start > _SWINGS and abs(changes[stop]) > _GROWN * abs(changes[start + 1])
        for start, stop in pairwise(ends)
    )
