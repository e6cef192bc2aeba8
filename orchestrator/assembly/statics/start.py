"""Where an assembly with preload starts, found by Newton's method on exact tangents, where other searches creep."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from components.beam import Beam
from components.contract.component import Vector
from components.contract.frames import rotate, with_positive_scalar
from components.contract.roles import HOLD
from components.hinge import Hinge

from ...scene.table import SceneError
from .. import Assembly, Part, bolted_hinges
from ..beams import as_rigid
from ..start_values import led_to
from .equilibrium_search import driven_motion, settle
from .mechanism import Mechanism
from .placed_body import PlacedBody

_HOLD = "hold_stiffness"
"""Parameter of hinges, 0 of those that a scene gives springs of their own."""
_PART = 1e-3
"""Of the largest turn of a joint in what loads drive, from which on a joint takes part in it."""
_FALLS = 1e-6
"""N and N.m on a free base, from which on it does not stay where it is."""


def in_equilibrium(assembly: Assembly) -> Assembly:
    """The assembly with bodies in static equilibrium, all that can be held; unchanged where none is found near.

    Beams of large deformation have no linear model, and scenes with them stay as they are. So do those whose free base
    falls with all it carries, as here bases stand still.
    """
    try:
        mechanism = _held(assembly)
        settle(mechanism, "", idle=True)
    except SceneError:
        return assembly
    base = mechanism.bodies[mechanism.base]
    if base.body is not None and np.abs(mechanism.forces()[mechanism.rows[base.name]]).max() > _FALLS:
        return assembly
    parts = [_placed(part, mechanism.bodies.get(part.name)) for part in assembly.parts]
    return replace(assembly, parts=led_to(assembly.parts, parts, assembly.links))


def with_free_joints(assembly: Assembly) -> Assembly:
    """The assembly whose static search leaves joints free about their lines, where it has an equilibrium so.

    Hinge lines are held on their way; a joint of a linkage carries no torque about its line in a run's first instant
    either. Joints that take part in what loads would drive away, such as those of pendulums, stay held; what moves
    without force may, as nothing moves it.
    """
    joints = set(held_joints(assembly))
    while assembly.preload and joints:
        freed = _freed(assembly, joints)
        driven = _driven(freed, joints)
        if not driven:
            return freed
        joints -= driven
    return assembly


def held_joints(assembly: Assembly) -> list[str]:
    """Joints of no hinge line that the static search holds about their lines, unless a scene has springs there."""
    of_lines = {hinge for line in assembly.hinge_lines for hinge in line.hinges}
    return [
        part.name
        for part in assembly.parts
        if part.kind == Hinge.kind and part.name not in of_lines and part.start.get(_HOLD) != 0.0
    ]


def _freed(assembly: Assembly, joints: Collection[str]) -> Assembly:
    parts = (
        replace(part, start={**part.start, _HOLD: 0.0}) if part.name in joints else part
        for part in assembly.parts
    )
    return replace(assembly, parts=tuple(parts))


def _driven(freed: Assembly, joints: Collection[str]) -> set[str]:
    """Those of the free joints that have to be held for an equilibrium near the start: all where that is not clear.

    Beams of large deformation are rigid here, where nothing has to be known but what holds them.
    """
    bends = any(part.kind == Beam.kind for part in freed.parts)
    stiff = [as_rigid(part) if part.kind == Beam.kind else part for part in freed.parts]
    try:
        mechanism = _held(replace(freed, parts=tuple(stiff)))
        drive = driven_motion(mechanism)
        if drive is None and not bends:
            settle(mechanism, "", idle=True)
    except SceneError:
        return set(joints)
    if drive is None:
        return set()
    turns = {name: _turn(mechanism, name, drive) for name in joints}
    largest = max(turns.values())
    return {name for name, turn in turns.items() if turn >= _PART * largest}


def _turn(mechanism: Mechanism, joint: str, motion: Vector) -> float:
    """How far a joint's sides turn against each other in a motion (n,)."""
    inboard, outboard = (mechanism.jacobian(joint, port)[3:] @ motion for port in (0, 1))
    return float(np.linalg.norm(outboard - inboard))


def _held(assembly: Assembly) -> Mechanism:
    """Its mechanism with all held that can be."""
    mechanism = Mechanism(assembly.parts, assembly.links, assembly.base)
    mechanism.command(HOLD.name, 1.0, mechanism.connections)
    mechanism.command(HOLD.name, 0.0, bolted_hinges(assembly.hinge_lines))
    return mechanism


def _placed(part: Part, at: PlacedBody | None) -> Part:
    """A part that starts where its body came to rest."""
    if at is None or at.body is None:
        return part
    center = tuple(at.body.data.center_of_mass.tolist())
    start = {
        "initial_position": tuple((at.position - np.array(rotate(at.orientation, center))).tolist()),
        "initial_orientation": with_positive_scalar(at.orientation),
    }
    bent = {"initial_modal_coordinate": tuple(at.eta.tolist())} if at.modes else {}
    return replace(part, start={**part.start, **start, **bent})
