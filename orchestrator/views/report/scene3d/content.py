"""All that the page's pictures in space and interactive plots show of one result or two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.colors import to_rgb

from components import FanfoldError
from components.contract.component import Vector

from ....analysis.stress.model import scene_of
from ....assembly import Geometry
from ....results.result import Result
from ....scene.placed_scene import PlacedScene
from ...style import COLOURS
from .bodies import Room, ShownBody, extent, moving_bodies
from .curves import contents, panels
from .looks import spacecraft, thickness
from .marks import marks
from .numbers import double

_RAMP = "cividis"
"""Colours of stress: one way in lightness, and alike to those who see no red or no green (Nunez et al. 2018)."""
_RAMP_STEPS = 64
_BLACK, _GREY = "#000000", "#666666"
"""A body is grey that is black in figures, so that its edges are seen, and marks before it."""


@dataclass(frozen=True)
class Content:
    """For the page: the data, whether there is a body to be seen and a curve, and sentences on what lacks."""

    data: dict[str, object]
    has_bodies: bool
    has_curves: bool
    remarks: tuple[str, ...]
    tolerance: float
    """m, that no node of a picture is farther off at any recorded row"""
    stress_tolerance: float
    """Pa, the same of von Mises stress; 0 where none is known"""


_MOTIONS = ("frame_position", "frame_orientation", "modal_coordinate", "node_position")


def content(
    results: Sequence[Result],
    letters: Sequence[str],
    labels: Sequence[str],
    of: PlacedScene | None = None,
    unit: str = "s",
    *,
    stresses: bool = True,
) -> Content:
    """Data of results, which are called by letters in curves and by labels in pictures.

    of: their scene, by default the one that each holds. unit: of their time; one other than s plays in a few seconds.
    stresses: whether plates have theirs.
    """
    room, remarks = Room(), list[str]()
    boxes, made, bodies = list[tuple[Vector, Vector]](), list[dict[str, object]](), list[ShownBody]()
    for result, letter, label in zip(results, letters, labels, strict=True):
        rows = np.flatnonzero(np.diff(result.time, prepend=-np.inf) > 0.0)  # of an event the row before
        scene = of or _scene(result, remarks)
        shown = _bodies(result, remarks)
        found = list[ShownBody]()
        if shown:
            boxes.append(extent(result, shown, rows))
            size = float(np.linalg.norm(boxes[-1][1] - boxes[-1][0])) or 1.0
            every = shown | _spacecraft(result, scene)  # in place of the plane through its points
            every |= _frames(result, every)
            found = moving_bodies(result, every, rows, size, room if stresses else None, remarks)
            for one in found:
                one.data["thickness"] = 0.0 if scene is None else thickness(scene, one.name)
                one.data["is_base"] = scene is not None and one.name == scene.base.name
        bodies += found
        made.append(
            {
                "letter": letter,
                "label": label,
                "clock": double(result.time),
                "bodies": [one.data for one in found],
                "marks": marks(result, scene, shown, [one.name for one in found], rows) if found else {},
                "plots": contents(panels(result)),
                "events": [
                    {"time": time, "component": name, "text": text} for time, name, text in result.events
                ],
            }
        )
    data: dict[str, object] = {
        "results": made,
        "unit": unit,
        "low": np.min([low for low, _ in boxes], axis=0).tolist() if boxes else [],
        "high": np.max([high for _, high in boxes], axis=0).tolist() if boxes else [],
        "colours": [list(to_rgb(colour)) for colour in COLOURS],
        "body_colours": [list(to_rgb(_GREY if colour == _BLACK else colour)) for colour in COLOURS],
        "ramp": mpl.colormaps[_RAMP](np.linspace(0.0, 1.0, _RAMP_STEPS))[:, :3].round(4).tolist(),
    }
    return Content(
        data,
        bool(boxes),
        any(one["plots"] for one in made),
        tuple(dict.fromkeys(remarks)),
        max((one.tolerance for one in bodies), default=0.0),
        max((one.stress_tolerance for one in bodies), default=0.0),
    )


def _scene(result: Result, remarks: list[str]) -> PlacedScene | None:
    """The scene that a result holds; None, and a remark, where it holds none."""
    try:
        scene = scene_of(result)
        scene.points  # noqa: B018 - what is wrong with it shows here
    except FanfoldError as error:
        why = str(error).removeprefix(f"{result.name}: ")
        remarks.append(f"Ports and hinge axes are not shown: {why}")
        return None
    return scene


def _spacecraft(result: Result, scene: PlacedScene | None) -> dict[str, Geometry]:
    box = None if scene is None else spacecraft(scene.base)
    if scene is None or box is None or not _is_finite(result, scene.base.name):
        return {}
    return {scene.base.name: box}


def _bodies(result: Result, remarks: list[str]) -> dict[str, Geometry]:
    """Bodies with a surface whose motion is made of numbers."""
    found = {name: body for name, body in result.geometry.items() if np.size(body.faces)}
    wild = [name for name in found if not _is_finite(result, name)]
    remarks += [f"{name} is not in the 3-D view, because its motion is not finite" for name in wild]
    return {name: body for name, body in found.items() if name not in wild}


def _frames(result: Result, shown: Mapping[str, Geometry]) -> dict[str, Geometry]:
    """Bodies without a surface, such as a free spacecraft, that carry marks."""
    names = [name for name in result.recording("frame_position") if name not in shown]
    empty = Geometry(np.zeros((1, 3)), np.zeros((1, 3, 0)), np.zeros((0, 4), dtype=np.int64))
    bent = result.recording("modal_coordinate")
    return {name: empty for name in names if name not in bent and _is_finite(result, name)}


def _is_finite(result: Result, name: str) -> bool:
    recorded = [variable for variable in _MOTIONS if result.has(name, variable)]
    if not all(np.all(np.isfinite(result.signal(name, variable))) for variable in recorded):
        return False
    return "frame_orientation" not in recorded or bool(
        np.all(np.any(result.signal(name, "frame_orientation") != 0.0, axis=1))
    )
