"""Comparison of results, and reports."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Annotated

from ..messages import message
from ..results import compare as comparing
from ..results.compare import Comparison
from ..results.differences import scene_note
from ..results.result import Result as Record
from ..results.result import ResultError, reason
from ..run.progress import Progress
from ..scene.builder import Names
from .options import OutputFile, Within
from .quantities import Duration, Tolerance
from .report_page import page_of
from .result import Result
from .simulate import SceneLike, as_scene, simulate
from .warnings import warn

ResultLike = Record | str | Path
"""A result, or the file of one."""


def compare(a: ResultLike, b: ResultLike) -> Comparison:
    """Compare two results: latch-up and load peaks, with ratios and time shifts.

    Parameters
    ----------
    a, b : Result, str or Path
        results, or their files; a FanfoldWarning if their scenes differ

    Returns
    -------
    Comparison
        `rows` with both values, ratio and time shift (s)
    """
    first, second = opened(a), opened(b)
    if note := scene_note(first, second):
        warn(message("W-different-scenes", note))
    return comparing.compare(first, second)


def plot_comparison(a: ResultLike, b: ResultLike, folder: str | Path) -> list[Path]:
    """Plot the signals of two results over each other, a solid and b dashed.

    Parameters
    ----------
    a, b : Result, str or Path
        results, or their files
    folder : str or Path
        folder of the pictures

    Returns
    -------
    list of Path
        pictures
    """
    from ..views import comparison

    return comparison.plot_comparison(opened(a), opened(b), Path(folder))


def report(
    result: ResultLike,
    path: OutputFile | None = None,
    other: ResultLike | Sequence[ResultLike] | None = None,
    frames: Annotated[int, Within(low=0, high=300)] = 6,
    require: str | Sequence[str] = (),
    author: str = "",
    live: bool = False,
    slider: str | Sequence[str] = (),
) -> Path:
    """Write a report of a result as one self-contained HTML file.

    A live one contains the wing in WebAssembly: its sliders change the scene, and the wing deploys anew in the browser.

    Parameters
    ----------
    result : Result, str or Path
        result, or its file
    path : str or Path, optional
        HTML file; by default next to the file of the result
    other : result or sequence of results, optional
        results to compare with; the first one is also drawn in the 3-D view and in the interactive plots
    frames : int
        number of still pictures for browsers without WebGL2

    require : str or sequence of str
        requirements in addition to those of the result, such as "latch_rate.HL1 < 15 deg/s"
    author : str
        author in the title block; by default the user name of git
    live : bool
        add the wing as one FMU with sliders, in place of results to compare with in the view; needs the extra
        `platforms`
    slider : str or sequence of str
        keys of the scene and their ranges, such as "hinge_line.HL1.motor.stowed=1.2..2.4 N.m", or
        "friction.coefficient*=0.5..2" for factors; by default motors, friction, dampers and latches

    Returns
    -------
    Path
        HTML file

    Raises
    ------
    ResultError
        if the file is no HTML file, is one of the results, or cannot be written

    Examples
    --------
    >>> result = fanfold.simulate("amos3", rigid="all")
    >>> fanfold.report(result, "amos3.html")
    """
    first = opened(result)
    others = [opened(one) for one in _listed(other)]
    if path is None and first.path is None:
        raise ResultError(f"{first.name}: the result is in memory; name the file of the report")
    target = Path(path) if path is not None else Path(str(first.path)).with_suffix(".html")
    if target.suffix.lower() not in (".html", ".htm"):
        raise ResultError(f"{target}: the report is an HTML file; let its name end in .html")
    files = {one.path.resolve() for one in (first, *others) if one.path is not None}
    if target.resolve() in files:
        raise ResultError(f"{target}: this is the result itself and would be lost; name another file")
    text = page_of(first, others, frames, require, author, live, slider)
    part = target.with_name(f"{target.name}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(target)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise ResultError(f"{target}: the report cannot be written ({reason(error)})") from None
    return target


def live(
    scene: SceneLike,
    path: OutputFile | None = None,
    *,
    rigid: Names = (),
    flexible: Names = (),
    until: Duration | None = None,
    tolerance: Tolerance | None = None,
    slider: str | Sequence[str] = (),
    require: str | Sequence[str] = (),
    author: str = "",
    progress: bool | Progress | None = None,
) -> Path:
    """Simulate a scene and write a live report: sliders change the scene, and the wing deploys anew in the browser.

    The page contains everything and needs no network.

    Parameters
    ----------
    scene : str, Path or Scene
        scene, or its name or file
    path : str or Path, optional
        HTML file; by default SCENE.live.html
    rigid, flexible, until, tolerance, require, progress
        see `simulate`
    slider, author
        see `report`

    Returns
    -------
    Path
        HTML file

    Examples
    --------
    >>> fanfold.live("amos3", rigid="all", slider="friction.coefficient=0.05..0.2")
    """
    loaded = as_scene(scene)
    result = simulate(
        loaded,
        rigid=rigid,
        flexible=flexible,
        until=until,
        tolerance=tolerance,
        require=require,
        progress=progress,
    )
    target = path or f"{loaded.name}.live.html"
    return report(result, target, author=author, live=True, slider=slider)


def _listed(other: ResultLike | Sequence[ResultLike] | None) -> Sequence[ResultLike]:
    if other is None:
        return ()
    return (other,) if isinstance(other, Record | str | Path) else other


def opened(result: ResultLike) -> Result:
    """A result, read from its file if necessary."""
    if isinstance(result, Result):
        return result
    if not isinstance(result, Record | str | Path):
        raise ResultError(f"{result!r} is no result; give one, or the name of its file")
    return Result.of(result) if isinstance(result, Record) else Result.open(result)
