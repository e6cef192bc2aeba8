"""Which configuration of a scene an analysis is about: angles of its hinge lines, and which of them are latched."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, degrees, pi
from typing import Literal

from components.contract.roles import HOLD, LATCH_COMMAND, RELEASE_COMMAND

from ...scene import PlacedScene, SceneError
from ...scene.builder import Names, listed
from ...scene.hinge_line_tables import HingeLine
from ..assemble import assemble
from ..locked_at_start import bolted_lines
from .equilibrium_search import settle
from .linear_model import LinearModel, linearise
from .mechanism import Mechanism
from .steady_spin import Spin

Named = Literal["stowed", "deployed", "current"]
_AT_START = 1e-9
"""rad"""
_TORN = 1e-3
"""m or rad, by which a configuration may open a loop more than it is at the start."""
_LARGEST_TURN = pi / 6.0
"""rad between two poses on the way, so that connections count their angles on."""


@dataclass(frozen=True, slots=True)
class Configuration:
    """Angle (rad) of every hinge line by name, and the names of those that are latched."""

    angles: Mapping[str, float]
    latched: tuple[str, ...]

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {"angles_rad": dict(self.angles), "latched": list(self.latched)}

    def __str__(self) -> str:
        angles = ", ".join(f"{name} at {degrees(angle):.4g} deg" for name, angle in self.angles.items())
        return f"{angles or 'no hinge lines'}; latched: {', '.join(self.latched) or 'none'}"


def configuration(
    scene: PlacedScene,
    named: Named = "current",
    angles: Mapping[str, float] | None = None,
    latched: Names | None = None,
) -> Configuration:
    """The configuration of a name with some angles changed; SceneError where a line does not exist.

    latched: names, "all" (with a latch) or "none"; by default all where the configuration is
    "deployed" and none elsewhere. A line that the scene holds keeps its angle unless one is given.
    """
    lines = {line.name: line for line in scene.hinge_lines}
    given = dict(angles or {})
    found = {name: given.get(name, _angle(line, named)) for name, line in lines.items()}
    latched = latched if latched is not None else ("all" if named == "deployed" else "none")
    can = [name for name, line in lines.items() if line.latch is not None and not line.held]
    names = _chosen(latched, can)
    problems = [_unknown(scene, name) for name in {**given, **dict.fromkeys(names)} if name not in lines]
    problems += [
        f"{scene.file}: hinge_line.{name}: has no latch that could be latched"
        for name in names
        if name in lines and name not in can
    ]
    if problems:
        raise SceneError(problems)
    return Configuration(found, names)


def lines_named(scene: PlacedScene, lines: Names) -> tuple[str, ...]:
    """Lines that move, by their names, "all" or "none"; SceneError for others."""
    moving = [line.name for line in scene.hinge_lines if not line.held]
    names = _chosen(lines, moving)
    problems = [_unknown(scene, name) for name in names if name not in moving]
    if problems:
        raise SceneError(problems)
    return names


def _chosen(names: Names, every: Sequence[str]) -> tuple[str, ...]:
    """Names, with the words for every line and for no line resolved."""
    found = listed(names)
    return tuple(every) if found == ("all",) else () if found == ("none",) else found


def _unknown(scene: PlacedScene, name: str) -> str:
    known = ", ".join(line.name for line in scene.hinge_lines if not line.held) or "none"
    return f"{scene.file}: there is no hinge line {name!r} that moves; those are {known}"


def _angle(line: HingeLine, named: Named) -> float:
    if line.held or named == "current":
        return line.initial_angle
    return line.stowed_angle if named == "stowed" else line.deployed_angle


def free_lines(scene: PlacedScene, target: Configuration, held: Collection[str] = ()) -> list[str]:
    """Hinge lines that nothing keeps: neither latched in the configuration, nor held."""
    bound = {*target.latched, *held}
    return [line.name for line in scene.hinge_lines if not line.held and line.name not in bound]


def pressed_lines(scene: PlacedScene, target: Configuration) -> frozenset[str]:
    """Lines that are not latched, at an end stop into which their motors press them."""
    return frozenset(
        line.name
        for line in scene.hinge_lines
        if line.name not in target.latched
        and not line.held
        and line.stop_angle is not None
        and abs(target.angles[line.name] - line.stop_angle) < _AT_START
        and line.motor_law.value(line.stop_angle) > 0.0
    )


def kept_lines(scene: PlacedScene, target: Configuration) -> frozenset[str]:
    """Lines that hold-downs or drives keep, where a run begins, so that nothing else need hold them, as in runs."""
    at_start = all(
        abs(target.angles[line.name] - line.initial_angle) < _AT_START for line in scene.hinge_lines
    )
    return bolted_lines(scene) if at_start else frozenset()


def hinges_of(scene: PlacedScene, lines: Collection[str]) -> list[str]:
    """Names of the hinges of lines that move."""
    return [h.name for line in scene.hinge_lines if line.name in lines and not line.held for h in line.hinges]


def placed(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    spin: Spin | None = None,
) -> Mechanism:
    """The mechanism in a configuration, as its hinge lines lead there from where a run begins.

    Springs and cables keep what they have in a run: a cable loop its preload at the start, and what it is turned
    since. Latches engage where they are, a drive commands the angle at which it is, and hold-downs hold only where
    a run begins. Beams of large deformation are modal bodies here. spin: of the axes in which all is at rest.
    """
    start = scene.with_angles({k.name: target.angles[k.name] for k in scene.hinge_lines if k.held})
    assembly = assemble(start, rigid, flexible, "mean", large_deformation=None)
    mechanism = Mechanism(assembly.parts, assembly.links, assembly.base)
    mechanism.spin = spin
    ways = {k.name: (k.initial_angle, target.angles[k.name]) for k in start.hinge_lines}
    _lead(mechanism, start, ways)
    if any(begin != end for begin, end in ways.values()):
        mechanism.command(RELEASE_COMMAND.name, 1.0, mechanism.connections)
    mechanism.command(LATCH_COMMAND.name, 1.0, hinges_of(scene, target.latched))
    for connection in mechanism.connections.values():
        if connection.commands_angle:
            angle = connection.observe()["angle"]
            connection.set_parameter("start_angle", angle)
            connection.set_parameter("end_angle", angle)
    return mechanism


def _lead(mechanism: Mechanism, scene: PlacedScene, ways: Mapping[str, tuple[float, float]]) -> None:
    """Turn the hinge lines together from their first to their second angles (rad), connections following.

    SceneError where the last ones tear a loop.
    """
    _refuse_torn(scene, {name: end for name, (_, end) in ways.items()})
    steps = max([1, *(ceil(abs(end - begin) / _LARGEST_TURN) for begin, end in ways.values())])
    for k in range(1, steps + 1):
        share = k / steps
        between = {name: begin + share * (end - begin) for name, (begin, end) in ways.items()}
        poses = scene.with_angles(between).poses
        for name, body in mechanism.bodies.items():
            if body.body is not None:
                body.place(*poses[name])
        mechanism.follow()


def _refuse_torn(scene: PlacedScene, angles: Mapping[str, float]) -> None:
    """SceneError where these angles (rad) of all lines do not go together."""
    there = scene.with_angles(angles)
    after = {**there.closed.open_by, **there.left_open}
    torn = {name: size for name, size in after.items() if size > scene.left_open.get(name, 0.0) + _TORN}
    if torn:
        name, size = max(torn.items(), key=lambda item: item[1])
        at = ", ".join(f"{line} at {degrees(angle):.4g} deg" for line, angle in angles.items())
        raise SceneError(
            [
                f"{scene.file}: connection.{name}: the loop that it closes stays open by {1e3 * size:.4g} mm (or mrad) "
                f"with {at}; give angles of all lines of a loop, as its joints let them be"
            ]
        )


def loaded(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    spin: Spin | None = None,
) -> Mechanism:
    """The same in static equilibrium, lines that are not latched being held for it and free again afterwards.

    A line at its end stop that its motor presses into it rests there, where nothing else takes it away.
    """
    kept = kept_lines(scene, target)
    for pressed in dict.fromkeys((pressed_lines(scene, target), frozenset())):
        mechanism = placed(scene, rigid, flexible, target, spin)
        hinges = hinges_of(scene, free_lines(scene, target, kept | pressed))
        mechanism.command(HOLD.name, 1.0, hinges)
        try:
            settle(mechanism, "--as-posed (as_posed=True) takes all where it is placed, without equilibrium")
        except SceneError:
            if not pressed:
                raise
            continue
        mechanism.command(HOLD.name, 0.0, hinges)
        break
    return mechanism


def scene_model(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    as_posed: bool,
    spin: Spin | None = None,
) -> LinearModel:
    """The linear model about a configuration, loaded or as posed, at rest or in a steady spin."""
    return linearise((placed if as_posed else loaded)(scene, rigid, flexible, target, spin))
