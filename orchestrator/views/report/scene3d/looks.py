"""What a picture adds to recorded geometry: the spacecraft as a box, and how thick plates are."""

from __future__ import annotations

from math import sqrt

import numpy as np

from components import FanfoldError
from components.contract.component import Vector

from ....assembly import Geometry
from ....scene.bodies import body_definition
from ....scene.body_tables import Base
from ....scene.placed_scene import PlacedScene

_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def spacecraft(base: Base) -> Geometry | None:
    """A box of the size that the scene gives, or of the mass properties; None where neither is known.

    Without mass properties the mean of the points, where the wing is fixed, is the middle of the side along x.
    """
    free, axes = base.free, np.eye(3)
    if free is None and base.size is None:
        return None
    if base.size is not None:
        size = np.array(base.size)
    elif free is not None:
        size, axes = _homogeneous(free.mass, np.array(free.inertia, dtype=float))
    if free is not None:
        center = np.array(free.center_of_mass)
    else:
        places = np.array(list(base.points.values()), dtype=float).reshape(-1, 3)
        center = (places.mean(axis=0) if len(places) else np.zeros(3)) - [0.5 * size[0], 0.0, 0.0]
    return Geometry(center + (_CORNERS * size) @ axes.T, np.zeros((8, 3, 0)), _SIDES)


def _homogeneous(mass: float, inertia: Vector) -> tuple[Vector, Vector]:
    """Sides (3,) m and axes (3, 3) of a homogeneous box of a mass (kg) and inertia (3, 3) kg.m2."""
    moments, axes = np.linalg.eigh(inertia)
    squares = 6.0 / mass * (moments.sum() - 2.0 * moments)
    return np.sqrt(np.maximum(squares, 0.0)), axes


def thickness(scene: PlacedScene, name: str) -> float:
    """Distance (m) of the skins of a sandwich that has the stiffnesses of a body's plate; zero without one.

    Bending over membrane stiffness of two thin skins is a quarter of its square.
    """
    for body in scene.bodies:
        if body.name == name and body.rigid is None:
            try:
                panel = body_definition(body).panel
            except FanfoldError:
                return 0.0
            return 0.0 if panel is None else panel.plate.equivalent_thickness / sqrt(3.0)
    return 0.0
