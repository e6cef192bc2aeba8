"""What drives beside motorisation springs, and lines of a scene that have no torque margin of their own, and why."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from components import REGISTRY, SUPPLIED_ENERGY

from ...scene import CheckedScene
from ...scene.component_connections import component_values
from ...scene.connection_tables import Connection
from ...scene.hinge_line_tables import HingeLine

_CABLE, _DRIVE, _MOTOR = "ccl", "drive", "motor_"
_PULLING = ("load", "suspension", "drag")
"""Kinds whose forces turn lines by where bodies are."""
_AT_RATES = "the loads of accelerations that it leads to depend on all angles and rates; `fanfold run` tells"
_AT_POSES = "what it does to a line depends on all angles; `fanfold analyse equilibrium --sweep` tells it"
MOTOR_TORQUE = "motor_torque"
"""Observation (N.m, positive opening) of a component that drives the line between whose bodies it is."""


def motors(scene: CheckedScene) -> dict[str, tuple[str, ...]]:
    """Connections that tell a motor torque, and the lines that each opens: those between its own two bodies."""
    found = {}
    for connection in scene.connections:
        if MOTOR_TORQUE in _observed(connection) and not _lacks_motor(connection):
            ends = tuple(
                connection.ports[side].body for side in ("inboard", "outboard") if side in connection.ports
            )
            lines = [one for one in scene.hinge_lines if (one.inboard, one.outboard) == ends and not one.held]
            found[connection.name] = tuple(line.name for line in lines)
    return found


def uncounted(scene: CheckedScene) -> dict[str, str]:
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
        elif connection.kind in _PULLING or _drives(connection):
            found[connection.name] = "what it pulls depends on more than a line's angle"
    if any(scene.header.gravity):
        found["gravity"] = _AT_POSES
    moved = [scene.base.name] * (scene.base.motion is not None)
    moved += [body.name for body in scene.bodies if body.motion is not None]
    found |= {f"motion of {name}": _AT_RATES for name in moved}
    for line in _led_by_motors(scene):
        if line.friction_preload or line.harness is not None:
            found[f"friction and harness of {line.name}"] = (
                "they resist what turns it through a cable loop, and that line's margin does not know of them"
            )
    return found


def _led_by_motors(scene: CheckedScene) -> list[HingeLine]:
    """Lines that move without a motor of their own, as cable loops lead to them from one that has."""
    groups = [
        {line.name for line in scene.hinge_lines if _acts(scene, line, bodies)}
        for _, kind, bodies in _movers(scene)
        if kind == _CABLE
    ]
    without = without_margin(scene)
    led = {line.name for line in scene.hinge_lines} - set(without)
    for _ in groups:
        led |= {name for group in groups if group & led for name in group}
    return [line for line in scene.hinge_lines if line.name in led and line.name in without and not line.held]


def _observed(connection: Connection) -> set[str]:
    """Names of what a connection's component observes."""
    structure, _ = component_values(connection, "mean")
    return {
        quantity.name for quantity in REGISTRY[connection.kind](**structure).observation_layout.quantities
    }


def _lacks_motor(connection: Connection) -> bool:
    """Whether it could have a motor, by keys of that name, and was given none: a joint of a linkage."""
    structure, start = component_values(connection, "mean")
    declared = REGISTRY[connection.kind](**structure).parameter_layout.quantities
    given = (value for name, value in (structure | start).items() if name.startswith(_MOTOR))
    return any(one.name.startswith(_MOTOR) for one in declared) and not any(np.any(value) for value in given)


def _drives(connection: Connection) -> bool:
    """Whether its component supplies energy."""
    return SUPPLIED_ENERGY.name in _observed(connection)


def without_margin(scene: CheckedScene) -> dict[str, str]:
    """Why a line has no margin of its own, by line: it is held, or has no motor; then what turns or keeps it."""
    found = {}
    others = {name for names in motors(scene).values() for name in names}
    for line in scene.hinge_lines:
        if line.held:
            found[line.name] = "held in this scene, so without motion"
        elif line.motor is None and line.name not in others:
            found[line.name] = f"no motor{_what_turns(scene, line)}"
    return found


def _what_turns(scene: CheckedScene, line: HingeLine) -> str:
    """Drives and cable loops that can turn a line, or what keeps it, to follow the words "no motor"."""
    acting = [(name, kind) for name, kind, bodies in _movers(scene) if _acts(scene, line, bodies)]
    drives = [name for name, kind in acting if kind == _DRIVE]
    loops = [name for name, kind in acting if kind == _CABLE]
    words = [_named("drive", drives)] * bool(drives) + [_named("cable loop", loops)] * bool(loops)
    if words:
        return f"; turned by {' and by '.join(words)}"
    friction = f"; kept by friction of {line.friction_preload:g} N.m" if line.friction_preload else ""
    return f", drive or cable loop{friction}"


def _named(what: str, names: list[str]) -> str:
    """What it is and its names."""
    return f"{what}{'s' * (len(names) > 1)} {' and '.join(names)}"


def _movers(scene: CheckedScene) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Name, role and bodies of everything that can turn a line without a motor: drives, then cable loops."""
    others = {k.name: (k.kind, tuple(seat.body for seat in k.ports.values())) for k in scene.connections}
    for connection in scene.connections:
        if _drives(connection):
            yield connection.name, _DRIVE, others[connection.name][1]
    for loop in scene.loops:
        yield loop.name, _CABLE, (loop.pulley_1.body, loop.pulley_2.body)
    for name, (kind, bodies) in others.items():
        if kind == _CABLE:
            yield name, kind, bodies


def _acts(scene: CheckedScene, line: HingeLine, bodies: Iterable[str]) -> bool:
    """Whether the line is on the way from one of the bodies to another."""
    carried = [line in scene.lines_inward(body) for body in bodies]
    return any(carried) and not all(carried)
