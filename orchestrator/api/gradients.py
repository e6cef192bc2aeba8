"""Gradients from Python: what the keys of a scene do to its headline numbers."""

from __future__ import annotations

from collections.abc import Sequence

from ..analysis.sampling.gradients import Gradients
from ..analysis.sampling.gradients import gradients as _gradients
from ..run.progress import Progress, followed
from ..scene.builder import Names
from .progress import chosen
from .quantities import Quantity
from .simulate import SceneLike, as_scene, options_of


def gradients(
    scene: SceneLike,
    keys: str | Sequence[str],
    *,
    central: bool = False,
    verify: bool = True,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Quantity | None = None,
    tolerance: float | None = None,
    progress: bool | Progress | None = None,
) -> Gradients:
    """Derivatives of latch times, peaks, interface loads and all other headline numbers by keys of a scene.

    keys: such as ["hinge_line.HL1.motor.stowed", "friction.coefficient"]; a key that ends in * is differentiated by a
    factor of what it has, keys with commas between change together. One run tells them all, through its latch-ups and
    other events: for every key a neighbour with a slightly different value makes the same steps beside it. central: two
    neighbours a key, for loads that bend much with it; twice the cost. verify: `errors` hold those of the steps as
    well, by a run at a tenth of the tolerance with its neighbours, for twice the cost again; without it they know
    nothing of those, by which loads may be far off, even in sign. rigid ... progress: as for `simulate`.

    `derivatives` (numbers, keys) are in the unit of the number over that of the key; `relative` is percent by percent.
    `errors` (numbers) tell how far the gradient of each can be trusted, `single_errors` (numbers, keys) how far every
    derivative, also where it is small beside others; `doubtful` names those that mean nothing.
    FanfoldError where there is no derivative: for whole numbers, and where a small change makes another event happen.
    """
    options = options_of(rigid, flexible, large_deformation, until, tolerance)
    loaded = as_scene(scene)
    end = options.until or loaded.check().header.until
    wanted = [keys] if isinstance(keys, str) else list(keys)
    with followed(chosen(progress), loaded.name, end) as watch:
        return _gradients(loaded, options, wanted, central=central, verify=verify, watch=watch)
