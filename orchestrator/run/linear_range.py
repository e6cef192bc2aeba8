"""Flat bodies of linear theory that bent so far between what holds them that stretching would have held them back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components import ComponentError

from ..assembly import Assembly, Part
from ..results.result import Result
from ..scene import CheckedScene
from ..scene.bodies import body_definition
from ..scene.body_tables import Body

_THICKNESSES = 1.0
"""Of deflection; a clamped square plate is at 0.90 of them where linear theory has it at 1.3 (Levy, 1942)."""
_MOST_ROWS = 2000
_FEWEST_HOLDERS = 3


class _Bend(NamedTuple):
    """Deflection (m) from the plane through the points that hold a body, and when (s)."""

    deflection: float
    time: float


def linear_range_sentences(scene: CheckedScene, assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for each plate without stretching that bent by more than its thickness between its joints."""
    bodies = {body.name: body for body in scene.bodies}
    for part in assembly.parts:
        thickness = _thickness(bodies.get(part.name)) if part.name in assembly.flexible else None
        bend = None if thickness is None else _largest_bend(assembly, part, result)
        if bend is None or thickness is None or bend.deflection <= _THICKNESSES * thickness:
            continue
        yield (
            f"{part.name} bent by {1e3 * bend.deflection:.3g} mm between its joints, at {bend.time:.4g} s, "
            f"{bend.deflection / thickness:.2g} times the {1e3 * thickness:.3g} mm of its plate, which is linear: "
            "bending gives it no tension, which would hold it back as far as its joints do not give way; compare with "
            'geometry = "von_karman" of its panel'
        )


def _thickness(body: Body | None) -> float | None:
    """Of a plate of its bending and membrane stiffness (m); None for what is no plate, or stretches."""
    if body is None or body.rigid is not None:
        return None
    try:
        panel = body_definition(body).panel
    except ComponentError:
        return None
    if panel is None or panel.plate.geometry != "linear":
        return None
    return float(np.sqrt(12.0 * panel.plate.bending[0] / panel.plate.membrane[0]))


def _largest_bend(assembly: Assembly, part: Part, result: Result) -> _Bend | None:
    """None where fewer than three points, or points on one line, hold the body: it then bends without stretching."""
    modal, shown = part.structure["modal"], assembly.geometry.get(part.name)
    held = {end[1] for link in assembly.links if (end := link.body)[0] == part.name}
    points = {port["point"] for port in part.structure["ports"] if port["name"] in held}
    rows = [row for row, name in enumerate(modal["point_names"]) if name in points]
    plane = _with_ones(np.asarray(modal["point_positions"])[rows])
    if (
        shown is None
        or len(rows) < _FEWEST_HOLDERS
        or np.linalg.matrix_rank(plane, tol=1e-6) < _FEWEST_HOLDERS
    ):
        return None
    # the deflection of the surface less that of the plane, both linear in the modes
    tilt = np.linalg.pinv(plane) @ np.asarray(modal["translation"])[rows, 2]
    shapes = np.asarray(shown.shapes)[:, 2] - _with_ones(np.asarray(shown.positions)) @ tilt
    eta = np.asarray(result.signal(part.name, "modal_coordinate")).reshape(result.time.size, -1)
    chosen = np.unique(np.linspace(0, len(eta) - 1, min(len(eta), _MOST_ROWS)).astype(int))
    size = np.abs(shapes @ eta[chosen].T).max(axis=0, initial=0.0)
    top = int(np.argmax(size))
    return _Bend(float(size[top]), float(result.time[chosen[top]]))


def _with_ones(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3): 1, x, y, by which planes are linear."""
    return np.column_stack([np.ones(len(positions)), positions[:, :2]])
