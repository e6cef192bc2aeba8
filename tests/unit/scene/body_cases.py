"""Tables of bodies that are sound, and how tests change them."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from math import radians
from typing import Any

SKINS = {"skin": 0.2e-3, "core": 0.02, "youngs_modulus": 70e9, "poisson_ratio": 0.3}
PANEL = {
    "length": 1.1,
    "width": 0.7,
    "areal_mass": 3.2,
    "sandwich": SKINS,
    "arm": {"y": 0.25, "length": 0.04, "patch": 0.06},
    "hinge_lines": {"inboard": "root", "outboard": "tip"},
    "element_size": 0.2,
}
TUBE = {"diameter": 0.03, "wall": 0.002, "youngs_modulus": 70e9, "shear_modulus": 27e9, "density": 2700.0}
FRAME = {
    "tube": TUBE,
    "joints": {"a": [0.0, 0.0, 0.0], "l": [0.8, 0.4, 0.0], "r": [0.8, -0.4, 0.0]},
    "members": [
        {"name": "left", "joints": ["a", "l"]},
        {"name": "right", "joints": ["a", "r"]},
        {"name": "bar", "joints": ["l", "r"]},
    ],
    "attachment_points": ["a", "l", "r"],
}


LAYER = {"thickness": 1e-3, "youngs_modulus": 70e9, "poisson_ratio": 0.3, "shear_modulus": 27e9}


OUTER = {**LAYER, "thickness": 0.2e-3}
CORE = {"thickness": 20e-3, "youngs_modulus": 1e6, "poisson_ratio": 0.3, "shear_modulus": 1e6 / 2.6}


BOOM = {
    "length": 2.5,
    "radius": 2.0,
    "tube": {"diameter": 0.03, "wall": 1e-3, "youngs_modulus": 70e9, "poisson_ratio": 0.3, "density": 2700.0},
    "attachment_points": {"root": 0.0, "hook": 0.7, "tip": 2.5},
}


def changed(tables: Mapping[str, Any], path: str, value: object) -> dict[str, Any]:
    """A copy with one value put in its place, or taken away where the value is None."""
    found: dict[str, Any] = deepcopy(dict(tables))
    *steps, last = path.split(".")
    inner: Any = found
    for step in steps:
        inner = inner[int(step)] if isinstance(inner, list) else inner.setdefault(step, {})
    if value is None:
        del inner[last]
    else:
        inner[last] = value
    return found


def of_layers(*layers: Mapping[str, Any]) -> dict[str, Any]:
    """The panel with these layers in place of the sandwich."""
    return {**changed(PANEL, "sandwich", None), "layers": [*layers]}


def carbon(*degrees_: float) -> list[dict[str, Any]]:
    """Thin layers at these angles on either side of a core, alike from the middle."""
    skin = [
        {
            "thickness": 0.05e-3, "youngs_modulus": 140e9, "transverse_modulus": 9e9, "poisson_ratio": 0.3,
            "shear_modulus": 5e9, "angle": radians(one),
        }
        for one in degrees_
    ]  # fmt: skip
    return [*skin, CORE, *skin[::-1]]
