"""Which configuration of a scene an analysis is about: angles of its hinge lines, and which of them are latched."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from functools import wraps
from math import ceil, pi
from typing import Concatenate, Literal

import click

from ..assembly.assemble import assemble
from ..cli.options import Command, Others, SceneChoice, ordered_names
from ..cli.types import given_quantity
from ..scene import Scene, SceneError
from ..scene.bodies import scene_points, start_poses
from ..scene.hinge_line_tables import HingeLine
from ._linear import LinearModel, linearise
from ._mechanism import Mechanism
from ._statics import settle

Named = Literal["stowed", "deployed", "current"]
_LARGEST_TURN = pi / 6.0
"""rad between two poses on the way, so that connections count their angles on."""
_MOST = 2.0 * pi * (1.0 + 1e-9)
"""rad; no line turns further, and 360deg is rounded."""


@dataclass(frozen=True, slots=True)
class Configuration:
    """Angle (rad) of every hinge line by name, and the names of those that are latched."""

    angles: Mapping[str, float]
    latched: tuple[str, ...]


def configuration(
    scene: Scene,
    named: Named = "current",
    angles: Mapping[str, float] | None = None,
    latched: str | None = None,
) -> Configuration:
    """The configuration of a name with some angles changed; SceneError where a line does not exist.

    latched: names with commas between, "all" (with a latch) or "none"; by default all where the configuration is
    "deployed" and none elsewhere. A line that the scene holds keeps its angle unless one is given.
    """
    lines = {line.name: line for line in scene.hinge_lines}
    given = dict(angles or {})
    found = {name: given.get(name, _angle(line, named)) for name, line in lines.items()}
    latched = latched if latched is not None else ("all" if named == "deployed" else "none")
    can = [name for name, line in lines.items() if line.latch is not None and not line.held]
    names = tuple(can) if latched == "all" else _listed(latched)
    problems = [_unknown(scene, name) for name in {**given, **dict.fromkeys(names)} if name not in lines]
    problems += [
        f"{scene.file}: hinge_line.{name}: has no latch that could be latched"
        for name in names
        if name in lines and name not in can
    ]
    if problems:
        raise SceneError(problems)
    return Configuration(found, names)


@dataclass(frozen=True, slots=True)
class ConfigurationChoice:
    """A configuration as the command line asks for it."""

    named: Named = "current"
    angles: Mapping[str, float] | None = None
    """rad, of single lines"""
    latched: str | None = None

    def of(self, scene: Scene) -> Configuration:
        """That of a scene; SceneError where a line does not exist."""
        return configuration(scene, self.named, self.angles, self.latched)


def lines_named(scene: Scene, text: str) -> tuple[str, ...]:
    """Lines that move, by their names with commas between, "all" or "none"; SceneError for others."""
    moving = [line.name for line in scene.hinge_lines if not line.held]
    names = tuple(moving) if text == "all" else _listed(text)
    problems = [_unknown(scene, name) for name in names if name not in moving]
    if problems:
        raise SceneError(problems)
    return names


def _listed(text: str) -> tuple[str, ...]:
    return () if text == "none" else tuple(name.strip() for name in text.split(",") if name.strip())


def _unknown(scene: Scene, name: str) -> str:
    known = ", ".join(line.name for line in scene.hinge_lines if not line.held) or "none"
    return f"{scene.file}: there is no hinge line {name!r} that moves; those are {known}"


def _angle(line: HingeLine, named: Named) -> float:
    if line.held or named == "current":
        return line.initial_angle
    return line.stowed_angle if named == "stowed" else line.deployed_angle


def hinges_of(scene: Scene, lines: Collection[str]) -> list[str]:
    """Names of the hinges of lines that move."""
    return [h.name for line in scene.hinge_lines if line.name in lines and not line.held for h in line.hinges]


def placed(
    scene: Scene, rigid: Collection[str], flexible: Collection[str], target: Configuration
) -> Mechanism:
    """The mechanism in a configuration, as its hinge lines lead there from where a run begins.

    Springs and cables keep what they have in a run: a cable loop its preload at the start, and what it is turned
    since. Latches engage where they are, a drive commands the angle at which it is, and hold-downs hold only where
    a run begins.
    """
    start = with_angles(scene, {k.name: target.angles[k.name] for k in scene.hinge_lines if k.held})
    assembly = assemble(start, rigid, flexible, "mean")
    mechanism = Mechanism(assembly.parts, assembly.links, assembly.base)
    ways = {k.name: (k.initial_angle, target.angles[k.name]) for k in start.hinge_lines}
    _lead(mechanism, start, ways)
    if any(begin != end for begin, end in ways.values()):
        mechanism.command("release_command", 1.0, mechanism.connections)
    mechanism.command("latch_command", 1.0, hinges_of(scene, target.latched))
    for connection in mechanism.connections.values():
        if connection.kind == "drive":
            angle = connection.observe()["angle"]
            connection.set_parameter("start_angle", angle)
            connection.set_parameter("end_angle", angle)
    return mechanism


def _lead(mechanism: Mechanism, scene: Scene, ways: Mapping[str, tuple[float, float]]) -> None:
    """Turn the hinge lines together from their first to their second angles (rad), connections following."""
    steps = max([1, *(ceil(abs(end - begin) / _LARGEST_TURN) for begin, end in ways.values())])
    points = scene_points(scene)
    for k in range(1, steps + 1):
        share = k / steps
        between = {name: begin + share * (end - begin) for name, (begin, end) in ways.items()}
        poses = start_poses(with_angles(scene, between), points)
        for name, body in mechanism.bodies.items():
            if body.body is not None:
                body.place(*poses[name])
        mechanism.follow()


def with_angles(scene: Scene, angles: Mapping[str, float]) -> Scene:
    """The scene with other start angles."""
    lines = tuple(
        line.model_copy(update={"start_angle": angles.get(line.name, line.start_angle)})
        for line in scene.hinge_lines
    )
    return replace(scene, hinge_lines=lines)


def loaded(
    scene: Scene, rigid: Collection[str], flexible: Collection[str], target: Configuration
) -> Mechanism:
    """The same in static equilibrium, lines that are not latched being held for it and free again afterwards."""
    mechanism = placed(scene, rigid, flexible, target)
    free = [line.name for line in scene.hinge_lines if not line.held and line.name not in target.latched]
    hinges = hinges_of(scene, free)
    mechanism.command("hold", 1.0, hinges)
    settle(mechanism, "--as-posed takes the hinge angles as they are, without equilibrium")
    mechanism.command("hold", 0.0, hinges)
    return mechanism


def scene_model(
    scene: Scene, rigid: Collection[str], flexible: Collection[str], target: Configuration, as_posed: bool
) -> LinearModel:
    """The linear model about a configuration, loaded or as posed."""
    return linearise((placed if as_posed else loaded)(scene, rigid, flexible, target))


def angles_given(_: click.Context, __: click.Parameter, value: str) -> dict[str, float]:
    """Angles (rad) by hinge line from HL1=45deg,HL2=0.5rad; every angle has its unit."""
    result: dict[str, float] = {}
    for entry in ordered_names(_, __, value):
        name, equals, text = (part.strip() for part in entry.partition("="))
        if not equals or not name:
            raise click.BadParameter(f"{entry!r} is not of the form HL1=45deg")
        if name in result:
            raise click.BadParameter(f"{entry!r}: {name} has an angle already")
        result[name] = angle_of(name, text)
    return result


def angle_of(line: str, text: str) -> float:
    """An angle of a line such as 45deg or "0.5 rad", in rad, not beyond one turn."""
    angle = given_quantity(text, "rad", f"the angle of {line}")
    if abs(angle) > _MOST:
        raise click.BadParameter(f"the angle of {line} is {text!r}; give one within 360deg")
    return angle


def lines_given(_: click.Context, param: click.Parameter, value: str | None) -> str | None:
    """Lines as they were given, for an option where leaving it out is not the same as naming none."""
    if value is not None and not value.replace(",", " ").strip():
        raise click.BadParameter("name hinge lines with commas between, or say all or none", param=param)
    return value


def configuration_choice(
    command: Callable[Concatenate[SceneChoice, ConfigurationChoice, Others], None],
) -> Callable[..., None]:
    """The options of a configuration, for a command that takes the choice of one after that of the scene."""

    @wraps(command)
    def with_choice(
        choice: SceneChoice,
        named: Named,
        angles: Mapping[str, float],
        latched: str | None,
        *args: Others.args,
        **kwargs: Others.kwargs,
    ) -> None:
        command(choice, ConfigurationChoice(named, angles, latched), *args, **kwargs)

    return _configuration_options(with_choice)


def _configuration_options(command: Command) -> Command:
    command = click.option(
        "--latched", metavar="LINES", callback=lines_given,
        help="Latched lines, with commas between, or all, or none; by default all if deployed, else none.",
    )(command)  # fmt: skip
    command = click.option(
        "--angle", "angles", default="", callback=angles_given, metavar="LINE=ANGLE,...",
        help="Angles of single lines, each with deg or rad, such as HL1=45deg.",
    )(command)  # fmt: skip
    return click.option(
        "--configuration", "named", type=click.Choice(["stowed", "deployed", "current"]), default="current",
        show_default=True, help="Angles of all lines; current is where a run begins.",
    )(command)  # fmt: skip


def as_posed_option(command: Command) -> Command:
    """The option that leaves out static equilibrium."""
    return click.option(
        "--as-posed", is_flag=True,
        help="About the hinge angles themselves, not about the static equilibrium beside them.",
    )(command)  # fmt: skip
