"""A picture of a scene before its run, stowed and deployed: bodies, hinge lines, cable loops, ports and frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import BytesIO
from itertools import cycle
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from components.contract.component import Vector

from ..analysis.scene_check import SceneCheck, Sketch
from .report.scene_page import scene_page
from .space import bounds, draw_bodies, set_view
from .style import COLOURS, STYLE, WIDTH, empty_figure, save_figure

_TRIAD = 0.06
"""Length of the axes of a frame, of the largest extent of a picture."""
_AXES = ("#C00000", "#007000", "#0000C0")
_LABEL = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.8}
_NEAR, _GAP = 0.02, 0.04
"""Of a body's size: how far two may be from each other that lie in one place, and how far apart they are drawn."""
_ABOVE = 1000.0
"""Order in depth of what is drawn over all bodies."""


def plot_scene(found: SceneCheck, folder: Path) -> list[Path]:
    """Write the picture of a scene without problems, and a page that opens it, into a folder; the paths written."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "scene.png"
    save_figure(draw_scene(found), path)
    page = folder / "scene.html"
    page.write_text(scene_page(found), encoding="utf-8")
    return [path, page]


def picture_of(found: SceneCheck) -> bytes:
    """The picture as the content of a PNG file."""
    stream = BytesIO()
    FigureCanvasAgg(draw_scene(found)).print_png(stream)  # type: ignore[no-untyped-call]
    return stream.getvalue()


def draw_scene(found: SceneCheck) -> Figure:
    """The scene where a run begins, and with all lines deployed and motions farthest from their start."""
    pictures = {"at the start": found.stowed, "deployed": found.deployed}
    sketches = {title: sketch for title, sketch in pictures.items() if sketch is not None}
    names = list(dict.fromkeys(name for sketch in sketches.values() for name in sketch.faces))
    colours = dict(zip(names, cycle(COLOURS), strict=False))
    with mpl.rc_context(STYLE):
        figure = empty_figure(WIDTH, 8.4)
        figure.suptitle(f"{found.scene}, axes in m", y=0.985)
        figure.subplots_adjust(left=0.02, right=0.95, bottom=0.14, top=0.93, hspace=0.08)
        for k, (title, sketch) in enumerate(sketches.items()):
            axes: Any = figure.add_subplot(2, 1, k + 1, projection="3d", proj_type="ortho")
            cell = axes.get_position(original=True)
            folded = any(np.any(moved != sketch.faces[name]) for name, moved in apart(sketch.faces).items())
            words = f"{title}; stacked bodies are drawn apart" if folded else title
            figure.text(0.5, cell.y1, words, ha="center", va="bottom", fontsize=10)
            _draw(axes, sketch, colours)
        _legend(figure, colours, list(sketches.values()))
    return figure


def apart(faces: Mapping[str, Vector]) -> dict[str, Vector]:
    """Faces (F, 4, 3) by body, flat bodies in one place moved along their normal, so that all show."""
    corners = {name: found.reshape(-1, 3) for name, found in faces.items()}
    ends = {name: np.array([nodes.min(0), nodes.max(0)]) for name, nodes in corners.items()}
    moved: dict[str, Vector] = {}
    for k, (name, own) in enumerate(ends.items()):
        size = np.ptp(own, axis=0)
        near = _NEAR * float(size.max())
        before = [one for one in list(ends)[:k] if np.abs(ends[one] - own).max() < near]
        flat = int(np.argmin(size))
        thin = before and size[flat] < near
        moved[name] = faces[name] + (
            _GAP * len(before) * float(size.max()) * np.eye(3)[flat] if thin else 0.0
        )
    return moved


def _draw(axes: Any, sketch: Sketch, colours: Mapping[str, str]) -> None:  # noqa: ANN401 - matplotlib has no type of it
    shown = apart(sketch.faces)
    draw_bodies(axes, shown, colours)
    marked = [
        *sketch.axes.values(),
        *sketch.loops.values(),
        sketch.ports,
        *(at[None] for at, _ in sketch.frames.values()),
    ]
    low, high = bounds([*(faces.reshape(-1, 3) for faces in shown.values()), *marked])
    over: dict[str, Any] = {"zorder": _ABOVE, "clip_on": False}
    if len(sketch.ports):
        axes.plot(*sketch.ports.T, linestyle="none", marker="o", markersize=2.5, color="black", **over)
    for course in sketch.loops.values():
        axes.plot(*course.T, color="black", linewidth=0.9, linestyle=(0, (4, 2)), **over)
    named: dict[tuple[float, ...], list[str]] = {}
    for name, ends in sketch.axes.items():
        axes.plot(*ends.T, color="0.25", linewidth=1.6, linestyle="-.", **over)
        named.setdefault(max(tuple(end) for end in ends.round(3).tolist()), []).append(name)
    for place, lines in named.items():  # those of a folded stack coincide
        axes.text(*place, ", ".join(lines), fontsize=7.5, va="bottom", bbox=_LABEL, **over)
    size = _TRIAD * float(np.max(high - low)) or 1.0
    for origin, turned in sketch.frames.values():
        for direction, colour in zip(turned.T, _AXES, strict=True):
            axes.plot(*np.array([origin, origin + size * direction]).T, color=colour, linewidth=1.4, **over)
    set_view(axes, low, high)


def _legend(figure: Figure, colours: Mapping[str, str], sketches: Sequence[Sketch]) -> None:
    """What is drawn in any of the sketches, and nothing else."""
    handles: list[Any] = [Patch(facecolor=colour, label=name) for name, colour in colours.items()]
    marks = {
        "hinge line": {"color": "0.25", "linestyle": "-.", "linewidth": 1.6},
        "cable loop": {"color": "black", "linestyle": (0, (4, 2)), "linewidth": 0.9},
        "port": {"color": "black", "linestyle": "none", "marker": "o", "markersize": 2.5},
    }
    there = {
        "hinge line": any(sketch.axes for sketch in sketches),
        "cable loop": any(sketch.loops for sketch in sketches),
        "port": any(len(sketch.ports) for sketch in sketches),
    }
    handles += [Line2D([], [], label=name, **look) for name, look in marks.items() if there[name]]  # type: ignore[arg-type]
    handles += [
        Line2D([], [], label=f"{name} of a body", color=colour)
        for name, colour in zip("xyz", _AXES, strict=True)
    ]
    figure.legend(handles=handles, loc="lower center", ncols=6, frameon=False)
