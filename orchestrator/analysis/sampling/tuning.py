"""Values of a scene's keys that bring headline numbers, or curves, where they are wanted: bounded least squares.

Every run is a deployment. Derivatives are differences of runs, as many as there are keys, which workers share.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import scipy

from components import FanfoldError
from components.contract.component import Vector

from ...records import short_repr
from ...scene.units import UNITS
from .distributions import StudyError
from .sample import Sample, Task, run_sample
from .targets import Curve, Target, of_sensors, refuse_unknown
from .varied import Settings, Varied, own_value, value_at
from .workers import local

_STEP = 2e-3
"""Difference of a key over its range: far above what the errors of runs make of numbers, and nearly linear."""
_ACCURACY = 1e-4
_BEYOND_END = 1.0 + 1e-9
_WELL = 0.3
"""Of a residual, what a step may leave of it for the derivatives that it was made with to be kept."""
_TIE = 0.01
"""Of the accuracy, what the whole range of a key weighs: values that meet the targets are those next to the start."""
_BLIND = 1e-4
"""Of the largest singular value: a combination of keys that moves all targets less is not told by them."""
_AT_END = 0.01
"""Of a range, from where its end is what keeps a search, which never quite comes to it."""
_NEAR, _JUMP = 0.01, 100.0
"""Shares of ranges between two runs, and how many times what derivatives say their numbers differ where one jumps."""


@dataclass(frozen=True, slots=True)
class Reached:
    """A target number in its unit: at the start, at the end of the search, and its target."""

    number: str
    unit: str
    start: float
    found: float
    wanted: float


@short_repr
@dataclass(frozen=True, slots=True)
class Tuned:
    """Result of a tuning. values, start: tuned and initial values of the varied keys, in the unit of their range.

    settings: keys of the scene with tuned values. residual, start_residual: largest relative difference to a target,
    of a curve the root mean square relative to its range. derivatives: of target numbers (rows, in their units) with
    respect to varied keys (columns). at_ends: keys at a bound of their range, if targets are missed. blind: keys that
    the targets do not determine. runs: equivalent number of deployments. jumps: sentences on numbers that change
    discontinuously, if targets are missed.
    """

    scene: str
    values: dict[str, float]
    start: dict[str, float]
    units: dict[str, str]
    settings: Settings
    numbers: tuple[Reached, ...]
    residual: float
    start_residual: float
    derivatives: Vector
    reached: bool
    at_ends: tuple[str, ...]
    blind: tuple[str, ...]
    jumps: tuple[str, ...]
    runs: int


class _ReachedError(FanfoldError):
    """The targets are met."""


class _Linear(NamedTuple):
    """Residuals near a point."""

    point: Vector
    residual: Vector
    matrix: Vector


@dataclass
class _Search:
    """Runs at points of a unit cube, which stands for the ranges of what is varied."""

    task: Task
    varied: Sequence[Varied]
    targets: Sequence[Target]
    curves: Sequence[Curve]
    accuracy: float
    most_runs: int
    executor: Executor | None
    watch: Callable[[int, float], None]
    start: Vector
    runs: int = 0
    known: dict[tuple[float, ...], tuple[Sample, Vector]] = field(default_factory=dict)
    linear: _Linear | None = None
    known_slopes: dict[tuple[float, ...], Vector] = field(default_factory=dict)

    @property
    def cost_of_slopes(self) -> int:
        """In runs, of one set of derivatives."""
        return len(self.varied)

    def settings(self, point: Vector) -> Settings:
        """The settings that a point means."""
        found: Settings = {}
        for one, share in zip(self.varied, point.tolist(), strict=True):
            found |= one.settings(self.task.scene.tree, _value(one, share))
        return found

    def at(self, points: Sequence[Vector]) -> list[tuple[Sample, Vector]]:
        """Samples and residuals at points, run where they are not known."""
        new = [
            p for p in {tuple(p.tolist()): p for p in points}.values() if tuple(p.tolist()) not in self.known
        ]
        jobs = [(self.runs + k, self.settings(point)) for k, point in enumerate(new)]
        for point, sample in zip(new, self._run(jobs), strict=True):
            self.runs += 1
            self.known[tuple(point.tolist())] = sample, self._residual(sample)
            self.watch(self.runs, self.best[1])
        return [self.known[tuple(p.tolist())] for p in points]

    def _run(self, jobs: Sequence[tuple[int, Settings]]) -> list[Sample]:
        if self.executor is None:
            return [run_sample(self.task, *job) for job in jobs]
        try:
            futures = [self.executor.submit(run_sample, self.task, *job) for job in jobs]
            return [future.result() for future in futures]
        except BrokenExecutor:
            raise StudyError("a process of the search died; the system may have run out of memory") from None

    def _residual(self, sample: Sample) -> Vector:
        if sample.message:  # as far off as nothing: the search goes back
            return np.ones(len(self.targets) + sum(len(one.times) for one in self.curves))
        parts = [np.array([one.off(sample) for one in self.targets])]
        parts += [one.off(sample) for one in self.curves]
        return np.concatenate(parts)

    def named(self, point: Vector) -> str:
        """The settings of a point in words."""
        return ", ".join(f"{key} = {value}" for key, value in self.settings(point).items())

    @property
    def best(self) -> tuple[Vector, float]:
        """The point of the smallest residual up to now, and its size."""
        point = min(self.known, key=lambda p: float(np.linalg.norm(self.known[p][1])))
        return np.array(point), self.size(self.known[point][1])

    def size(self, residual: Vector) -> float:
        """The largest relative difference: of numbers, and of curves as a whole."""
        parts, first = [float(abs(one)) for one in residual[: len(self.targets)]], len(self.targets)
        for curve in self.curves:
            parts.append(float(np.linalg.norm(residual[first : first + len(curve.times)])))
            first += len(curve.times)
        return max(parts)

    def residual(self, point: Vector) -> Vector:
        """For SciPy; ends the search where all is met, or where no run is left beside derivatives at its end."""
        found = self.at([np.clip(point, 0.0, 1.0)])[0][1]
        if self.size(found) <= self.accuracy or self.runs + self.cost_of_slopes >= self.most_runs:
            raise _ReachedError
        return np.concatenate((found, self._tie * (point - self.start)))

    @property
    def _tie(self) -> float:
        """What leaving the start weighs beside targets, so that a search goes nowhere for nothing."""
        return _TIE * self.accuracy

    def jacobian(self, point: Vector) -> Vector:
        """For SciPy: slopes of residuals; the last ones, brought up to date by Broyden, where they led well.

        Ends the search where none are left beside a run, and derivatives at the end.
        """
        here = np.clip(point, 0.0, 1.0)
        residual = self.at([here])[0][1]
        known, self.linear = self.linear, None
        if known is not None:
            way, change = here - known.point, residual - known.residual
            if np.linalg.norm(residual) < _WELL * np.linalg.norm(known.residual):
                matrix = known.matrix + np.outer(change - known.matrix @ way, way) / (way @ way)
                self.linear = _Linear(here, residual, matrix)
        if self.linear is None:
            if self.runs + 2 * self.cost_of_slopes >= self.most_runs:
                raise _ReachedError
            self.linear = _Linear(here, residual, self.slopes(here))
        return np.vstack((self.linear.matrix, self._tie * np.eye(len(here))))

    def slopes(self, point: Vector) -> Vector:
        """Derivatives of residuals (rows) by the shares of the ranges (columns).

        What moves no target by the accuracy over its range gets zeros: what stands there is rounding.
        """
        key = tuple(point.tolist())
        if key not in self.known_slopes:
            found = self._differences(point)
            found[:, np.linalg.norm(found, axis=0) < self.accuracy] = 0.0
            self.known_slopes[key] = found
        return self.known_slopes[key]

    def _differences(self, point: Vector) -> Vector:
        """Of runs whose values lie a little further into the ranges."""
        ends = [point + step * one for one, step in zip(np.eye(len(point)), _steps(point), strict=True)]
        found = self.at([point, *ends])
        for end, (sample, _) in zip((point, *ends), found, strict=True):
            if sample.message:
                raise StudyError(f"a run of the search failed, with {self.named(end)}: {sample.message}")
        here, *others = (off for _, off in found)
        return np.column_stack(
            [(other - here) / step for other, step in zip(others, _steps(point), strict=True)]
        )


def _steps(point: Vector) -> list[float]:
    return [_STEP if share + _STEP <= 1.0 else -_STEP for share in point.tolist()]


def _value(one: Varied, share: float) -> float:
    low, high = one.distribution.low, one.distribution.high
    return low + share * (high - low)


def tune(
    task: Task,
    varied: Sequence[Varied],
    targets: Sequence[Target],
    curves: Sequence[Curve],
    workers: int = 1,
    accuracy: float = _ACCURACY,
    most_runs: int = 100,
    watch: Callable[[int, float], None] = lambda runs, residual: None,
) -> Tuned:
    """Search for the values; StudyError where it cannot begin, or where a run fails.

    It begins with what the scene has, where that is within the range, else in its middle. accuracy: relative, of all
    targets. watch: takes how many runs were made, and the smallest residual among them.
    """
    _refuse(varied, targets, curves, workers)
    _refuse_late(curves, task.until)
    lines = task.scene.check_one_run().hinge_lines if curves else ()
    curves = of_sensors(curves, {line.name: line.sensor for line in lines})
    patterns = tuple(dict.fromkeys(curve.pattern for curve in curves))
    task = replace(task, signals=patterns, times=curves[0].times if curves else ())
    start = np.array([_start(task, one) for one in varied])
    with nullcontext(None) if workers == 1 else local(workers) as executor:
        search = _Search(task, varied, targets, curves, accuracy, most_runs, executor, watch, start)
        # the run at the start tells of numbers that there are not, before a residual is asked for
        first = run_sample(task, 0, search.settings(start))
        if first.message:
            raise StudyError(f"the run that the search starts from failed: {first.message}")
        refuse_unknown(targets, curves, first, task)
        search.known[tuple(start.tolist())] = first, search._residual(first)
        search.runs = 1
        if most_runs < 1 + search.cost_of_slopes:
            raise StudyError(
                f"{most_runs} runs are too few: the first and its derivatives cost {1 + search.cost_of_slopes}; let "
                "the search make more, or vary less"
            )
        with suppress(_ReachedError):
            # "trf" shortens steps of ill-conditioned targets, though their ends are far: twice the runs of AMOS-3
            scipy.optimize.least_squares(
                search.residual,
                start,
                search.jacobian,
                bounds=(0.0, 1.0),
                method="dogbox",
                x_scale=1.0,
                xtol=1e-10,
            )
        return _told(search, start)


def _told(search: _Search, start: Vector) -> Tuned:
    best, residual = search.best
    sample, began = search.known[tuple(best.tolist())][0], search.known[tuple(start.tolist())][0]
    numbers = tuple(
        Reached(one.number, unit, began.numbers[one.number][0], found, one.value(unit))
        for one in search.targets
        for found, unit, _ in [
            sample.numbers.get(one.number, (float("nan"), began.numbers[one.number][1], None))
        ]
    )
    wide = np.array([one.distribution.high - one.distribution.low for one in search.varied])
    moved = search.slopes(best)
    scale = np.array([abs(one.wanted) or 1.0 for one in numbers])
    rows = moved[: len(numbers)] * scale[:, None] / wide
    return Tuned(
        scene=search.task.scene.name,
        values={
            one.name: _value(one, share) for one, share in zip(search.varied, best.tolist(), strict=True)
        },
        start={
            one.name: _value(one, share) for one, share in zip(search.varied, start.tolist(), strict=True)
        },
        units={one.name: one.distribution.unit for one in search.varied},
        settings=search.settings(best),
        numbers=numbers,
        residual=residual,
        start_residual=search.size(search.known[tuple(start.tolist())][1]),
        derivatives=rows,
        reached=residual <= search.accuracy,
        at_ends=() if residual <= search.accuracy else _at_ends(search.varied, best),
        blind=_blind(search.varied, moved, search.accuracy),
        jumps=() if residual <= search.accuracy else _jumps(search, best, moved),
        runs=search.runs,
    )


def _at_ends(varied: Sequence[Varied], point: Vector) -> tuple[str, ...]:
    """What a point has at an end of its range, by name."""
    shares = zip(varied, point.tolist(), strict=True)
    return tuple(one.name for one, share in shares if min(share, 1.0 - share) < _AT_END)


def _jumps(search: _Search, best: Vector, moved: Vector) -> tuple[str, ...]:
    """Sentences of numbers that differ, between the best run and one with nearly its values, by no derivative."""
    count, sentences = len(search.targets), {}
    here, residual = search.known[tuple(best.tolist())]
    for point, (sample, other) in search.known.items():
        way = np.array(point) - best
        if sample.message or not 0.0 < np.abs(way).max() <= _NEAR:
            continue
        change = np.abs(other - residual)[:count]
        expected = _JUMP * np.abs(moved[:count]) @ np.abs(way) + _JUMP * search.accuracy * np.abs(way).max()
        for k in np.flatnonzero((change > expected) & (change > 10.0 * search.accuracy)).tolist():
            name = search.targets[k].number
            values = [one.numbers[name][0] for one in (here, sample) if name in one.numbers]
            if len(values) == 2:
                sentences[name] = (
                    f"{name} jumps from {values[0]:.6g} to {values[1]:.6g} {here.numbers[name][1]} between "
                    f"{search.named(best)} and {search.named(np.array(point))}, for example because a line latches one "
                    "swing earlier or later. Targets between these values cannot be met."
                )
    return tuple(sentences.values())


def _blind(varied: Sequence[Varied], moved: Vector, accuracy: float) -> tuple[str, ...]:
    """What is varied that has most part in combinations that move no target by the accuracy over the range."""
    _, sizes, directions = np.linalg.svd(moved)
    sizes = np.concatenate([sizes, np.zeros(len(varied) - len(sizes))])
    idle = directions[sizes <= max(_BLIND * sizes[0], accuracy)]
    return tuple(
        one.name
        for one, part in zip(varied, np.abs(idle).max(axis=0, initial=0.0), strict=True)
        if part > 0.5
    )


def _refuse(
    varied: Sequence[Varied], targets: Sequence[Target], curves: Sequence[Curve], workers: int
) -> None:
    if not varied:
        raise StudyError("nothing is varied; give keys and their ranges, such as KEY=uniform(LOW, HIGH)")
    if not targets and not curves:
        raise StudyError("there is no target; give one, such as latch_time.HL1=11.6, or a measured curve")
    if workers < 1:
        raise StudyError(f"{workers} workers do no work; give one at least")
    for one in varied:
        if not one.distribution.text.strip().startswith("uniform"):
            raise StudyError(f"{one.text!r}: a search needs a range; write {one.name}=uniform(LOW, HIGH)")
    keys = [key for one in varied for key in one.keys]
    if twice := sorted({key for key in keys if keys.count(key) > 1}):
        raise StudyError(f"{', '.join(twice)}: varied twice; a key gets one value")


def _refuse_late(curves: Sequence[Curve], until: float) -> None:
    for curve in curves:
        if curve.times[-1] > _BEYOND_END * until:
            raise StudyError(
                f"curve {curve.signal}: it goes to {curve.times[-1]:g} s, and runs end at {until:g} s; let them run "
                "longer, or leave later rows out"
            )


def _start(task: Task, one: Varied) -> float:
    """Share of the range where the search begins."""
    low, high = one.distribution.low, one.distribution.high
    own = 1.0 if one.factor else _own(value_at(task.scene.tree, one.keys[0]), one.distribution.unit)
    return (own - low) / (high - low) if own is not None and low < own < high else 0.5


def _own(value: object, unit: str) -> float | None:
    """A value of a scene in a unit; None where it is none, or cannot be told."""
    found = own_value(value)
    if found is None:
        return None
    number, own = found
    factors = next((one for one in UNITS.values() if (own or unit) in one), {})
    if own == unit or not factors:
        return number if own == unit else None
    return number * factors.get(own, 1.0) / factors.get(unit, 1.0) if own or unit in factors else None
