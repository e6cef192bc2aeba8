"""The way of a scene from its start to its deployed configuration without any force, as a result over that way."""

from __future__ import annotations

import json
from collections.abc import Mapping

import numpy as np

from components.contract.component import Vector
from components.flexible.modal import ModalData

from ..assembly import Assembly, Geometry
from ..results.parts import Meaning
from ..results.result import Result
from ..scene import PlacedScene

_STAGES = 40
"""Parts of the way; the angle between two is at most 4.5 deg for a line that turns by 180 deg."""


def opening(scene: PlacedScene, assembly: Assembly, models: Mapping[str, ModalData]) -> Result:
    """Poses of rigid bodies where every line, and every motion, is at the same share of its way.

    `time` of the result is that share in %.
    """
    shares = np.linspace(0.0, 1.0, _STAGES + 1)
    stages = scene.way(shares.tolist())
    signals: dict[tuple[str, str], Vector] = {}
    for name in stages[0]:
        signals[name, "frame_position"] = np.array([stage[name].position for stage in stages])
        signals[name, "frame_orientation"] = np.array([stage[name].orientation for stage in stages])
    angles = {line.name: (line.initial_angle, line.deployed_angle, line.held) for line in scene.hinge_lines}
    for line in assembly.hinge_lines:
        first, last, held = angles[line.name]
        signals[line.sensor, "angle"] = first + (0.0 if held else last - first) * shares
    units = {"frame_position": "m", "frame_orientation": "1", "angle": "rad"}
    catalogue: dict[str, dict[str, Meaning]] = {}
    for name, variable in signals:
        catalogue.setdefault(name, {})[variable] = Meaning(units[variable], "")
    geometry = {
        name: Geometry(
            data.display_positions, np.zeros((len(data.display_positions), 3, 0)), data.display_faces
        )
        for name, data in models.items()
        if len(data.display_faces) and name in stages[0]
    }
    provenance = {"scene": scene.header.name, "scene_tree": json.dumps(scene.tree)}
    return Result(
        None, 100.0 * shares, [], {}, provenance, assembly.hinge_lines, geometry, True, catalogue, signals
    )
