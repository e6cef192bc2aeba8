"""Options of a configuration: angles of hinge lines, and which of them are latched."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import wraps
from math import pi
from typing import TYPE_CHECKING, Concatenate, TypedDict

import click

from ..options import Command, Others, SceneChoice, ordered_names
from ..types import given_quantity

if TYPE_CHECKING:
    from ...analysis.modes import Named

_MOST = 2.0 * pi * (1.0 + 1e-9)
"""rad; no line turns further, and 360deg is rounded."""


class Posed(TypedDict):
    """A configuration by what functions call its parts."""

    configuration: Named
    angles: Mapping[str, str]
    latched: tuple[str, ...] | None


@dataclass(frozen=True, slots=True)
class ConfigurationChoice:
    """A configuration as the command line asks for it."""

    named: Named = "current"
    angles: Mapping[str, float] | None = None
    """rad, of single lines"""
    latched: tuple[str, ...] | None = None

    @property
    def posed(self) -> Posed:
        """Its parts."""
        angles = {line: f"{angle!r} rad" for line, angle in (self.angles or {}).items()}
        return {"configuration": self.named, "angles": angles, "latched": self.latched}


def angles_given(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> dict[str, float]:
    """Angles (rad) by hinge line from HL1=45deg,HL2=0.5rad; every angle has its unit."""
    result: dict[str, float] = {}
    for entry in ordered_names(_, __, values):
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


def lines_given(
    context: click.Context, param: click.Parameter, values: tuple[str, ...]
) -> tuple[str, ...] | None:
    """Names of lines, for an option where leaving it out is not the same as naming none."""
    if not values:
        return None
    lines = ordered_names(context, param, values)
    if not lines:
        raise click.BadParameter("name hinge lines, separated by commas, or say all or none", param=param)
    return lines


def configuration_choice(
    command: Callable[Concatenate[SceneChoice, ConfigurationChoice, Others], None],
) -> Callable[..., None]:
    """The options of a configuration, for a command that takes the choice of one after that of the scene."""

    @wraps(command)
    def with_choice(
        choice: SceneChoice,
        named: Named,
        angles: Mapping[str, float],
        latched: tuple[str, ...] | None,
        *args: Others.args,
        **kwargs: Others.kwargs,
    ) -> None:
        command(choice, ConfigurationChoice(named, angles, latched), *args, **kwargs)

    return _configuration_options(with_choice)


def _configuration_options(command: Command) -> Command:
    command = click.option(
        "--latched", multiple=True, metavar="LINES", callback=lines_given,
        help="Latched lines, separated by commas, or all, or none; by default all if deployed, else none.",
    )(command)  # fmt: skip
    command = click.option(
        "--angle", "--angles", "angles", multiple=True, callback=angles_given, metavar="LINE=ANGLE,...",
        help="Angles of single lines, each with deg or rad, such as HL1=45deg.",
    )(command)  # fmt: skip
    return click.option(
        "--configuration", "named", type=click.Choice(["stowed", "deployed", "current"]), default="current",
        show_default=True, help="Angles of all lines; current is the start of a run.",
    )(command)  # fmt: skip


def as_posed_option(command: Command) -> Command:
    """Option that omits the static equilibrium."""
    return click.option(
        "--as-posed", is_flag=True,
        help="Linearise at the hinge angles themselves, not at the static equilibrium near them.",
    )(command)  # fmt: skip
