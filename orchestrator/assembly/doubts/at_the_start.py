"""What a scene begins with that is hardly meant: blows, open loops, strained rails, hold-downs in mid-travel."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, pi, remainder

import numpy as np

from components import Instance
from components.drive import Drive
from components.hold_down import HoldDown
from components.load import Load
from components.rail import Rail

from ...messages import coded
from ...scene.bodies import scene_points
from ...scene.component_connections import first_number, seated
from ...scene.connection_tables import Connection
from ...scene.locked_groups import joined
from ...scene.loops.closing import closed, left_open, start_poses
from ...scene.loops.freedoms import singular_starts
from ...scene.loops.rates import start_rates
from ...scene.schema import CheckedScene
from ..bolted_lines import bolts_across
from ..driving import load_laws

_DEEP = 1e-3
"""m, by which a rail starts pressed or pulled off its plane."""
_AWAY = 1e-3
"""rad, from the stowed angle, where a line starts in mid-travel."""
_CLOSED = 1e-6
"""m or rad, by which a joint of a loop may start open: 10 N where it has 1e7 N/m."""
_TURNED = 0.2
"""rad; places are written to a few degrees, and loops close from there; tables may end as early."""
_FLAT = 1e-3
"""rad; how far from half a turn two panels are still folded onto each other."""
_NO_RATE = 1e-9
"""m/s and rad/s, that laws leave which begin at rest, such as a cosine."""


def start_doubts(scene: CheckedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-hold-down-start", _bolted_on_the_way(scene))
    yield from coded("W-rail-start", _strained_rails(scene))
    yield from coded("W-drive-start", _wound_drives(scene))
    yield from coded("W-open-loop", _open_at_the_start(scene))
    yield from coded("W-singular-start", singular_starts(scene))
    yield from coded("W-turned-start", _turned_to_close(scene))
    yield from coded("W-start-rate", _moving_from_rest(scene))
    yield from coded("W-base-turned", turned_from_the_world(scene))
    if not scene.header.preload and "preload" not in scene.header.model_fields_set:
        yield from coded("W-start-blow", _struck_by_preload(scene))
        yield from coded("W-start-blow", _struck_by_weight(scene))
        yield from coded("W-start-blow", _ringing_rails(scene))


def _struck_by_preload(scene: CheckedScene) -> Iterator[str]:
    """Loops and hold-downs whose preload acts all at once at the start."""
    roots = joined(scene)
    for loop in scene.loops:
        if loop.preload > 0.0 and roots[loop.pulley_1.body] != roots[loop.pulley_2.body]:
            yield f"ccl.{loop.name}: {_blow(loop.preload)}"
    for bolt in (one for one in scene.connections if one.kind == HoldDown.kind):
        preload = first_number(bolt, "preload")
        if preload > 0.0 and len({roots[seat.body] for seat in bolt.ports.values()}) > 1:
            yield f"connection.{bolt.name}: {_blow(preload)}"


def _struck_by_weight(scene: CheckedScene) -> Iterator[str]:
    """Weight and loads that joints take all at once at the start."""
    loads = [one.name for one in scene.connections if one.kind == Load.kind and _acts_at_start(one)]
    acting = ["gravity"] * (any(scene.header.gravity) and scene.base.free is None) + loads
    if acting:
        yield (
            f"scene.preload: {', '.join(acting)} at the start {'strike' if len(acting) > 1 else 'strikes'} joints and "
            "bodies that bear nothing yet, which then ring by as much again, so that peaks there are up to twice what "
            "they bear in the motion; true starts in the equilibrium of what is held, false says that the blow is meant"
        )


def _acts_at_start(load: Connection) -> bool:
    return any(law.value(0.0) != 0.0 for law in load_laws(load))


def _blow(preload: float) -> str:
    return (
        f"its preload of {preload:g} N strikes the wing at the start; scene.preload = true starts in the equilibrium "
        "under it, false says that the blow is meant"
    )


def _ringing_rails(scene: CheckedScene) -> Iterator[str]:
    """Rails that take a weight all at once at the start, and ring under it for ever."""
    for rail in (one for one in scene.connections if one.kind == Rail.kind):
        if any(scene.header.gravity) and not first_number(rail, "normal_damping"):
            yield (
                f"connection.{rail.name}: nothing damps it (normal_damping), so it rings under the weight that it "
                "takes at the start, for which steps are small all along; scene.preload = true starts in the "
                "equilibrium, false says that the ringing is meant"
            )


def _strained_rails(scene: CheckedScene) -> Iterator[str]:
    """Rails without stiffness, which guide nothing, and those that start out of their plane."""
    for rail, started in _started(scene, Rail.kind):
        stiffness, force = (
            started.parameter("normal_stiffness"),
            abs(float(started.observed()["normal_force"][0])),
        )
        if not stiffness:
            yield f"connection.{rail.name}: its normal_stiffness is 0, so nothing keeps the trolley on its rail"
        elif force > _DEEP * stiffness:
            yield (
                f"connection.{rail.name}: initial_offset starts its trolley {1e3 * force / stiffness:.4g} mm off its "
                f"plane, which normal_stiffness turns into {force:.4g} N"
            )


def _wound_drives(scene: CheckedScene) -> Iterator[str]:
    """Drives whose bodies start elsewhere than where they are commanded to be."""
    for drive, started in _started(scene, Drive.kind):
        told = {name: float(value[0]) for name, value in started.observed().items()}
        wound = told["angle"] - told["commanded_angle"]
        if abs(wound) > _AWAY:
            yield (
                f"connection.{drive.name}: its bodies start {degrees(wound):.4g} deg from what it commands, which "
                f"winds its gearbox up by {abs(told['drive_torque']):.4g} N.m and {told['potential_energy']:.4g} J; "
                "give it the axis of the line that it turns, and aligned_angle and start_angle that fit the line's"
            )


def _started(scene: CheckedScene, kind: str) -> Iterator[tuple[Connection, Instance]]:
    """Connections of a kind, and their components where they start."""
    found = [one for one in scene.connections if one.kind == kind]
    points = scene_points(scene) if found else {}
    poses = start_poses(scene, points) if found else {}
    for one in found:
        started = seated(one, points, poses)
        started.initialize()
        yield one, started


def _bolted_on_the_way(scene: CheckedScene) -> Iterator[str]:
    """Hold-downs across lines that start away from where they are stowed: they grip there."""
    for line in scene.hinge_lines:
        away = line.initial_angle - line.stowed_angle
        if line.held or abs(away) <= _AWAY:
            continue
        for bolt in bolts_across(scene, [line.name]):
            yield (
                f"connection.{bolt}: it holds bodies where the run begins, and {line.name} starts "
                f"{degrees(away):.3g} deg from its stowed angle; leave out a hold-down that has let go by then"
            )


def _open_at_the_start(scene: CheckedScene) -> Iterator[str]:
    """Joints between what lines carry, where start angles do not bring their points together."""
    for name, size in left_open(scene, scene_points(scene)).items():
        if size > _CLOSED:
            yield (
                f"connection.{name}: hinge lines carry its bodies, and their start angles leave it open by "
                f"{1e3 * size:.4g} mm (or mrad), which its stiffness turns into load; check the stowed_angle of each "
                "line of the loop and its digits, or place a body of the loop instead"
            )


def _turned_to_close(scene: CheckedScene) -> Iterator[str]:
    """Placed bodies that joints turn far out of the attitude that they are written with."""
    bare = [one for one in scene.connections if one.preset is not None and one.axes is None]
    for name, angle in closed(scene, scene_points(scene)).turned.items() if bare else ():
        if angle > _TURNED:
            joints = ", ".join(one.name for one in bare if name in {seat.body for seat in one.ports.values()})
            advice = f"give {joints} axes (in the world), or " if joints else ""
            yield (
                f"body.{name}: joints turn it by {degrees(angle):.3g} deg from where its place says, as their ports "
                f"have the axes of their bodies; {advice}place it as they hold it"
            )


def _moving_from_rest(scene: CheckedScene) -> Iterator[str]:
    """Motions that have a rate where all else starts from a static equilibrium."""
    if not scene.header.preload:
        return
    points = scene_points(scene)
    rates = start_rates(scene, points, start_poses(scene, points))
    if names := ", ".join(name for name, rate in rates.items() if np.abs(rate).max() > _NO_RATE):
        yield (
            f"scene.preload: all starts at rest, in static equilibrium, and motions lead {names} at a rate from t = 0 "
            "on: that is a blow; begin motions at rest, or leave preload out"
        )


def turned_from_the_world(scene: CheckedScene) -> Iterator[str]:
    """Bases that a motion turns at the start, beside bodies whose places are those of the world."""
    placed = [body.name for body in scene.bodies if body.place is not None]
    if scene.base.motion is None or not placed:
        return
    turn = scene.base.motion.laws[1].value(0.0)
    if abs(remainder(turn, 2.0 * pi)) > _FLAT:
        yield (
            f"base.motion: it begins with the base turned by {degrees(turn):.4g} deg, and places of "
            f"{', '.join(placed)} and axes of connections are those of the world, which do not turn along; write "
            "these as they are then, or let the law begin at a whole turn"
        )
