"""Figures of linear analyses: mode shapes, and frequency responses as magnitude and phase."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]
from numpy.typing import NDArray

from components.contract.component import Vector

from ..analysis.frequency_response import FrequencyResponse
from ..analysis.modes import Modes
from ..assembly.statics.linear_model import LinearModel, NormalModes
from ..assembly.statics.mechanism import Mechanism
from .space import bounds, set_view
from .style import COLOURS, DASHES, STYLE, WIDTH, empty_figure, save_figure

_LARGEST_DEFLECTION = 0.12
"""of the size of the whole, in a picture of a mode"""
_SHAPES = 4
"""Modes that are drawn unless more are asked for."""


def plot_modes(found: Modes, folder: Path, count: int = _SHAPES) -> list[Path]:
    """Pictures of the first mode shapes; the paths written."""
    return draw_shapes(folder, found.model, found.shapes, [mode.number - 1 for mode in found.listed[:count]])


def plot_response(found: FrequencyResponse, path: Path) -> list[Path]:
    """Picture of magnitudes and phases, as a file or in a folder; the path written."""
    path = path / "frequency_response.png" if path.is_dir() else path
    title = f"{found.scene}: base acceleration {found.excitation}"
    draw_responses(path, title, found.frequencies, found.responses)
    return [path]


def draw_shapes(folder: Path, model: LinearModel, modes: NormalModes, which: Sequence[int]) -> list[Path]:
    """One picture a mode: the configuration in grey, the mode in the colours of its bodies; the paths written."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for k in which:
        rest = _nodes(model.mechanism, np.zeros(len(model.mass)))
        moved = _nodes(model.mechanism, np.real(modes.shapes[:, k]))
        corners = np.concatenate([faces.reshape(-1, 3) for faces in rest.values()] or [np.zeros((1, 3))])
        size = float(np.ptp(corners, axis=0).max()) or 1.0
        largest = max((float(np.abs(moved[name] - faces).max()) for name, faces in rest.items()), default=0.0)
        scale = _LARGEST_DEFLECTION * size / (largest or 1.0)
        shown = {name: faces + scale * (moved[name] - faces) for name, faces in rest.items()}
        with mpl.rc_context(STYLE):
            figure = empty_figure(6.0, 5.0)
            figure.suptitle(
                f"mode {k + 1}, {modes.frequencies[k]:.4g} Hz; largest deflection drawn as {scale * largest:.2g} m"
            )
            figure.subplots_adjust(left=0.0, right=0.95, bottom=0.0, top=0.95)
            axes: Any = figure.add_subplot(projection="3d", proj_type="ortho")
            for faces in rest.values():
                axes.add_collection3d(
                    Poly3DCollection(faces, facecolor="0.6", edgecolor="0.6", alpha=0.15, linewidth=0.4)
                )
            for number, (name, faces) in enumerate(shown.items()):
                colour = COLOURS[number % len(COLOURS)]
                axes.add_collection3d(
                    Poly3DCollection(
                        faces, facecolor=colour, edgecolor=colour, alpha=0.5, linewidth=0.4, label=name
                    )
                )
            axes.legend(loc="upper left", fontsize=8)
            set_view(axes, *bounds([faces.reshape(-1, 3) for faces in (*rest.values(), *shown.values())]))
            written.append(folder / f"mode_{k + 1:02d}.png")
            save_figure(figure, written[-1])
    return written


def _nodes(mechanism: Mechanism, coordinates: Vector) -> dict[str, Vector]:
    """Corners (F, 4, 3) of the faces of every body that has a picture, moved by small coordinates (n,)."""
    found = {}
    for name, body in mechanism.bodies.items():
        if body.body is None or not len(body.body.data.display_faces):
            continue
        data, step = body.body.data, coordinates[mechanism.rows[name]]
        arms = data.display_positions - data.center_of_mass + data.display_shapes @ body.eta
        world = arms @ body.axes.T
        nodes = body.position + world + step[:3] + np.cross(step[3:6], world)
        nodes += (data.display_shapes @ step[6:]) @ body.axes.T
        found[name] = nodes[data.display_faces]
    return found


def draw_responses(
    path: Path, title: str, frequencies: Vector, curves: Sequence[tuple[str, str, NDArray[np.complex128]]]
) -> None:
    """Magnitude and phase of complex curves over frequency (Hz), by (name, unit, values)."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        figure = empty_figure(WIDTH, 6.0, "constrained")
        magnitude, phase = figure.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
        for i, (name, unit, values) in enumerate(curves):
            style = {
                "color": COLOURS[i % len(COLOURS)],
                "linestyle": DASHES[i // len(COLOURS) % len(DASHES)],
            }
            magnitude.loglog(frequencies, np.abs(values), label=f"{name}, {unit}", linewidth=1.3, **style)
            phase.semilogx(frequencies, np.rad2deg(np.angle(values)), linewidth=1.3, **style)
        units = list(dict.fromkeys(unit for _, unit, _ in curves))
        magnitude.set(title=title, ylabel=f"magnitude, {' or '.join(units)}")
        magnitude.legend(fontsize=8)
        phase.set(
            xlabel="frequency, Hz", ylabel="phase, deg", yticks=[-180, -90, 0, 90, 180], ylim=(-190, 190)
        )
        save_figure(figure, path)
