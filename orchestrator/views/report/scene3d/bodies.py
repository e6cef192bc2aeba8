"""Bodies of a result as a page moves them: nodes and forms once, poses and amplitudes at few times, stresses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import prod
from typing import Any, NamedTuple

import numpy as np

from components import FanfoldError
from components.contract.component import Vector
from components.flexible.stress import von_mises

from ....assembly import Geometry
from ....results.result import Result
from ...placement import placed
from ...viewers.motion import Motion, Rows, motion, scales_of
from ...viewers.stressed import Plate, plate
from ...viewers.surface import Indices, surface
from ...viewers.thinning import straight
from .numbers import STEP, Block, double, short, single, whole

_SHARE_OF_SIZE = 1e-4
_SHARE_OF_FORMS = 0.1
"""Of that, that all forms together may add that are left out."""
_SHARE_OF_PEAK = 5e-3
_LEFT_OUT = 1e-3
"""Of the peak, that all coordinates together may add that are left out."""
_SHOWN_PEAK = 95.0
"""Percentile of the nodes' peaks where colours end: the largest are at corners of inserts and depend on the mesh."""
_EVERY = 6
"""Rows from one to the next by which peaks are estimated, which are scales here and nothing else."""
_LARGEST = 2_400_000
"""Bytes of the stress rows of a page, a third more as text; bodies whose rows do not fit are shown without."""
_SINGLE = 4e-7
"""Of a coordinate: what several steps in single precision lose."""


@dataclass
class Room:
    """Bytes that are left for rows of stresses."""

    left: int = _LARGEST

    def takes(self, rows: Block) -> bool:
        """Whether there is room for rows, which is then theirs."""
        size = 2 * prod(rows["shape"])
        if size > self.left:
            return False
        self.left -= size
        return True


