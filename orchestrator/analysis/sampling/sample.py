"""One sample of a study: a scene with drawn values deployed in a process of its own, and what is kept of it."""

from __future__ import annotations

import atexit
import threading
import warnings
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field

import numpy as np

from components import FanfoldError
from components.contract.component import Vector
from fmus import Backend

from ...results.requirements import margin_of
from ...results.result import Result
from ...results.signal import matches
from ...run.errors import InterruptedRunError, RunError
from ...run.run import Loader, kept_fmus
from ...run.simulation import Options, simulate
from ...scene.builder import Scene
from .varied import Settings


@dataclass(frozen=True, slots=True)
class Task:
    """What all samples of a study share.

    signals: patterns of those to keep, at so many `points` of time from 0 to the end of the run, or at given `times`
    (s). estimate: tell the errors of headline numbers, and repeat runs that are likely to miss their tolerance.
    """

    scene: Scene
    options: Options
    estimate: bool = False
    signals: tuple[str, ...] = ()
    points: int = 201
    times: tuple[float, ...] = ()

    @property
    def until(self) -> float:
        """End time of every run, s."""
        return self.options.until or self.scene.check().header.until


@dataclass(frozen=True, slots=True)
class Sample:
    """How one run went.

    message: why it failed, empty where it did not. numbers: value, unit and estimated error (None for none) of
    headline numbers, by identifier. opened: of every line with a latch or an end stop. signals: (times,) by
    COMPONENT.VARIABLE.
    """

    index: int
    message: str = ""
    numbers: Mapping[str, tuple[float, str, float | None]] = field(default_factory=dict)
    opened: Mapping[str, bool] = field(default_factory=dict)
    signals: Mapping[str, tuple[Sequence[float], str]] = field(default_factory=dict)


class _Fmus(threading.local):
    """The FMUs of a worker, which one sample hands on to the next; threads of a cluster's worker have their own."""

    def __init__(self) -> None:
        self._stack = ExitStack()
        self._kept: dict[tuple[Backend | None, bool], Loader] = {}
        atexit.register(self.drop)

    def loader(self, options: Options) -> Loader:
        """Of these options."""
        key = options.backend, options.isolate
        if key not in self._kept:
            loader = kept_fmus(options.backend, isolate=options.isolate, files=False)
            self._kept[key] = self._stack.enter_context(loader)
        return self._kept[key]

    def drop(self) -> None:
        """As after a failure, from which they may not recover."""
        self._kept.clear()
        self._stack.close()


_fmus = _Fmus()


def run_sample(task: Task, index: int, settings: Settings) -> Sample:
    """Deploy the scene with these settings; what is foreseen to go wrong is the sample's message."""
    try:
        scene = task.scene.with_settings(settings).check_one_run()
        with (
            warnings.catch_warnings()
        ):  # of laws that the numbers of a sample lead out of their range, once each
            warnings.simplefilter("ignore")
            loader = _fmus.loader(task.options)
            run = simulate(scene, task.options, estimate=task.estimate, checks=False, fmus=loader)
        result = run.outcome.result
        found = run.outcome.headline
        return Sample(
            index,
            numbers={one.id: (float(one.value), one.unit, one.error) for one in found.numbers()}
            | {
                margin_of(one.text): (one.margin, one.unit, one.error)
                for one in found.requirements
                if one.margin is not None
            },
            opened=dict.fromkeys((*found.latch_times, *found.reached_stops), True)
            | dict.fromkeys(found.not_opened, False),
            signals=_signals(result, task),
        )
    except InterruptedRunError:  # of the whole study, not of this sample
        raise KeyboardInterrupt from None
    except FanfoldError as error:
        _fmus.drop()
        return Sample(index, error.reason if isinstance(error, RunError) else str(error))


def _signals(result: Result, task: Task) -> dict[str, tuple[Sequence[float], str]]:
    """Chosen signals at the task's times, linear between rows; components of vectors have a number."""
    found: dict[str, tuple[Sequence[float], str]] = {}
    times = task.times or np.linspace(0.0, task.until, task.points)
    for name in result.components if task.signals else ():
        for variable in result.variables(name):
            if any(matches((name, variable), one) for one in task.signals):
                values, unit = result.signal(name, variable), result.unit(name, variable)
                for label, column in _columns(f"{name}.{variable}", values):
                    found[label] = (np.interp(times, result.time, column).tolist(), unit)
    return found


def _columns(name: str, values: Vector) -> list[tuple[str, Vector]]:
    if values.ndim == 1:
        return [(name, values)]
    return [(f"{name}[{k}]", column) for k, column in enumerate(values.T, 1)]
