"""Results as files of other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..messages import message
from ..results.result import ResultError
from .documents import ResultLike, opened
from .warnings import warn

if TYPE_CHECKING:
    from ..results.result import Result

_TABLES, _ANIMATION, _SERIES = ("csv", "mat"), ("glb",), ("vtu",)


def export_view(
    result: ResultLike,
    path: str | Path,
    format: str | None = None,
    *,
    signals: Sequence[str] | str = (),
    every: float | None = None,
    frames: int | None = None,
    times: Sequence[float] | None = None,
    stress: bool | None = None,
    tolerance: float | None = None,
    replace: bool = False,
) -> list[Path]:
    """Write a result as a file that other programs read, and return the paths to open.

    format: "glb" (animated bodies, glTF 2.0), "vtu" (.pvd, a series for ParaView), "csv" or "mat" (MATLAB); by default
    what the ending of the path says. csv and mat: signals, patterns of COMPONENT or COMPONENT.VARIABLE as of file
    names, by default all; every, s from row to row, linear between recorded ones, by default these. vtu: frames, at
    equal steps in time, by default 60, or times (s), at the recorded rows nearest to them; stress, False leaves out
    von Mises stress. glb: tolerance, m that no node is off by between the keys of the animation, by default 1e-4 of
    the structure's size. replace: what is there already. ResultError where the result does not hold what is to be
    shown, or nothing can be written; a FanfoldWarning tells what is not shown.
    """
    from ..views.viewers.output import format_of, refuse_to_lose

    found, target = opened(result), Path(path)
    kind = format_of(target, format)
    patterns = (signals,) if isinstance(signals, str) else tuple(signals)
    _refuse_idle(kind, _TABLES, signals=patterns or None, every=every)
    _refuse_idle(kind, _SERIES, frames=frames, times=times, stress=stress)
    _refuse_idle(kind, _ANIMATION, tolerance=tolerance)
    refuse_to_lose(found, target, replace)
    if not found.complete:
        warn(
            message(
                "W-incomplete",
                f"{found.name}: the run was interrupted at {found.time[-1]:.6g} s; nothing after that is exported",
            )
        )
    if kind == "glb":
        from ..views.viewers.gltf import write_glb

        write_glb(target, found, tolerance)
    elif kind == "vtu":
        _series(found, target, frames, times, stress is not False, replace)
    else:
        _tables(found, target, kind, patterns, every)
    return [target]


def _refuse_idle(kind: str, formats: tuple[str, ...], **options: object) -> None:
    """ResultError where an option is given that means nothing in a format."""
    given = [name for name, value in options.items() if value is not None]
    if given and kind not in formats:
        raise ResultError(
            f"{' and '.join(given)} cannot be chosen in the format {kind}, only in {' and '.join(formats)}"
        )


def _series(
    found: Result, path: Path, frames: int | None, times: Sequence[float] | None, stress: bool, replace: bool
) -> None:
    from ..views.viewers.series import refuse_folder, write_series

    refuse_folder(path, replace)
    for remark in write_series(path, found, frames, times, stress):
        warn(message("W-stress", remark))


def _tables(found: Result, path: Path, kind: str, patterns: tuple[str, ...], every: float | None) -> None:
    from ..views.viewers.matlab import write_mat
    from ..views.viewers.signals import chosen
    from ..views.viewers.table import write_csv

    write = write_csv if kind == "csv" else write_mat
    write(path, chosen(found, patterns, every))
