"""Two results side by side, and reports."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from ..messages import message
from ..results import compare as comparing
from ..results.compare import Comparison
from ..results.differences import scene_note
from ..results.result import Result as Record
from ..results.result import ResultError, reason
from .result import Result
from .warnings import warn

ResultLike = Record | str | Path
"""A result, or the file of one."""


def compare(a: ResultLike, b: ResultLike) -> Comparison:
    """Two results side by side: latch-up and peaks of loads in `rows`, with ratios and shifts in time (s).

    A FanfoldWarning tells where they are of different scenes.
    """
    first, second = opened(a), opened(b)
    if note := scene_note(first, second):
        warn(message("W-different-scenes", note))
    return comparing.compare(first, second)


def plot_comparison(a: ResultLike, b: ResultLike, folder: str | Path) -> list[Path]:
    """Write overlays of two results, a drawn through and b dashed, into a folder; the paths written."""
    from ..views import comparison

    return comparison.plot_comparison(opened(a), opened(b), Path(folder))


def report(
    result: ResultLike,
    path: str | Path | None = None,
    other: ResultLike | Sequence[ResultLike] | None = None,
    frames: int = 6,
) -> Path:
    """Write a result as one self-contained HTML file and return its path.

    path: by default beside the file of the result. other: one or several results to set against it; the first of
    them is in space and in the interactive plots as well. frames: still pictures for browsers without WebGL2, 0 for
    nothing that plays either. ResultError where the file cannot be an HTML file, or is one of the results.
    """
    from ..views.report.report import report as html

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
    text = html(first, others, frames).encode(errors="replace").decode()  # names of files may be no text
    part = target.with_name(f"{target.name}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(target)
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise ResultError(f"{target}: the report cannot be written ({reason(error)})") from None
    return target


def _listed(other: ResultLike | Sequence[ResultLike] | None) -> Sequence[ResultLike]:
    if other is None:
        return ()
    return (other,) if isinstance(other, Record | str | Path) else other


def opened(result: ResultLike) -> Result:
    """A result, read where a file is named."""
    if isinstance(result, Result):
        return result
    if not isinstance(result, Record | str | Path):
        raise ResultError(f"{result!r} is no result; give one, or the name of its file")
    return Result.of(result) if isinstance(result, Record) else Result.open(result)