def extent(result: Result, bodies: dict[str, Geometry], rows: Rows) -> tuple[Vector, Vector]:
    """Lowest and highest coordinates (3,) in m, world axes, of all nodes at some rows of the run."""
    some = rows[:: max(1, rows.size // 40)]
    every = np.concatenate([placed(result, name, body, some).reshape(-1, 3) for name, body in bodies.items()])
    return every.min(axis=0), every.max(axis=0)


class ShownBody(NamedTuple):
    """A body for the page, and how far a node (m) and its von Mises stress (Pa) are off at the most at any row."""

    name: str
    data: dict[str, object]
    tolerance: float
    stress_tolerance: float


def moving_bodies(
    result: Result,
    bodies: dict[str, Geometry],
    rows: Rows,
    size: float,
    room: Room | None,
    remarks: list[str],
) -> list[ShownBody]:
    """Bodies for the page; rows (n,) rise in time; size (m): of all that is shown; remarks: gets what lacks.

    room: for stresses, None to show none.
    """
    found = []
    for name, body in bodies.items():
        stresses = None if room is None else _plate(result, name, body, remarks)
        stress = None if stresses is None else _stress(result.time, stresses, rows)
        if room is not None and stress is not None and not room.takes(stress["rows"]):
            remarks.append(f"Stress of {name} is not shown, because the page would be too large")
            stresses = stress = None
        found.append(_body(result, name, body, rows, _SHARE_OF_SIZE * size, stresses, stress))
    return found


def _plate(result: Result, name: str, body: Geometry, remarks: list[str]) -> Plate | None:
    """The plate of a body with stresses that are known."""
    if not body.faces.size or not result.has(name, "modal_coordinate"):
        return None
    try:
        found = plate(result, name)
    except FanfoldError as error:
        remarks.append(f"No stress is shown: {str(error).removeprefix(f'{result.name}: ')}")
        return None
    remarks += found.remarks
    return found


def _body(
    result: Result,
    name: str,
    body: Geometry,
    rows: Rows,
    tolerance: float,
    stresses: Plate | None,
    stress: dict[str, Any] | None,
) -> ShownBody:
    whole_motion = motion(result, name, body, rows, tolerance)
    used = _largest(_sizes(whole_motion), _SHARE_OF_FORMS * tolerance)
    moving = _with_forms(whole_motion, used)
    chosen = _keys(moving, (1.0 - _SHARE_OF_FORMS) * tolerance - (moving.missed or 0.0))
    shown = body if stresses is None else stresses.geometry
    # a finer mesh of the same modes takes the same amplitudes
    fine = moving.part(chosen)
    if stresses is not None:
        fine = _with_forms(motion(result, name, shown, rows, tolerance), used).part(chosen)
    shape = surface(np.asarray(shown.faces))
    data: dict[str, object] = {
        "name": name,
        "nodes": single(fine.nodes),
        "forms": short(fine.forms.reshape(fine.nodes.size, fine.forms.shape[2])),
        "triangles": whole(shape.triangles),
        "lines": whole(shape.lines),
        "outline": whole(_outline(shape.triangles)),
        "time": double(fine.time),
        "position": single(fine.position),
        "orientation": single(fine.orientation),
        "amplitudes": short(fine.amplitudes),
        "scales": fine.missed is None,
        "modes": used.tolist(),
        "mode_scales": _mode_scales(result, name, rows)[used].tolist() if fine.missed is None else [],
        "stress": stress,
    }
    off = tolerance + _rounding(fine)
    return ShownBody(name, data, off, 0.0 if stress is None else float(stress["tolerance"]))


def _keys(found: Motion, tolerance: float) -> Rows:
    """Rows between which no node is off by more than a tolerance (m), by straight lines, quaternions then made unit.

    A node is off by at most the errors of position, of rotation times its reach, and of each amplitude times its form.
    Matrices of rotation differ by at most twice what unit quaternions do, and these by twice what they did before.
    """
    sizes = _sizes(found)
    reach = np.linalg.norm(found.nodes, axis=1).max(initial=0.0) + sizes.sum()
    bounds = np.hstack([found.position, 4.0 * reach * found.orientation, found.amplitudes * sizes])
    return straight(found.time, bounds, tolerance)


def _sizes(found: Motion) -> Vector:
    """How far (m) each form (M,) moves any node at the most."""
    sizes: Vector = np.linalg.norm(found.forms, axis=1).max(axis=0, initial=0.0)
    return sizes


def _largest(sizes: Vector, left_out: float) -> Indices:
    """Places of all but the smallest sizes (M,), which together are no larger than what may be left out."""
    smallest = np.argsort(sizes)
    found: Indices = np.sort(smallest[np.cumsum(sizes[smallest]) > left_out])
    return found


def _with_forms(found: Motion, used: Indices) -> Motion:
    return replace(found, forms=found.forms[:, :, used], amplitudes=found.amplitudes[:, used])


def _mode_scales(result: Result, name: str, rows: Rows) -> Vector:
    """What amplitudes (M,) of modes are multiples of."""
    if not result.has(name, "modal_coordinate"):
        return np.zeros(0)
    return scales_of(result.signal(name, "modal_coordinate").reshape(result.time.size, -1)[rows])


def _rounding(found: Motion) -> float:
    """How far (m) a node may be off by the bits of its numbers: forms and amplitudes of 16, all else single."""
    forms = _sizes(found).sum()
    reach = np.abs(found.nodes).max(initial=0.0) + np.abs(found.position).max(initial=0.0)
    return float(2.0 * STEP * forms + _SINGLE * reach)


def _outline(triangles: Indices) -> Indices:
    """Edges (E, 2) of one triangle alone."""
    edges = np.sort(
        np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1
    )
    found, count = np.unique(edges.reshape(-1, 2), axis=0, return_counts=True)
    alone: Indices = found[count == 1]
    return alone


def _stress(time: Vector, found: Plate, rows: Rows) -> dict[str, Any]:
    """Rows of stress (K, 2, 3) by scaled coordinates, upper face first, and these at few times; Pa."""
    coordinates = found.coordinates[rows]
    largest = np.abs(coordinates).max(axis=0, initial=0.0)
    modal = np.moveaxis(found.recovery.modal_stress * largest, 3, 0)  # C, K, 2, 3
    share = von_mises(modal).reshape(len(modal), -1).max(axis=1, initial=0.0)
    peaks = found.recovery.peak(coordinates[::_EVERY]).value
    peak = float(peaks.max())
    used = _largest(share, _LEFT_OUT * peak)
    # von Mises stress is a norm, so that of a sum is at most the sum of those of its parts
    history = coordinates[:, used] / largest[used]
    chosen = straight(time[rows], history * share[used], _SHARE_OF_PEAK * peak)
    rounding = 2.0 * STEP * float(share[used].sum())
    return {
        "rows": short(modal[used].reshape(used.size, -1).T),
        "time": double(time[rows][chosen]),
        "coordinates": short(history[chosen]),
        "tolerance": (_SHARE_OF_PEAK + _LEFT_OUT) * peak + rounding,
        "peak": peak,
        "shown_peak": float(np.percentile(peaks, _SHOWN_PEAK)),
    }
