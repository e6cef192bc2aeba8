"""Probable mistakes in the start of a scene: sudden loads, open loops, strained rails, hold-downs in mid-travel."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, pi, remainder

import numpy as np

from components import Instance
from components.drive import Drive
from components.hold_down import HoldDown
from components.load import Load
from components.rail import Rail

from ..assembly.driving import load_laws
from ..assembly.locked_at_start import bolts_across
from ..messages import coded
from ..scene.component_connections import first_number
from ..scene.connection_tables import Connection
from ..scene.freedoms import singular_start_warnings
from ..scene.placed_scene import CheckedScene

_DEEP = 1e-3
"""m, by which a rail starts pressed or pulled off its plane."""
_AWAY = 1e-3
"""rad, from the stowed angle, where a line starts in mid-travel."""
_CLOSED = 1e-6
"""m or rad, by which a joint of a loop may start open: 10 N where it has 1e7 N/m."""
_TURNED = 0.2
"""rad; places are written to a few degrees, and loops close from there; tables may end as early."""
_TURNED_BASE = 1e-3
"""rad, from whole turns, by which a base starts turned."""
_NO_RATE = 1e-9
"""m/s and rad/s, that laws leave which begin at rest, such as a cosine."""


def start_warnings(scene: CheckedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-hold-down-start", _bolted_on_the_way(scene))
    yield from coded("W-rail-start", _strained_rails(scene))
    yield from coded("W-drive-start", _wound_drives(scene))
    yield from coded("W-open-loop", _open_at_the_start(scene))
    yield from coded("W-singular-start", singular_start_warnings(scene))
    yield from coded("W-turned-start", _turned_to_close(scene))
    yield from coded("W-start-rate", _moving_from_rest(scene))
    yield from coded("W-base-turned", turned_from_the_world(scene))
    if not scene.header.preload and "preload" not in scene.header.model_fields_set:
        yield from coded("W-start-blow", _struck_by_preload(scene))
        yield from coded("W-start-blow", _struck_by_weight(scene))
        yield from coded("W-start-blow", _ringing_rails(scene))


def _struck_by_preload(scene: CheckedScene) -> Iterator[str]:
    """Loops and hold-downs whose preload acts suddenly at the start."""
    roots = scene.rigid_groups
    for loop in scene.loops:
        if loop.preload > 0.0 and roots[loop.pulley_1.body] != roots[loop.pulley_2.body]:
            yield f"ccl.{loop.name}: {_blow(loop.preload)}"
    for bolt in (one for one in scene.connections if one.kind == HoldDown.kind):
        preload = first_number(bolt, "preload")
        if preload > 0.0 and len({roots[seat.body] for seat in bolt.ports.values()}) > 1:
            yield f"connection.{bolt.name}: {_blow(preload)}"


def _struck_by_weight(scene: CheckedScene) -> Iterator[str]:
    """Weight and loads that act on joints suddenly at the start."""
    loads = [one.name for one in scene.connections if one.kind == Load.kind and _acts_at_start(one)]
    acting = ["gravity"] * (any(scene.header.gravity) and scene.base.free is None) + loads
    if acting:
        yield (
            f"scene.preload: {', '.join(acting)} {'act' if len(acting) > 1 else 'acts'} suddenly at the start, "
            "which can double the loads of the first vibration. Set true to start in static equilibrium, or false "
            "if the sudden load is meant."
        )


def _acts_at_start(load: Connection) -> bool:
    return any(law.value(0.0) != 0.0 for law in load_laws(load))


def _blow(preload: float) -> str:
    return (
        f"its preload of {preload:g} N acts suddenly at the start. Set scene.preload = true to start in static "
        "equilibrium, or false if the sudden load is meant."
    )


def _ringing_rails(scene: CheckedScene) -> Iterator[str]:
    """Undamped rails that a weight loads suddenly at the start."""
    for rail in (one for one in scene.connections if one.kind == Rail.kind):
        if any(scene.header.gravity) and not first_number(rail, "normal_damping"):
            yield (
                f"connection.{rail.name}: without normal_damping it vibrates under the weight that acts suddenly "
                "at the start, and steps stay small. Set scene.preload = true to start in static equilibrium, or "
                "false if the vibration is meant."
            )


def _strained_rails(scene: CheckedScene) -> Iterator[str]:
    """Rails without stiffness, and rails that start off their plane."""
    for rail, started in _started(scene, Rail.kind):
        stiffness, force = (
            started.parameter("normal_stiffness"),
            abs(float(started.observed()["normal_force"][0])),
        )
        if not stiffness:
            yield (
                f"connection.{rail.name}: its normal_stiffness is 0, so the rail does not guide the trolley. Set "
                "normal_stiffness."
            )
        elif force > _DEEP * stiffness:
            yield (
                f"connection.{rail.name}: initial_offset places the trolley {1e3 * force / stiffness:.4g} mm off "
                f"its plane, a force of {force:.4g} N with this normal_stiffness. Correct initial_offset."
            )


def _wound_drives(scene: CheckedScene) -> Iterator[str]:
    """Drives whose bodies start away from the commanded angle."""
    for drive, started in _started(scene, Drive.kind):
        told = {name: float(value[0]) for name, value in started.observed().items()}
        wound = told["angle"] - told["commanded_angle"]
        if abs(wound) > _AWAY:
            yield (
                f"connection.{drive.name}: its bodies start {degrees(wound):.4g} deg from the commanded angle, a "
                f"torque of {abs(told['drive_torque']):.4g} N.m and {told['potential_energy']:.4g} J in the "
                "gearbox. Give it the axis, aligned_angle and start_angle of the line that it drives."
            )


def _started(scene: CheckedScene, kind: str) -> Iterator[tuple[Connection, Instance]]:
    """Connections of a kind, and their components where they start."""
    for one in (one for one in scene.connections if one.kind == kind):
        started = scene.seated(one)
        started.initialize()
        yield one, started


def _bolted_on_the_way(scene: CheckedScene) -> Iterator[str]:
    """Hold-downs across lines that start away from their stowed angle."""
    for line in scene.hinge_lines:
        away = line.initial_angle - line.stowed_angle
        if line.held or abs(away) <= _AWAY:
            continue
        for bolt in bolts_across(scene, [line.name]):
            yield (
                f"connection.{bolt}: it grips at the start of the run, where {line.name} is {degrees(away):.3g} "
                "deg from its stowed angle. Remove hold-downs that are released before."
            )


def _open_at_the_start(scene: CheckedScene) -> Iterator[str]:
    """Joints of loops that the start angles leave open."""
    for name, size in scene.left_open.items():
        if size > _CLOSED:
            yield (
                f"connection.{name}: the start angles of its hinge lines leave it open by {1e3 * size:.4g} mm (or "
                "mrad), a load by its stiffness. Check stowed_angle and its digits for each line of the loop, or "
                "place a body of the loop."
            )


def _turned_to_close(scene: CheckedScene) -> Iterator[str]:
    """Placed bodies that joints rotate far from their placed attitude."""
    bare = [one for one in scene.connections if one.preset is not None and one.axes is None]
    for name, angle in scene.closed.turned.items() if bare else ():
        if angle > _TURNED:
            joints = ", ".join(one.name for one in bare if name in {seat.body for seat in one.ports.values()})
            advice = f"give {joints} axes (in the world), or " if joints else ""
            yield (
                f"body.{name}: joints turn it by {degrees(angle):.3g} deg from its place, because their ports have "
                f"the axes of their bodies. To correct this, {advice}place it as the joints hold it."
            )


def _moving_from_rest(scene: CheckedScene) -> Iterator[str]:
    """Motion laws with an initial rate in a start from static equilibrium."""
    if not scene.header.preload:
        return
    if names := ", ".join(name for name, rate in scene.rates.items() if np.abs(rate).max() > _NO_RATE):
        yield (
            f"scene.preload: motion laws move {names} with a rate at t = 0, but the run starts from static "
            "equilibrium, which is a sudden load. Let the laws start at rest, or remove preload."
        )


def turned_from_the_world(scene: CheckedScene) -> Iterator[str]:
    """Bases that a motion law rotates at the start, while bodies are placed in the world."""
    placed = [body.name for body in scene.bodies if body.place is not None]
    if scene.base.motion is None or not placed:
        return
    turn = scene.base.motion.laws[1].value(0.0)
    if abs(remainder(turn, 2.0 * pi)) > _TURNED_BASE:
        yield (
            f"base.motion: the base starts rotated by {degrees(turn):.4g} deg, but places of {', '.join(placed)} "
            "and axes of connections are in the world and do not rotate with it. Write them for the rotated base, "
            "or let the law start at a full turn."
        )
