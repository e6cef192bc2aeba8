"""Results as files of other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..results.result import ResultError
from .documents import ResultLike, opened
from .warnings import warn

if TYPE_CHECKING:
    from ..results.result import Result

_TABLES, _GLB, _VTU = ("csv", "mat"), ("glb",), ("vtu",)


def export_view(
    result: ResultLike,
    path: str | Path,
    format: str | None = None,
    *,
    signals: Sequence[str] | str = (),
    every: float | None = None,
    replace: bool = False,
) -> list[Path]:
    """Write a result as a file that other programs read, and return the paths written.

    format: "csv" or "mat" (.mat of MATLAB); by default what the ending of the path says. signals: patterns of
    COMPONENT or COMPONENT.VARIABLE as of file names, by default all; every: s from row to row, linear between recorded
    ones, by default these. replace: a file that is there already. ResultError where the result does not hold what is
    to be shown, or the file cannot be written.
    """
    from ..views.viewers.output import format_of, refuse_to_lose

    found, target = opened(result), Path(path)
    kind = format_of(target, format)
    patterns = (signals,) if isinstance(signals, str) else tuple(signals)
    _refuse_idle(kind, _TABLES, signals=patterns or None, every=every)
    refuse_to_lose(found, target, replace)
    if not found.complete:
        warn(
            f"{found.name}: the run was interrupted at {found.time[-1]:.6g} s; nothing after that is exported"
        )
    return _tables(found, target, kind, patterns, every)


def _refuse_idle(kind: str, formats: tuple[str, ...], **options: object) -> None:
    """ResultError where an option is given that means nothing in a format."""
    given = [name for name, value in options.items() if value is not None]
    if given and kind not in formats:
        raise ResultError(
            f"{' and '.join(given)} mean nothing in the format {kind}, only in {' and '.join(formats)}"
        )


def _tables(
    found: Result, path: Path, kind: str, patterns: tuple[str, ...], every: float | None
) -> list[Path]:
    from ..views.viewers.matlab import write_mat
    from ..views.viewers.signals import chosen
    from ..views.viewers.table import write_csv

    write = write_csv if kind == "csv" else write_mat
    write(path, chosen(found, patterns, every))
    return [path]
