"""What a scene begins with that is hardly meant: blows of preloads and weight, hold-downs in mid-travel."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

from components.hold_down import HoldDown
from components.rail import Rail

from ..scene.bodies import scene_points
from ..scene.component_connections import first_number, seated
from ..scene.locked_groups import joined
from ..scene.loops.closing import start_poses
from ..scene.schema import CheckedScene
from .bolted_lines import bolts_across

_DEEP = 1e-3
"""m, by which a rail starts pressed or pulled off its plane."""
_AWAY = 1e-3
"""rad, from the stowed angle, where a line starts in mid-travel."""


def start_doubts(scene: CheckedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from _bolted_on_the_way(scene)
    yield from _strained_rails(scene)
    if not scene.header.preload and "preload" not in scene.header.model_fields_set:
        yield from _struck_by_preload(scene)
        yield from _ringing_rails(scene)


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
    rails = [one for one in scene.connections if one.kind == Rail.kind]
    points = scene_points(scene) if rails else {}
    poses = start_poses(scene, points) if rails else {}
    for rail in rails:
        started = seated(rail, points, poses)
        started.initialize()
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
