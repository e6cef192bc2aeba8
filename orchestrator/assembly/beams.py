"""Bodies of large deformation as parts: the component `beam`, with its damping in proportion to stiffness."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from components.beam_parts.linear_model import display_faces
from components.catalogue import BodyDefinition
from components.contract.frames import with_positive_scalar
from components.flexible.modal import default_damping
from components.flexible.reduction import free_frequencies

from ..scene.bodies import body_definition
from ..scene.body_tables import Body
from ..scene.damping import StructuralDamping
from ..scene.locked_groups import RigidGroup
from ..scene.placed_scene import PlacedScene
from ..scene.table import SceneError
from . import Geometry, Part


def beam_part(scene: PlacedScene, body: Body, group: RigidGroup) -> tuple[Part, Geometry]:
    """A beam where it starts, and what a picture of it needs; SceneError where it has attached masses."""
    if body.masses:
        raise SceneError(
            [
                f"{scene.file}: body.{body.name}.attached_masses: a beam of large deformation carries none; give it a "
                "rigid body, joined by a fixed connection"
            ]
        )
    definition = body_definition(body)
    beam = definition.beam
    assert beam is not None
    nodes, at = beam.nodes(), beam.point_nodes
    ports = [
        {"name": s.name, "node": at[s.point], "offset": s.offset, "orientation": s.orientation}
        for s in group.sites
    ]
    structure: dict[str, Any] = {"nodes": nodes, "section": beam.section._asdict(), "ports": ports}
    pose = scene.poses[group.root]
    start: dict[str, float | tuple[float, ...]] = {
        "initial_position": pose.position,
        "initial_orientation": with_positive_scalar(pose.orientation),
        "gravity": scene.header.gravity,
        "stiffness_damping": body.damping_scale * _damping_time(body, definition, scene.structural_damping),
    }
    positions = np.array([node["position"] for node in nodes])
    shown = Geometry(positions, np.zeros((len(nodes), 3, 0)), display_faces(len(nodes)))
    return Part(group.root, "beam", structure, start), shown


def _damping_time(body: Body, definition: BodyDefinition, structural: StructuralDamping | None) -> float:
    """Damping over stiffness (s): structural, or what gives the first mode of the free body its ratio."""
    own = body.structural_damping or structural
    if body.damping_ratio is None and own is not None:
        return own.time
    frequency = _first_frequency(definition)
    ratio = body.damping_ratio
    if ratio is None:
        ratio = float(default_damping(np.array(frequency)))
    return 2.0 * ratio / frequency


@lru_cache(maxsize=32)
def _first_frequency(definition: BodyDefinition) -> float:
    """Of the free body, rad/s."""
    return float(free_frequencies(definition.finite_elements(), 1)[0])
