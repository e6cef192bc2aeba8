"""Gradients from Python: derivatives of headline numbers with respect to keys of a scene."""

from __future__ import annotations

from collections.abc import Sequence

from ..analysis.sampling.gradients import Gradients
from ..analysis.sampling.gradients import gradients as _gradients
from ..run.progress import Progress, followed
from ..scene.builder import Names
from .progress import chosen
from .quantities import Duration, Tolerance
from .simulate import SceneLike, as_scene, options_of


def gradients(
    scene: SceneLike,
    keys: str | Sequence[str],
    *,
    verify: bool = True,
    rigid: Names = (),
    flexible: Names = (),
    large_deformation: Names = (),
    until: Duration | None = None,
    tolerance: Tolerance | None = None,
    progress: bool | Progress | None = None,
) -> Gradients:
    """Derivatives of all headline numbers with respect to keys of a scene, through latch-ups and other events.

    The run is replayed on the same steps with slightly different values, one run a key.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    keys : str or sequence of str
        such as ``["hinge_line.HL1.motor.stowed", "friction.coefficient"]``; a key that ends in ``*`` is a factor; keys
        separated by commas change together
    verify : bool
        repeat all at a tenth of the tolerance, for two to three times the cost: derivatives are those of the smaller
        tolerance, and `errors` their differences from the others; without it errors are unknown, and loads may be
        wrong, even in sign
    rigid, flexible, large_deformation, until, tolerance, progress
        see `simulate`

    Returns
    -------
    Gradients
        `derivatives` (numbers, keys) in the unit of the number over that of the key; `relative` in percent per percent;
        `errors` (numbers) relative to the gradient, `single_errors` (numbers, keys) of single derivatives;
        `unreliable` lists numbers without a meaningful gradient

    Raises
    ------
    FanfoldError
        for integer keys, and if a small change makes another event happen
    """
    options = options_of(locals())
    loaded = as_scene(scene)
    end = options.until or loaded.check().header.until
    wanted = [keys] if isinstance(keys, str) else list(keys)
    with followed(chosen(progress), loaded.name, end) as watch:
        return _gradients(loaded, options, wanted, verify=verify, watch=watch)
