"""A leaf on a fixed jamb, which a test joins to it by a line of its own."""

from __future__ import annotations

from typing import Any

import orchestrator as fanfold


def leaf_on_a_jamb(name: str, inertia: float, **header: Any) -> fanfold.Scene:
    """A base and a rigid leaf of 1 kg and the same inertia (kg.m2) about all axes, whose centre is on the line."""
    scene = fanfold.Scene(name, **header)
    scene.base(points={"jamb": (0, 0, 0)})
    rigid = {
        "mass": 1.0,
        "center_of_mass": (0, 0, 0),
        "inertia": (inertia,) * 3,
        "points": {"root": (0, 0, 0)},
    }
    scene.body("leaf", rigid=rigid)
    return scene
