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
from ..messages import coded, message
from ..scene.component_connections import first_number
from ..scene.connection_tables import Connection
from ..scene.freedoms import singular_start_warnings
from ..scene.joint_presets import CONSTRAINED
from ..scene.placed_scene import PlacedScene
from ..scene.plausible import Plausible

_OFF = Plausible("W-rail-start", "mm", most=1.0, check="Correct initial_offset.")
_AWAY = 1e-3
"""rad, from the stowed angle, where a line starts in mid-travel."""
_WOUND = Plausible(
    "W-drive-start", "deg", -0.057, 0.057, check="Give it the axis and angles of the line that it drives."
)
_CLOSED = 1e-6
"""m or rad, by which a joint of a loop may start open: 10 N where it has 1e7 N/m."""
_TURNED = 0.2
"""rad; places are written to a few degrees, and loops close from there; tables may end as early."""
_TURNED_BASE = 1e-3
"""rad, from whole turns, by which a base starts turned."""
_NO_RATE = 1e-9
"""m/s and rad/s, that laws leave which begin at rest, such as a cosine."""


def start_warnings(scene: PlacedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-hold-down-start", _bolted_on_the_way(scene))
    yield from _strained_rails(scene)
    yield from _wound_drives(scene)
    yield from coded("W-open-loop", _open_at_the_start(scene))
    yield from singular_start_warnings(scene)
    yield from coded("W-turned-start", _turned_to_close(scene))
    yield from coded("W-start-rate", _moving_from_rest(scene))
    yield from coded("W-base-turned", turned_from_the_world(scene))
    if not scene.header.preload and "preload" not in scene.header.model_fields_set:
        yield from coded("W-start-blow", _sudden_loads(scene))


def _sudden_loads(scene: PlacedScene) -> Iterator[str]:
    """Preloads, weight and loads that act suddenly at the start."""
    groups = scene.group_roots
    preloads = [
        (f"ccl.{loop.name}", loop.preload, [loop.pulley_1.body, loop.pulley_2.body]) for loop in scene.loops
    ]
    preloads += [
        (
            f"connection.{bolt.name}",
            first_number(bolt, "preload"),
            [seat.body for seat in bolt.ports.values()],
        )
        for bolt in scene.connections
        if bolt.kind == HoldDown.kind
    ]
    acting = [
        f"the preload of {name} ({preload:g} N)"
        for name, preload, bodies in preloads
        if preload > 0.0 and len({groups[body] for body in bodies}) > 1
    ]
    acting += ["gravity"] * (any(scene.header.gravity) and scene.base.free is None)
    acting += [one.name for one in scene.connections if one.kind == Load.kind and _acts_at_start(one)]
    if acting:
        yield (
            f"scene.preload: {', '.join(acting)} {'act' if len(acting) > 1 else 'acts'} suddenly at the start, "
            "which can double the loads of the first vibration. Set true to start in static equilibrium, or false "
            "if the sudden load is meant."
        )


def _acts_at_start(load: Connection) -> bool:
    return any(law.value(0.0) != 0.0 for law in load_laws(load))


def _strained_rails(scene: PlacedScene) -> Iterator[str]:
    """Rails without stiffness, and rails that start off their plane."""
    for rail, started in _started(scene, Rail.kind):
        stiffness, force = started.parameter("normal_stiffness"), float(started.observed()["normal_force"][0])
        key = f"connection.{rail.name}"
        if not stiffness:
            yield message("W-rail-start", f"{key}: its normal_stiffness is 0, so it guides nothing. Set one.")
        else:
            off = abs(force) / stiffness
            yield from _OFF.warnings(
                f"{key}: initial_offset presses it with {abs(force):.4g} N, by", 1e3 * off
            )


def _wound_drives(scene: PlacedScene) -> Iterator[str]:
    """Drives whose bodies start away from the commanded angle."""
    for drive, started in _started(scene, Drive.kind):
        told = {name: float(value[0]) for name, value in started.observed().items()}
        torque, energy = abs(told["drive_torque"]), told["potential_energy"]
        wound = f"connection.{drive.name}: with {torque:.4g} N.m and {energy:.4g} J in its gearbox it starts"
        yield from _WOUND.warnings(
            f"{wound} away from its command by", degrees(told["angle"] - told["commanded_angle"])
        )


def _started(scene: PlacedScene, kind: str) -> Iterator[tuple[Connection, Instance]]:
    """Connections of a kind, and their components where they start."""
    for one in (one for one in scene.connections if one.kind == kind):
        started = scene.seated(one)
        started.initialize()
        yield one, started


def _bolted_on_the_way(scene: PlacedScene) -> Iterator[str]:
    """Hold-downs across lines that start away from their stowed angle."""
    for line in scene.hinge_lines:
        away = line.initial_angle - line.stowed_angle
        if line.held or (abs(away) <= _AWAY and not line.start_rate):
            continue
        for bolt in bolts_across(scene, [line.name]):
            yield (
                f"connection.{bolt}: it grips at the start of the run, where {line.name} is {degrees(away):.3g} "
                f"deg from its stowed angle and turns at {degrees(line.start_rate or 0.0):.3g} deg/s. Remove "
                "hold-downs that are released before."
            )


def _open_at_the_start(scene: PlacedScene) -> Iterator[str]:
    """Joints of loops that the start angles leave open."""
    for name, size in scene.left_open.items():
        if size > _CLOSED:
            yield (
                f"connection.{name}: the start angles of its hinge lines leave it open by {1e3 * size:.4g} mm (or "
                "mrad), a load by its stiffness. Check stowed_angle and its digits for each line of the loop, or "
                "place a body of the loop."
            )


def _turned_to_close(scene: PlacedScene) -> Iterator[str]:
    """Placed bodies that joints rotate far from their placed attitude."""
    bare = [one for one in scene.connections if one.preset in CONSTRAINED and one.axes is None]
    for name, angle in scene.closed.turned.items() if bare else ():
        if angle > _TURNED:
            joints = ", ".join(one.name for one in bare if name in {seat.body for seat in one.ports.values()})
            advice = f"give {joints} axes (in the world), or " if joints else ""
            yield (
                f"body.{name}: joints turn it by {degrees(angle):.3g} deg from its place, because their ports have "
                f"the axes of their bodies. To correct this, {advice}place it as the joints hold it."
            )


def _moving_from_rest(scene: PlacedScene) -> Iterator[str]:
    """Bodies with an initial rate in a start from static equilibrium."""
    if not scene.header.preload:
        return
    if names := ", ".join(name for name, rate in scene.rates.items() if np.abs(rate).max() > _NO_RATE):
        yield (
            f"scene.preload: {names} start with a rate, but the run starts from static equilibrium, in which "
            "inertia loads of the rate are missing: they act suddenly. Start at rest, or remove preload."
        )


def turned_from_the_world(scene: PlacedScene) -> Iterator[str]:
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
