"""Settings of a master: accuracy, steps, messages, rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf

from ..assembly import Driving
from .ports import Order

TIME_ROUNDING = 1e-12  # s, what sums of step sizes may leave


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of the master.

    tolerance: requested relative accuracy of a run. largest_step, smallest_step, start_step: at the tolerance 1e-4;
    the library scales them with the tolerance (`coupling_take_tolerance`). smallest_step: limit of step-size control.
    start_step: largest step before two steps allow an error estimate, at the start and after events; vibrations that
    start there, of joints under motors or latches, begin with these steps. fixed_step:
    constant communication step size instead of control, divided only if it does not converge. step_plan: step sizes of
    an earlier run to follow, one list per segment between events. driving: reference energy and load of the scene.
    order: of the coupling; None: the best one. snapshot_every: time (s) between snapshots for `keep` of the master;
    they change last digits. asked_tolerance: tolerance that results are compared with, if a smaller one is used.
    most_steps: communication steps after which the implicit master gives up.
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
    most_steps: float = inf
    progress: Callable[[float, float], None] = field(default=lambda time, h: None)
