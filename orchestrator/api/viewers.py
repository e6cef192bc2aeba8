"""Results as files of other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from ..messages import message
from ..results.result import ResultError
from ..scene.builder import Names, listed
from .documents import ResultLike, opened
from .options import OutputFile, Positive, Within
from .quantities import Duration, in_si
from .warnings import warn

if TYPE_CHECKING:
    from ..results.result import Result

Format = Literal["glb", "vtu", "csv", "mat"]
_TABLES, _ANIMATION, _SERIES = ("csv", "mat"), ("glb",), ("vtu",)


def export_view(
    result: ResultLike,
    path: OutputFile,
    format: Format | None = None,
    *,
    signals: Names = (),
    every: Duration | None = None,
    frames: Positive | None = None,
    times: Sequence[float] | None = None,
    stress: bool | None = None,
    tolerance: Annotated[float, Within("m", 0.0, above=True)] | None = None,
    replace: bool = False,
) -> list[Path]:
    """Export a result for other programs.

    Parameters
    ----------
    result : Result, str or Path
        result, or its file
    path : str or Path
        file to write: .glb, .pvd, .csv or .mat
    format : {"glb", "vtu", "csv", "mat"}, optional
        animated bodies (glTF 2.0), series for ParaView (.pvd), table, MATLAB; by default from the suffix of `path`
    signals : str or sequence of str
        csv, mat: patterns of COMPONENT or COMPONENT.VARIABLE, such as "hl1_*"; by default all signals
    every : float, optional
        csv, mat: time between rows, in seconds, interpolated linearly; by default the recorded rows
    frames : int, optional
        vtu: number of equally spaced times; by default 60
    times : sequence of float, optional
        vtu: times, in seconds; the nearest recorded rows are used
    stress : bool, optional
        vtu: False omits von Mises stress
    tolerance : float, optional
        glb: largest position error between the keys of the animation, m; by default 1e-4 of the structure's size
    replace : bool
        replace existing files

    Returns
    -------
    list of Path
        files to open

    Raises
    ------
    ResultError
        if the result lacks the data, or the file cannot be written
    """
    from ..views.viewers.output import format_of, refuse_to_lose

    found, target = opened(result), Path(path)
    kind = format_of(target, format)
    patterns, spacing = listed(signals), in_si(every, "s", "every", "positive")
    _refuse_idle(kind, _TABLES, signals=patterns or None, every=spacing)
    _refuse_idle(kind, _SERIES, frames=frames, times=times, stress=stress)
    _refuse_idle(kind, _ANIMATION, tolerance=tolerance)
    refuse_to_lose(found, target, replace)
    if not found.complete:
        warn(
            message(
                "W-incomplete",
                f"{found.name}: the run was interrupted at {found.time[-1]:.6g} s, and the export ends there. "
                "Resume the run to export all of it.",
            )
        )
    if kind == "glb":
        from ..views.viewers.gltf import write_glb

        write_glb(target, found, tolerance)
    elif kind == "vtu":
        _series(found, target, frames, times, stress is not False, replace)
    else:
        _tables(found, target, kind, patterns, spacing)
    return [target]


def _refuse_idle(kind: str, formats: tuple[str, ...], **options: object) -> None:
    """ResultError for an option that has no effect in the format."""
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
