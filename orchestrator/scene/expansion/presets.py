"""Joints by their name: the hinge that a `preset` of a connection is, with the stiffnesses of the scene's [joint]."""

from __future__ import annotations

from pydantic import ValidationError

from ..damping import StructuralDamping
from ..hinge_line_tables import Joint
from ..layers import Tree

_AXIS = [1.0, 0.0, 0.0]
_FREE, _ALL, _CROSS = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0)
CONSTRAINED = {
    "spherical": (_ALL, _FREE),
    "revolute": (_ALL, _CROSS),
    "cylindrical": (_CROSS, _CROSS),
    "fixed": (_ALL, _ALL),
    "bushing": (_FREE, _FREE),
}
"""What a joint holds, 1, along and about its line and the two axes across, by the name of the preset."""


def with_presets(tree: Tree) -> Tree:
    """The tree where connections with a preset are hinges with their stiffnesses, unless they say others."""
    entries = tree.get("connection")
    if not isinstance(entries, list):
        return tree
    return {**tree, "connection": [_hinge(tree, e) if _has_preset(e) else e for e in entries]}


def _has_preset(entry: object) -> bool:
    return isinstance(entry, dict) and str(entry.get("preset")) in CONSTRAINED


def _hinge(tree: Tree, entry: Tree) -> Tree:
    given, structure = entry.get("parameters", {}), entry.get("structure", {})
    if not isinstance(given, dict) or not isinstance(structure, dict):
        return entry
    return {
        **entry,
        "kind": entry.get("kind", "hinge"),
        "structure": {"axis": _AXIS} | structure,
        "parameters": _parameters(tree, entry["preset"]) | given,
    }


def _parameters(tree: Tree, preset: str) -> Tree:
    """Stiffness and damping, the latter by the time that the scene's joints have."""
    joint, time = _joint(tree)
    along, about = CONSTRAINED[preset]
    translational = [held * joint.radial_stiffness for held in along]
    rotational = [held * joint.cross_stiffness for held in about]
    return {
        "translational_stiffness": translational,
        "translational_damping": [time * stiffness for stiffness in translational],
        "rotational_stiffness": rotational,
        "rotational_damping": [time * stiffness for stiffness in rotational],
    }


def _joint(tree: Tree) -> tuple[Joint, float]:
    """Joint of the scene and its damping over stiffness (s); where they cannot be read, others say so."""
    try:
        joint = Joint.model_validate(tree.get("joint", {}))
        if "structural_damping" in tree:
            return joint, StructuralDamping.model_validate(tree["structural_damping"]).time
    except ValidationError:
        return Joint(), Joint().time
    return joint, joint.time
