"""A result as a series of VTU files with a PVD file that opens them, for ParaView and others that read VTK's formats.

wing.pvd            times (s) and files
wing/bodies.csv     numbers of bodies and their names
wing/wing_0000.vtu  points (m) where they are; displacement and deformation (m), von_mises (Pa), body
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

import numpy as np

from components import FanfoldError
from components.contract.component import Vector

from ...results.result import Result, ResultError, reason
from ..placement import rows_near
from .motion import Rows, motion
from .output import library, whole
from .stressed import Stressed, stressed
from .surface import shown_bodies, surface

FRAMES = 60
"""Files that nobody asked for another number of."""
_MOST = 10_000
_BODIES = "bodies.csv"


@dataclass(frozen=True)
class _Piece:
    """A body at the rows (n,) of the series: nodes (n, D, 3) m, what is known of them, and the numbers of its cells."""

    nodes: Vector
    displacement: Vector
    deformation: Vector
    von_mises: Vector
    triangles: Rows
    lines: Rows


def write_series(
    path: Path,
    result: Result,
    frames: int | None = None,
    times: Sequence[float] | None = None,
    stress: bool = True,
) -> list[str]:
    """Write frames at equal steps in time, or at the recorded rows nearest to some times (s); sentences on what lacks.

    stress: recover stresses of bodies whose modal coordinates and face sheets are known.
    """
    mesh = library("meshio", "a series of VTU files")
    bodies = shown_bodies(result)
    rows = _rows(result, frames, times)
    remarks: list[str] = []
    pieces = []
    for name, body in bodies.items():
        found: Stressed | None = None
        if stress and result.has(name, "modal_coordinate"):
            try:
                found = stressed(result, name, rows)
                remarks += found.remarks
            except FanfoldError as error:
                remarks.append(f"{error}; {path.name} shows no stress of it")
        geometry = body if found is None else found.geometry
        pieces.append(_piece(result, name, geometry, rows, None if found is None else found.von_mises))
    folder = path.with_suffix("")
    try:
        with TemporaryDirectory(dir=path.parent, prefix=f".{folder.name}.") as place:
            made = Path(place, folder.name)
            made.mkdir()
            _write_names(made / _BODIES, list(bodies))
            files = [made / f"{folder.name}_{k:04d}.vtu" for k in range(rows.size)]
            for k, file in enumerate(files):
                mesh.write(file, _mesh(mesh, pieces, k), binary=True)
            folder.mkdir(exist_ok=True)  # others, such as pictures, may be in it
            for old in _series_files(folder):
                old.unlink()
            for file in made.iterdir():
                file.rename(folder / file.name)
    except OSError as error:
        raise ResultError(f"{folder}: the files of the series cannot be written ({reason(error)})") from None
    _write_list(path, [f"{folder.name}/{file.name}" for file in files], result.time[rows])
    return remarks


def refuse_folder(path: Path, replace_it: bool) -> None:
    """ResultError where the folder of a series holds one already, or is none."""
    folder = path.with_suffix("")
    try:
        if not folder.exists() and not folder.is_symlink():
            return
        if folder.is_symlink() or not folder.is_dir():
            raise ResultError(
                f"{folder}: the files of the series go into a folder of this name, which this is not"
            )
        old = _series_files(folder)
    except OSError as error:
        raise ResultError(f"{folder}: nothing can be written here ({reason(error)})") from None
    if old and not replace_it:
        raise ResultError(
            f"{folder}: this folder holds a series already; name another file, or allow it with --replace"
        )


def _series_files(folder: Path) -> list[Path]:
    """What a folder holds of a series that was written into it."""
    own = re.compile(rf"{re.escape(folder.name)}_\d+\.vtu|{re.escape(_BODIES)}")
    return [one for one in folder.iterdir() if own.fullmatch(one.name)]


def _rows(result: Result, frames: int | None, times: Sequence[float] | None) -> Rows:
    time = result.time
    if times is not None:
        if frames is not None:
            raise ResultError("give times or a number of frames, not both")
        outside = [one for one in times if not time[0] <= one <= time[-1]]
        if outside or not times:
            told = f"there is nothing at t = {outside[0]:g} s" if outside else "no times are given"
            raise ResultError(f"{result.name}: {told}; the result goes from {time[0]:g} to {time[-1]:g} s")
        return rows_near(time, sorted(times))
    count = FRAMES if frames is None else frames
    if not 1 <= count <= _MOST:
        raise ResultError(f"{count} frames are asked for; there can be 1 to {_MOST}")
    return rows_near(time, np.linspace(time[0], time[-1], count) if count > 1 else time[-1:])


def _piece(result: Result, name: str, body: Any, rows: Rows, von_mises: Vector | None) -> _Piece:  # noqa: ANN401
    moving = motion(result, name, body, np.concatenate([[0], rows]), 0.0)
    every = np.arange(rows.size + 1)
    where = moving.at(every)
    if moving.missed is None:
        deformation = where - replace(moving, amplitudes=np.zeros_like(moving.amplitudes)).at(every)
    else:
        deformation = np.full_like(where, np.nan)
    shape = surface(np.asarray(body.faces))
    stress = np.full(where[1:].shape[:2], np.nan) if von_mises is None else von_mises
    return _Piece(where[1:], where[1:] - where[0], deformation[1:], stress, shape.triangles, shape.lines)


def _mesh(mesh: Any, pieces: Sequence[_Piece], k: int) -> Any:  # noqa: ANN401
    """All bodies at the k-th row; no number stands for what is not known of a node."""
    starts = np.cumsum([0, *(piece.nodes.shape[1] for piece in pieces)])
    blocks, numbers = [], []
    for number, (piece, start) in enumerate(zip(pieces, starts, strict=False)):
        for kind, cells in (("triangle", piece.triangles), ("line", piece.lines)):
            if cells.size:
                blocks.append((kind, cells + start))
                numbers.append(np.full(len(cells), number))
    data = {
        "displacement": np.concatenate([piece.displacement[k] for piece in pieces]),
        "deformation": np.concatenate([piece.deformation[k] for piece in pieces]),
        "von_mises": np.concatenate([piece.von_mises[k] for piece in pieces]),
    }
    known = {name: values for name, values in data.items() if not np.all(np.isnan(values))}
    points = np.concatenate([piece.nodes[k] for piece in pieces])
    return mesh.Mesh(points, blocks, point_data=known, cell_data={"body": numbers})


def _write_names(path: Path, names: Sequence[str]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("body", "name"))
        rows.writerows(enumerate(names))


def _write_list(path: Path, files: Sequence[str], times: Vector) -> None:
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for file, time in zip(files, times.tolist(), strict=True):
        ElementTree.SubElement(collection, "DataSet", timestep=repr(time), part="0", file=file)
    ElementTree.indent(root)
    with whole(path) as part:
        part.write_bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))
