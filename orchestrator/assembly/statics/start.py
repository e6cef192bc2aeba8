"""Where an assembly with preload starts: in static equilibrium, with its hinge lines held."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.contract.frames import rotate, with_positive_scalar
from components.contract.roles import HOLD
from components.hinge import Hinge

from ...scene.table import SceneError
from .. import Assembly, Part, bolted_hinges
from ..start_values import led_to
from .equilibrium_search import NoEquilibriumError, come_to_rest, driven_motion
from .mechanism import Mechanism
from .placed_beam import PlacedBeam
from .placed_body import PlacedBody

_HOLD = "hold_stiffness"
"""Parameter of hinges, 0 of those that a scene gives springs of their own."""
_PART = 1e-3
"""Of the largest turn of a joint in what loads drive, from which on a joint takes part in it."""


class Start(NamedTuple):
    """An assembly whose bodies start in equilibrium, and the joints beside hinge lines that are held for it.

    Springs of its connections count from where these were built: `CoSimulation.initialize` leads them from there.
    """

    assembly: Assembly
    held: tuple[str, ...]


def static_start(assembly: Assembly) -> Start:
    """The start of an assembly; unchanged without preload or at rest, SceneError where there is no equilibrium near.

    Hinge lines are held on their way; a joint of a linkage carries no torque about its line in a run's first instant
    either, and is free in equilibrium as well. Joints that take part in what loads would drive away, such as those of
    pendulums, are held; what moves without force may, as nothing moves it.
    """
    if not assembly.preload or assembly.at_rest:
        return Start(assembly, ())
    joints, held = set(_joints(assembly)), set[str]()
    while True:
        freed = _freed(assembly, joints)
        driven = _driven(freed, joints)
        if not driven:
            mechanism = _held(freed, is_led=True)
            try:
                come_to_rest(mechanism)
                break
            except NoEquilibriumError as error:
                driven = joints.copy()
                if not driven:
                    raise SceneError([f"{assembly.name}: {_described(mechanism, error)}"]) from None
        joints -= driven
        held |= driven
    parts = [_placed(part, mechanism.bodies.get(part.name)) for part in freed.parts]
    resting = replace(assembly, parts=tuple(parts), at_rest=True)
    return Start(resting, tuple(part.name for part in parts if part.name in held))


def started_at_rest(assembly: Assembly) -> Assembly:
    """The same for hosts that lead nothing: connections start where the bodies' ports are, and know where from."""
    if not assembly.preload:
        return assembly
    parts = led_to(assembly.parts, static_start(assembly).assembly.parts, assembly.links)
    return replace(assembly, parts=parts, preload=False)


def _joints(assembly: Assembly) -> list[str]:
    """Joints of no hinge line, unless a scene has springs about their lines."""
    of_lines = {hinge for line in assembly.hinge_lines for hinge in line.hinges}
    return [
        part.name
        for part in assembly.parts
        if part.kind == Hinge.kind and part.name not in of_lines and part.start.get(_HOLD) != 0.0
    ]


def _freed(assembly: Assembly, joints: Collection[str]) -> Assembly:
    """The assembly that holds nothing about the lines of these joints."""
    parts = (
        replace(part, start={**part.start, _HOLD: 0.0}) if part.name in joints else part
        for part in assembly.parts
    )
    return replace(assembly, parts=tuple(parts))


def _held(assembly: Assembly, *, is_led: bool) -> Mechanism:
    """Its mechanism with all held that can be, but for what hold-downs or drives keep."""
    mechanism = Mechanism(assembly.parts, assembly.links, assembly.base, is_led=is_led)
    mechanism.command(HOLD.name, 1.0, mechanism.connections)
    mechanism.command(HOLD.name, 0.0, bolted_hinges(assembly.hinge_lines))
    return mechanism


def _driven(freed: Assembly, joints: Collection[str]) -> set[str]:
    """Those of the free joints that loads would drive away, but for friction."""
    if not joints:
        return set()
    mechanism = _held(freed, is_led=False)
    motion = driven_motion(mechanism)
    if motion is None:
        return set()
    turns = {name: _turn(mechanism, name, motion) for name in joints}
    largest = max(turns.values())
    return {name for name, turn in turns.items() if largest > 0.0 and turn >= _PART * largest}


def _turn(mechanism: Mechanism, joint: str, motion: Vector) -> float:
    """How far a joint's sides turn against each other in a motion (n,)."""
    inboard, outboard = (mechanism.jacobian(joint, port)[3:] @ motion for port in (0, 1))
    return float(np.linalg.norm(outboard - inboard))


def _described(mechanism: Mechanism, error: NoEquilibriumError) -> str:
    """A sentence on what does not come to rest: which body moves most, and how."""
    motions = {
        name: error.acceleration[rows].reshape(-1)[:6]
        for name, rows in mechanism.rows.items()
        if not mechanism.bodies[name].is_led
    }
    name = max(motions, key=lambda body: np.abs(motions[body]).max())
    if error.turns_as_one:
        return (
            "there is no static equilibrium to start from: with all hinges held, loads turn all that is free as one "
            f"{_way(motions[name][3:], 'about', 'rad/s2')}; start without preload, or have them begin later"
        )
    shift, turn = motions[name][:3], motions[name][3:]
    moves = np.abs(shift).max() >= np.abs(turn).max()
    way = _way(shift, "along", "m/s2") if moves else _way(turn, "about", "rad/s2")
    return (
        f"there is no static equilibrium to start from: with all hinges held, {name} still moves {way}; nothing, or "
        "next to nothing, holds it in that direction: add a connection with stiffness there, or start without preload"
    )


def _way(vector: Vector, words: str, unit: str) -> str:
    size = float(np.linalg.norm(vector))
    x, y, z = (vector / size).round(2).tolist()
    return f"{words} ({x:g}, {y:g}, {z:g}), by {size:.2g} {unit}"


def _placed(part: Part, at: PlacedBody | None) -> Part:
    """A part that starts where its body came to rest."""
    if at is None or at.is_led:
        return part
    if isinstance(at, PlacedBeam):
        w, x, y, z = np.ravel(part.start["initial_orientation"]).tolist()
        return replace(part, start={**part.start, **at.bent_from((w, x, y, z))})
    assert at.body is not None
    center = tuple(at.body.data.center_of_mass.tolist())
    start = {
        "initial_position": tuple((at.position - np.array(rotate(at.orientation, center))).tolist()),
        "initial_orientation": with_positive_scalar(at.orientation),
    }
    bent = {"initial_modal_coordinate": tuple(at.eta.tolist())} if at.modes else {}
    return replace(part, start={**part.start, **start, **bent})
