"""Settings of a master: accuracy, steps, messages, rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ..assembly import Driving
from .ports import Order


@dataclass(frozen=True, slots=True)
class Settings:
    """Numbers of the master.

    tolerance: relative accuracy asked of a run. largest_step, smallest_step, start_step: down to a tolerance of 1e-4;
    below, they go with its root, as the rotations' error goes with the square of a step. smallest_step: that accuracy
    may ask for. start_step: the largest before errors can be told, for which two steps must be seen, at the start and
    after events; what rings from then on, as joints do from motors that start or latches that damp, begins in these.
    fixed_step: constant communication step size instead of control, divided only where it does not converge.
    step_plan: step sizes of an earlier run to follow, one list per segment between events. driving: what drives the
    scene. order: of the coupling; None: what is best.
    snapshot_every: time (s) after which `keep` of the master is given a snapshot; it changes last digits.
    asked_tolerance: what a result is judged by, where a smaller tolerance is taken to keep it. compiled: whether a run
    takes `CompiledMaster`.
    """

    tolerance: float = 1e-4
    largest_step: float = 0.02
    smallest_step: float = 2e-5
    start_step: float = 2e-5
    fixed_step: float | None = None
    step_plan: Sequence[Sequence[float]] | None = None
    driving: Driving = field(default_factory=Driving)
    order: Order | None = None
    snapshot_every: float | None = None
    asked_tolerance: float | None = None
    compiled: bool = True
    progress: Callable[[float, float], None] = field(default=lambda time, h: None)
