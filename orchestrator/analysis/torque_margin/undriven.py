"""Which lines motors open, alone or through cable loops and gears, and what is in no torque margin, and why."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from components import REGISTRY

from ...scene import PlacedScene
from ...scene.component_connections import component_values
from ...scene.connection_tables import Connection
from ...scene.hinge_line_tables import HingeLine
from ...scene.loops.coupled_lines import (
    CoupledLines,
    acting_between,
    acts_across,
    observed_names,
    supplies_energy,
)

_CABLE, _DRIVE, _MOTOR = "ccl", "drive", "motor_"
_COUPLING = {_CABLE: "cable loop", "gear": "gear"}
"""Words for kinds that couple lines."""
_PULLING = ("load", "spring", "suspension", "drag")
"""Kinds whose torques on lines depend on the positions of bodies."""
_AT_RATES = "its inertial loads depend on all angles and rates; `fanfold run` computes them"
_AT_POSES = "its torque on a line depends on all angles; `fanfold analyse equilibrium --sweep` computes it"
MOTOR_TORQUE = "motor_torque"
"""Observation (N.m, positive opening) of a component that drives the line between whose bodies it is."""


def motors(scene: PlacedScene) -> dict[str, tuple[str, ...]]:
    """Connections that tell a motor torque, and the lines that each opens: those between its own two bodies."""
    found = {}
    for connection in scene.connections:
        if MOTOR_TORQUE in observed_names(connection) and not _lacks_motor(connection):
            ends = tuple(
                connection.ports[side].body for side in ("inboard", "outboard") if side in connection.ports
            )
            lines = [one for one in scene.hinge_lines if (one.inboard, one.outboard) == ends and not one.held]
            found[connection.name] = tuple(line.name for line in lines)
    return found


def with_motor(scene: PlacedScene) -> list[HingeLine]:
    """Lines that move and that a motorisation spring or another motor opens."""
    others = {name for names in motors(scene).values() for name in names}
    return [
        line
        for line in scene.hinge_lines
        if not line.held and (line.motor is not None or line.name in others)
    ]


def margin_groups(scene: PlacedScene) -> list[CoupledLines]:
    """Coupled lines that motors open together; what a drive turns opens as it is commanded."""
    motorised = {line.name for line in with_motor(scene)}
    return [group for group in scene.coupled_lines if group.rates.keys() & motorised and not group.drives]


def uncounted(scene: PlacedScene) -> dict[str, str]:
    """What turns lines and has no part in any margin, by name, and why."""
    counted = motors(scene)
    found = {
        name: "its ports are not at the inboard and the outboard body of a line that moves"
        for name, lines in counted.items()
        if not lines
    }
    for connection in scene.connections:
        if connection.name in counted:
            continue
        if connection.kind == _DRIVE:
            found[connection.name] = "its torque follows from the angle that it commands"
        elif connection.kind in _PULLING or supplies_energy(connection):
            found[connection.name] = "what it pulls depends on more than a line's angle"
    if any(scene.header.gravity):
        found["gravity"] = _AT_POSES
    moved = [scene.base.name] * (scene.base.motion is not None)
    moved += [body.name for body in scene.bodies if body.motion is not None]
    found |= {f"motion of {name}": _AT_RATES for name in moved}
    return found | _apart(scene)


def _apart(scene: PlacedScene) -> dict[str, str]:
    """Cable loops and gears at lines with a motor that are in no margin, by name, and why."""
    found, groups, motorised = {}, scene.coupled_lines, with_motor(scene)
    for name, kind, bodies in _movers(scene):
        if kind not in _COUPLING or not any(acts_across(scene, line, bodies) for line in motorised):
            continue
        group = next((group for group in groups if name in group.loops), None)
        if group is None:
            found[name] = "it does not couple lines at fixed rates"
        elif group.drives:
            drives = " and ".join(group.drives)
            found[name] = f"it couples {', '.join(group.rates)}, which {drives} turns, whatever they resist"
    return found


def _lacks_motor(connection: Connection) -> bool:
    """Whether it could have a motor, by keys of that name, and was given none: a joint of a linkage."""
    structure, start = component_values(connection, "mean")
    declared = REGISTRY[connection.kind](**structure).parameter_layout.quantities
    given = (value for name, value in (structure | start).items() if name.startswith(_MOTOR))
    return any(one.name.startswith(_MOTOR) for one in declared) and not any(np.any(value) for value in given)


def without_margin(scene: PlacedScene) -> dict[str, str]:
    """Why a line is in no margin, by line: it is held, or has no motor; then what turns or keeps it."""
    found = {}
    counted = {line.name for line in with_motor(scene)}.union(*(g.rates for g in margin_groups(scene)))
    for line in scene.hinge_lines:
        if line.held:
            found[line.name] = "held in this scene, so without motion"
        elif line.name not in counted:
            found[line.name] = f"no motor{_what_turns(scene, line)}"
    return found


def _what_turns(scene: PlacedScene, line: HingeLine) -> str:
    """Drives, cable loops and gears that can turn a line, or what keeps it, to follow the words "no motor"."""
    acting = [(name, kind) for name, kind, bodies in _movers(scene) if acts_across(scene, line, bodies)]
    by_kind = {
        noun: [name for name, kind in acting if kind == of]
        for of, noun in {_DRIVE: "drive", **_COUPLING}.items()
    }
    words = [_named(noun, names) for noun, names in by_kind.items() if names]
    if words:
        return f"; turned by {' and by '.join(words)}"
    friction = f"; kept by friction of {line.friction_preload:g} N.m" if line.friction_preload else ""
    return f", drive, cable loop or gear{friction}"


def _named(what: str, names: list[str]) -> str:
    """What it is and its names."""
    return f"{what}{'s' * (len(names) > 1)} {' and '.join(names)}"


def _movers(scene: PlacedScene) -> Iterator[tuple[str, str, tuple[tuple[str, ...], ...]]]:
    """Name, role and groups of bodies of what turns lines without a motor: drives, then cable loops and gears."""
    others = {k.name: (k.kind, acting_between(k)) for k in scene.connections}
    for connection in scene.connections:
        if supplies_energy(connection):
            yield connection.name, _DRIVE, others[connection.name][1]
    for loop in scene.loops:
        yield loop.name, _CABLE, ((loop.pulley_1.body, loop.pulley_2.body),)
    for name, (kind, bodies) in others.items():
        if kind in _COUPLING:
            yield name, kind, bodies
