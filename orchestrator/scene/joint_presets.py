"""Joints by their name: the hinge that a `preset` of a connection is, stiff and damped as the [joint] of the scene."""

from __future__ import annotations

from pydantic import ValidationError

from .damping import StructuralDamping
from .hinge_line_tables import Joint
from .layers import Tree
from .units import to_si

_AXIS = [1.0, 0.0, 0.0]
_FREE, _ALL, _CROSS = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0)
CONSTRAINED = {
    "spherical": (_ALL, _FREE),
    "revolute": (_ALL, _CROSS),
    "cylindrical": (_CROSS, _CROSS),
    "prismatic": (_CROSS, _ALL),
    "universal": (_ALL, (0.0, 0.0, 1.0)),
    "fixed": (_ALL, _ALL),
    "bushing": (_FREE, _FREE),
}
"""What a joint holds, 1, along and about its line and the two axes across, by the name of the preset."""
DISTANCE = "distance"
"""Preset that holds the distance of two points, by a stiff spring."""


def kind_of(preset: object) -> str:
    """Kind of component that a preset is."""
    return "spring" if preset == DISTANCE else "hinge"


def with_presets(tree: Tree) -> Tree:
    """The tree where connections with a preset are components with their stiffnesses, unless they say others."""
    entries = tree.get("connection")
    if not isinstance(entries, list):
        return tree
    return {**tree, "connection": [_joined(tree, e) if _has_preset(e) else e for e in entries]}


def _has_preset(entry: object) -> bool:
    return isinstance(entry, dict) and str(entry.get("preset")) in (*CONSTRAINED, DISTANCE)


def _joined(tree: Tree, entry: Tree) -> Tree:
    given, structure = entry.get("parameters", {}), entry.get("structure", {})
    if not isinstance(given, dict) or not isinstance(structure, dict):
        return entry
    entry = {**entry, "kind": entry.get("kind", kind_of(entry["preset"]))}
    if entry["preset"] == DISTANCE:
        return {**entry, "parameters": _rod(tree, given) | given}
    return {
        **entry,
        "structure": {"axis": _AXIS} | structure,
        "parameters": _parameters(tree, entry["preset"], given) | given,
    }


def _rod(tree: Tree, given: Tree) -> Tree:
    """Stiffness and damping along the line between two points."""
    joint, time = _joint(tree)
    stiffness = joint.radial_stiffness
    if "stiffness" in given:
        try:
            stiffness = to_si(given["stiffness"], "N/m")
        except ValueError:
            return {}  # whoever reads the parameters says so
    return {"stiffness": stiffness, "damping": time * stiffness}


def _parameters(tree: Tree, preset: str, given: Tree) -> Tree:
    """Stiffness where none is given, and damping in proportion to what there is, by the time of the scene's joints.

    Clearances of the scene's joints are those of directions with stiffness.
    """
    joint, time = _joint(tree)
    along, about = CONSTRAINED[preset]
    plays = {
        "translational": (("axial_clearance", slice(1)), ("radial_clearance", slice(1, 3))),
        "rotational": (("cross_clearance", slice(1, 3)),),
    }
    found: Tree = {}
    for name, unit, held, stiffness in (
        ("translational", "N/m", along, joint.radial_stiffness),
        ("rotational", "N.m/rad", about, joint.cross_stiffness),
    ):
        own = [share * stiffness for share in held]
        found[f"{name}_stiffness"] = own
        stated = _read(given.get(f"{name}_stiffness"), unit)
        acting = own if stated is None else stated
        found[f"{name}_damping"] = [time * k for k in acting]
        for clearance, axes in plays[name]:
            if getattr(joint, clearance) and any(acting[axes]):
                found[clearance] = getattr(joint, clearance)
    return found


def _read(values: object, unit: str) -> list[float] | None:
    """Along three axes, in SI units; None where there are none, or none that can be read, which others say."""
    if not isinstance(values, list | tuple) or len(values) != 3:
        return None
    try:
        return [to_si(value, unit) for value in values]
    except ValueError:
        return None


def _joint(tree: Tree) -> tuple[Joint, float]:
    """Joint of the scene and its damping over stiffness (s); where they cannot be read, others say so."""
    try:
        joint = Joint.model_validate(tree.get("joint", {}))
        if "structural_damping" in tree:
            return joint, StructuralDamping.model_validate(tree["structural_damping"]).time
    except ValidationError:
        return Joint(), Joint().time
    return joint, joint.time
