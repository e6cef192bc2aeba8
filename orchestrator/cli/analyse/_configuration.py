"""Options of a configuration: angles of hinge lines, and which of them are latched."""

from __future__ import annotations

from math import pi
from typing import Any

import click

from ..types import given_quantity, ordered_names

_MOST = 2.0 * pi * (1.0 + 1e-9)
"""rad; no line turns further, and 360deg is rounded."""


def angles_given(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> dict[str, str]:
    """Angles by hinge line from HL1=45deg,HL2=0.5rad; every angle has its unit."""
    result: dict[str, str] = {}
    for entry in ordered_names(_, __, values):
        name, equals, text = (part.strip() for part in entry.partition("="))
        if not equals or not name:
            raise click.BadParameter(f"{entry!r} is not of the form HL1=45deg")
        if name in result:
            raise click.BadParameter(f"{entry!r}: {name} has an angle already")
        result[name] = angle_of(name, text)
    return result


def angle_of(line: str, text: str) -> str:
    """An angle of a line such as 45deg or "0.5 rad", not beyond one turn, in rad with its unit."""
    angle = given_quantity(text, "rad", f"the angle of {line}")
    if abs(angle) > _MOST:
        raise click.BadParameter(f"the angle of {line} is {text!r}; give one within 360deg")
    return f"{angle!r} rad"


ANGLES: dict[str, Any] = {
    "flags": "--angle --angles",
    "metavar": "LINE=ANGLE,...",
    "callback": angles_given,
    "help": "Angles of single lines, each with deg or rad, such as HL1=45deg.",
}
"""The option of angles of single lines."""
