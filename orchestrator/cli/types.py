"""Types of option values: numbers with units in a range, counts, lists of numbers, names, files of pictures."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
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
        return "" if high is None else f"x<={short(high)}"
    if high is None:
        return f"x{'>' if low_open else '>='}{short(low)}"
    return f"{short(low)}{'<' if low_open else '<='}x<={short(high)}"


def short(number: float) -> str:
    """In as few characters as it takes: 1e-7, not 1e-07."""
    return re.sub(r"e\+?(-?)0*", r"e\1", f"{number:g}")


class Number(click.FloatRange):
    """A number in a range, plain or with its unit, such as 8ms; "nan" and "inf" are none.

    Angles and stiffnesses of hinges need their unit. words: texts that are accepted as they are.
    """

    name = "number"

    def __init__(self, unit: str = "1", words: Sequence[str] = (), **bounds: Any) -> None:  # noqa: ANN401 - of click
        super().__init__(**bounds)
        self._unit, self._words = unit, words

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The number in its SI unit, a word, or click's own refusal."""
        from ..scene.units import QUANTITY, UNITS, to_si  # takes its time, which --help need not

        if value in self._words:
            return value
        if isinstance(value, str) and "rad" in self._unit:
            value = given_quantity(value, self._unit, "it")
        elif (
            isinstance(value, str) and (found := QUANTITY.fullmatch(value)) and found[2] in UNITS[self._unit]
        ):
            try:
                value = to_si(f"{found[1]} {found[2]}", self._unit)
            except ValueError as error:
                self.fail(f"{value!r}: it {error}.", param, ctx)
        number = super().convert(value, param, ctx)
        return number if isfinite(number) else self.fail(f"{value} is not a finite number.", param, ctx)

    def _describe_range(self) -> str:
        return _range(self.min, self.max, self.min_open)


class Count(click.IntRange):
    """A whole number in a range."""

    name = "integer"

    def _describe_range(self) -> str:
        return _range(self.min, self.max, self.min_open)


class Several(click.ParamType[Any]):
    """Values of one type with commas between."""

    def __init__(self, kind: click.ParamType[Any]) -> None:
        self.name, self._kind = kind.name, kind

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The values, or a refusal."""
        given = value.split(",") if isinstance(value, str) else value
        return tuple(self._kind.convert(one, param, ctx) for one in given)


class Choice(click.Choice[str]):
    """One of some words, each of which stands for a value."""

    def __init__(self, values: Mapping[str, object]) -> None:
        super().__init__([*values])
        self._values = values

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The value, or click's own refusal."""
        return value if value in self._values.values() else self._values[super().convert(value, param, ctx)]


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


def ordered_names(_: click.Context, __: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    """Names with commas between, in their order, of an option that may be given several times."""
    return tuple(name.strip() for value in values for name in value.split(",") if name.strip())


def names_given(
    context: click.Context, param: click.Parameter, values: tuple[str, ...]
) -> tuple[str, ...] | None:
    """Names of an option where leaving it out is not the same as naming none."""
    if values and not (found := ordered_names(context, param, values)):
        raise click.BadParameter("give names, separated by commas, or all or none", param=param)
    return found if values else None


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
