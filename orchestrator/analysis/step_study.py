"""How far a result depends on the communication step size: fixed steps, and step control at its tolerance.

The study of Bagnoli (2007), section 3.3.6, whose solver needed a largest step of 1e-4 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..assembly import Assembly
from ..assembly.statics.start import static_start
from ..cosim.settings import Settings
from ..run.progress import Progress, silent
from ..run.run import RunError
from .studies import LatchStudy, refuse_unlatched, refuse_without_latches, run_case

_SMALLEST, _LARGEST = 1e-7, 1.0


def step_label(step: float) -> str:
    """How a step size (s) is called in tables and names of files."""
    return f"{step:g} s"


def study_steps(steps: Sequence[float]) -> tuple[float, ...]:
    """Step sizes (s) of a study, falling; RunError where they are none, or fewer than two."""
    found = tuple(sorted(set(steps), reverse=True))
    different = len({step_label(step) for step in found}) >= max(2, len(found))
    if not different or not all(_SMALLEST <= step <= _LARGEST for step in found):
        raise RunError("give at least two different step sizes between 1e-7 and 1 s")
    return found


def step_study(
    assembly: Assembly,
    steps: Sequence[float],
    tolerance: float | None = None,
    folder: Path | None = None,
    progress: Progress = silent,
) -> LatchStudy:
    """Runs at fixed step sizes (s) beside one with step control; results in the folder, if there is one."""
    refuse_without_latches(assembly)
    assembly = static_start(assembly).assembly
    steps = study_steps(steps)
    controlled = Settings(tolerance or assembly.tolerance, assembly.largest_step)

    def path(name: str) -> Path | None:
        return None if folder is None else folder / f"{name.replace(' ', '_')}.h5"

    label = f"tolerance {controlled.tolerance:g}"
    adaptive = run_case(label, 0.0, assembly, path("controlled"), controlled, progress)
    refuse_unlatched(adaptive)
    cases = []
    for h in steps:
        settings = Settings(controlled.tolerance, fixed_step=h)
        cases.append(run_case(step_label(h), h, assembly, path(step_label(h)), settings, progress))
    smallest = f"steps of {step_label(steps[-1])}"
    changed = "communication step size, s"
    return LatchStudy(assembly.name, "Latch-up and step size", smallest, changed, cases, [adaptive])
