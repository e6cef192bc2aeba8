"""Plates of a run with a prescribed motion: their shape when they are deformed most, and their stresses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from components import FanfoldError
from components.contract.component import Vector

from ...analysis.motion.deflection import deflections, moving
from ...analysis.motion.histories import first_of_arrays
from ...analysis.stress.hot_spots import Choice, PanelStress, panel_stress
from ...results.result import Result
from ..stress import field_figure, hottest_figure
from ..style import WIDTH, empty_figure

_APART = 0.05
_SPOTS = 10


def draw_plates(result: Result) -> Iterator[tuple[str, str, Figure]]:
    """Name, caption and figure of every plate that bends; none of a run that follows no prescribed motion."""
    if not moving(result):
        return
    bodies = first_of_arrays(result.recording("modal_coordinate"))
    for body, found in deflections(result, bodies).items():
        stress = stress_of(result, body)
        if stress is None:
            continue
        words = f"{body} at its largest deformation, at {result.time[found.row]:.4g} s, relative to its frame"
        yield f"{body}_shape", f"{words}.", _shape(result, body, found.row, words)
        spots = ", ".join(
            f"{spot.stress / 1e6:.1f} MPa at ({1e3 * spot.position[0]:.0f}, {1e3 * spot.position[1]:.0f}) mm, "
            f"{spot.time:.3f} s"
            for spot in stress.hot_spots[:3]
        )
        caption = f"Peak von Mises stress of {body}, hot spots {1e3 * _APART:g} mm apart: {spots}, ..."
        yield f"{body}_stress_field", caption, field_figure(stress)
        yield f"{body}_stress_histories", f"Von Mises stress of {body} over time.", hottest_figure(stress)


def stress_of(result: Result, body: str) -> PanelStress | None:
    """Stresses of a plate; None of what is none, or whose face sheets are not known."""
    try:
        return panel_stress(result, body, Choice(), _APART, _SPOTS)
    except FanfoldError:
        return None


def _shape(result: Result, body: str, row: int, title: str) -> Figure:
    """Surface of the body's nodes, the deformation normal to it in mm."""
    geometry = result.geometry[body]
    eta = result.signal(body, "modal_coordinate").reshape(result.time.size, -1)[row]
    places = np.asarray(geometry.positions)
    normal = 1e3 * (np.asarray(geometry.shapes)[:, 2] @ eta)
    figure = empty_figure(WIDTH, 4.6, "constrained")
    figure.suptitle(title)
    axes: Any = figure.add_subplot(projection="3d")
    mesh = Triangulation(places[:, 0], places[:, 1], _triangles(np.asarray(geometry.faces)))
    surface = axes.plot_trisurf(mesh, normal, cmap="cividis", edgecolor="0.4", linewidth=0.3)
    axes.set(xlabel="x, m", ylabel="y, m", zlabel="z, mm")
    figure.colorbar(surface, ax=axes, label="deformation normal to the plate, mm", shrink=0.75)
    return figure


def _triangles(faces: Vector) -> Vector:
    """Triangles (2 T, 3) of faces (T, 4)."""
    return np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
