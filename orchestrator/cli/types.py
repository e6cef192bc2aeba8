"""Types of option values: numbers in a range, counts, quantities with a unit, files of pictures."""

from __future__ import annotations

import os
import re
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from ..scene.units import Sign

_SEPARATORS = tuple(filter(None, (os.sep, os.altsep)))
_PICTURES = (".png", ".pdf", ".svg")


def _range(low: float | None, high: float | None, low_open: bool) -> str:
    """Bounds for help and refusals; nothing where there are none."""
    if low is None:
        return "" if high is None else f"x<={_short(high)}"
    if high is None:
        return f"x{'>' if low_open else '>='}{_short(low)}"
    return f"{_short(low)}{'<' if low_open else '<='}x<={_short(high)}"


def _short(number: float) -> str:
    """In as few characters as it takes: 1e-7, not 1e-07."""
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{number:g}")


class Number(click.FloatRange):
    """A number in a range; "nan" and "inf" are none."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The number, or click's own refusal."""
        number = super().convert(value, param, ctx)
        return number if isfinite(number) else self.fail(f"{value} is not a finite number.", param, ctx)

    def _describe_range(self) -> str:
        return _range(self.min, self.max, self.min_open)


class Seconds(Number):
    """A time in a range, a plain number or one with its unit, such as 8ms."""

    name = "number of seconds"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """Seconds, or click's own refusal."""
        from ..scene.units import QUANTITY, UNITS, to_si  # takes its time, which --help need not

        if isinstance(value, str) and (found := QUANTITY.fullmatch(value)) and found[2] in UNITS["s"]:
            try:
                value = to_si(f"{found[1]} {found[2]}", "s")
            except ValueError as error:
                self.fail(f"{value!r}: it {error}.", param, ctx)
        return super().convert(value, param, ctx)


class Spacing(Seconds):
    """Seconds between rows, None where "all" are meant."""

    name = "spacing in seconds"

    def __init__(self) -> None:
        super().__init__(min=0.0, min_open=True)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """Seconds, None, or click's own refusal."""
        return None if value == "all" else super().convert(value, param, ctx)


class Count(click.IntRange):
    """A whole number in a range."""

    name = "integer"

    def _describe_range(self) -> str:
        return _range(self.min, self.max, self.min_open)


class OutputFile(click.Path):
    """A file to write; what ends like a folder is refused, as a file of its name would be made of it."""

    def __init__(self) -> None:
        super().__init__(path_type=Path, dir_okay=False)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The path, or a refusal."""
        if str(value).endswith(_SEPARATORS):
            self.fail(f"{value!r} is a folder; name a file in it.", param, ctx)
        return super().convert(value, param, ctx)


class Picture(OutputFile):
    """A file for a picture, whose ending says in which format."""

    name = "picture"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The path, or a refusal where it is a folder or its ending is that of no picture."""
        path = super().convert(value, param, ctx)
        if Path(str(path)).suffix.lower() not in _PICTURES:
            self.fail(f"{value!r} must end with {', '.join(_PICTURES[:-1])} or {_PICTURES[-1]}.", param, ctx)
        return path


def given_quantity(text: str, unit: str, what: str, sign: Sign = "any") -> float:
    """A text such as 45deg or "51.3 N.m/deg" in an SI unit; BadParameter where it has no unit or is none.

    what: whose value it is, the subject of the refusal. Only a unit that is written down is believed.
    """
    from ..scene.units import QUANTITY, UNITS, to_si  # takes its time, which --help need not

    found = QUANTITY.fullmatch(text)
    number, given = found.groups() if found is not None else ("1", "")
    if given not in UNITS[unit]:
        example = " or ".join(f"{number}{known}" for known in UNITS[unit])
        raise click.BadParameter(f"{what} is {text!r}; give it with its unit: {example}")
    try:
        return to_si(f"{number} {given}", unit, sign)
    except ValueError as error:
        raise click.BadParameter(f"{what} {error}") from None
