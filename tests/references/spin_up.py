"""The spin-up beam of Kane, Ryan and Banerjee: a boom on a base that a law turns, built in three ways.

Published: the tip falls 0.574 m behind at 6.76 s; computed by others 0.3628 m at 10 s. At the end it is straight.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import orchestrator as fanfold
from components.body_parts.ports import BodyPorts
from components.contract.component import Vector
from components.contract.frames import rotation_matrix
from tests.references.catalogue import built

LENGTH, RATE, RISE = 10.0, 6.0, 15.0
"""m, rad/s, s"""
DEEPEST, WHEN, AT_TEN = 0.574, 6.76, 0.3628
"""m, s, m"""
SECTION = {
    "axial": 2.8e7, "shear_y": 1e7, "shear_z": 1e7, "torsion": 1e4, "bending_y": 1.4e4, "bending_z": 1.4e4,
    "line_mass": 1.2, "inertia_y": 6e-4, "inertia_z": 6e-4,
}  # fmt: skip
CLAMP, TURN_CLAMP = 1e9, 1e8
"""N/m, N.m/rad"""


def angle(t: Vector) -> Vector:
    """Turn (rad) of the base: its rate rises along a cycloid, then stays."""
    wave = 2.0 * np.pi / RISE
    rising = RATE / RISE * (0.5 * t**2 + (np.cos(wave * t) - 1.0) / wave**2)
    result: Vector = np.where(t < RISE, rising, RATE * (t - 0.5 * RISE))
    return result


def _beam(pieces: int, elements: int) -> dict[str, Any]:
    """One of so many; a tip that carries nothing needs no modes of its own."""
    length = LENGTH / pieces
    root, tip = {"root": 0.0}, {"tip": length}
    points = {"attachment_points": root | tip} if pieces > 1 else {"attachment_points": root, "nodes": tip}
    return {"length": length, "elements": elements, "section": SECTION, **points}


def spin_up(tolerance: float, pieces: int = 1, elements: int = 24, **keys: object) -> fanfold.Scene:
    """The scene, its boom of so many bodies one behind the other; keys: of these bodies."""
    scene = fanfold.Scene("spin_up", until="17 s", tolerance=tolerance)
    turn = [{"profile": "spin_up", "start": 0.0, "duration": RISE, "rate": RATE}]
    hub = scene.base(points={"hub": (0, 0, 0)}, motion={"rotation": turn})
    length, end = LENGTH / pieces, {"body": hub, "point": "hub"}
    for k in range(pieces):
        place = {"body": hub, "point": "hub", "offset": (k * length, 0, 0)}
        piece = scene.body(f"boom{k + 1}", place=place, beam=_beam(pieces, elements), **keys)
        ports = {"inboard": end, "outboard": {"body": piece, "point": "root"}}
        scene.connection(f"clamp{k + 1}", "hinge", preset="fixed", axes={"x": (1, 0, 0)}, ports=ports)
        end = {"body": piece, "point": "tip"}
    scene.joint(axial_stiffness=CLAMP, radial_stiffness=CLAMP, cross_stiffness=TURN_CLAMP)
    return scene


def seen_from_the_base(t: Vector, tip: Vector) -> tuple[Vector, Vector]:
    """Of the tip (T, 3), in the axes of the base: how far it stretches, and how far it falls behind (m)."""
    turn = angle(t)
    along = np.cos(turn) * tip[:, 0] + np.sin(turn) * tip[:, 1] - LENGTH
    return along, np.sin(turn) * tip[:, 0] - np.cos(turn) * tip[:, 1]


def tip_of_modal(result: fanfold.Result, pieces: int, elements: int, modes: int, second_order: int) -> Vector:
    """Positions (T, 3) of the tip of a boom of modal bodies."""
    definition = built({"beam": _beam(pieces, elements)})
    data = definition.flexible(modes, second_order_modes=second_order)
    tip = BodyPorts(data, [{"name": "tip", "point": "tip"}])
    names = ("frame_position", "frame_orientation", "modal_coordinate")
    rows = zip(*(np.array(result[f"boom{pieces}", name]) for name in names), strict=True)
    corner = data.center_of_mass + tip.arms[0]
    return np.array(
        [p + rotation_matrix(tuple(q)) @ (corner + tip.displacements(eta)[0]) for p, q, eta in rows]
    )


def tip_of_beam(result: fanfold.Result) -> Vector:
    """Positions (T, 3) of the last node of a boom of large deformation."""
    found: Vector = np.array(result["boom1", "node_position"])[:, -3:]
    return found
