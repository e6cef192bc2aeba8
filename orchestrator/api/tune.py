"""Tuning from Python: values of a scene's keys that bring it where it is wanted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..analysis.sampling.sample import Task
from ..analysis.sampling.targets import Target, curves, target
from ..analysis.sampling.tuning import Tuned
from ..analysis.sampling.tuning import tune as _tune
from ..analysis.sampling.varied import varied
from ..scene.builder import Names
from .quantities import Quantity
from .simulate import SceneLike, as_scene, options_of


def tune(
    scene: SceneLike,
    vary: Mapping[str, str] | Sequence[str],
    targets: Mapping[str, float | str] | Sequence[str] = (),
    *,
    curve: str | Path | None = None,
    accuracy: float = 1e-4,
    most_runs: int = 100,
    workers: int = 1,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Quantity | None = None,
    tolerance: float | None = None,
    watch: Callable[[int, float], None] = lambda runs, residual: None,
) -> Tuned:
    """Find values within ranges that bring headline numbers, and measured curves, where they are wanted.

    vary: ranges by key, such as {"hinge_line.HL1.motor.stowed": "uniform(1.2 N.m, 2 N.m)"}; a key that ends in * is
    multiplied, keys with commas between get the same. targets: by identifier, such as {"latch_time.HL1": "11.6 s"}
    or {"latch_rate.HL2": "2 deg/s"}, in the unit that headline numbers are told in. curve: a CSV file, times (s) in the
    first column, others headed COMPONENT.VARIABLE, with [1] for the first of several. Bounded least squares from the
    scene's own values, with derivatives as `gradients` has them or by differences of runs. accuracy:
    largest relative difference to end with. most_runs: what it may cost, derivatives included; the best so far is
    returned then, with `reached` False. workers: processes. watch: takes how many runs were made and the smallest
    residual. rigid ... tolerance: as for `simulate`; let it be well below the accuracy.

    StudyError or SceneError where it cannot begin.
    """
    texts = [f"{key}={text}" for key, text in vary.items()] if isinstance(vary, Mapping) else list(vary)
    wanted = (
        [_wanted(name, value) for name, value in targets.items()]
        if isinstance(targets, Mapping)
        else list(map(target, targets))
    )
    options = options_of(rigid, flexible, large_deformation, until, tolerance)
    measured = () if curve is None else curves(Path(curve))
    task = Task(as_scene(scene), options)
    return _tune(
        task, [varied(text) for text in texts], wanted, measured, workers, accuracy, most_runs, watch
    )


def _wanted(name: str, value: float | str) -> Target:
    return Target(target(f"{name}=0").number, value)
