"""Keys of a scene that slide, and between which values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase

from components import FanfoldError

from ...scene.layers import Tree
from ...scene.units import QUANTITY
from ..sampling.varied import Settings, keys_in, keys_of, meant, multiplied, own_value, value_at, written_to

_USUAL = ("friction.coefficient", "damper.*.damping_coefficient", "hinge_line.*.latch.stiffness")
"""Keys that slide by default, besides the torques of each motor together: what drives, what brakes, what stops."""
_MOTOR = re.compile(r"(hinge_line\..+\.motor)\.(?:stowed|deployed|torque|closing_torque)")
_FORM = re.compile(r"\s*(\S+?)\s*=\s*(.+?)\s*\.\.\s*(.+?)\s*")
_EXAMPLE = "'hinge_line.HL1.motor.stowed=1.2..2.4 N.m'"


class LiveError(FanfoldError):
    """A live page that cannot be made, with what is wrong and what to do."""


@dataclass(frozen=True, slots=True)
class Slider:
    """Keys of a scene that get one value, or their own values times it, between low and high; start: that of the scene.

    unit: of scenes; empty for plain numbers and factors. is_chosen: whether somebody named it; a usual one may be left
    out.
    """

    keys: tuple[str, ...]
    factor: bool
    low: float
    high: float
    start: float
    unit: str = ""
    is_chosen: bool = True

    @property
    def name(self) -> str:
        """As it is written before the range."""
        return ",".join(self.keys) + ("*" if self.factor else "")

    @property
    def label(self) -> str:
        """For people; of several keys of a table that table with their last parts."""
        tables = {key.rpartition(".")[0] for key in self.keys}
        if len(self.keys) > 1 and len(tables) == 1:
            text = f"{tables.pop()} ({', '.join(key.rpartition('.')[2] for key in self.keys)})"
        else:
            text = ", ".join(self.keys)
        return f"{text}, factor" if self.factor else text

    @property
    def title(self) -> str:
        """Short name for a page: of a component and what of it slides, without the table that it is in."""
        texts = dict.fromkeys(_words(key.rpartition(".")[0]) for key in self.keys)
        last = (key.rpartition(".")[2].replace("_", " ") for key in self.keys)
        return f"{', '.join(texts)} {' and '.join(dict.fromkeys(last))}".strip()

    @property
    def shown_unit(self) -> str:
        """Unit for a page, where a factor is one of the values in the scene."""
        return "times" if self.factor else self.unit

    def settings(self, tree: Tree, value: float) -> Settings:
        """What gives the keys of a scene's tree a value."""
        return multiplied(tree, self.keys, value) if self.factor else written_to(self.keys, value, self.unit)

    def text(self, value: float) -> str:
        """A value with its unit."""
        return f"{value:g} {self.unit}".rstrip()

    def between(self, low: float, high: float) -> Slider:
        """The same over another range."""
        return replace(self, low=low, high=high)


def _words(table: str) -> str:
    """Name of a table without the kind of components it is one of, such as "HL1 motor" of hinge_line.HL1.motor."""
    kind, dot, rest = table.partition(".")
    return (rest if dot else kind).replace(".", " ").replace("_", " ")


def slider(text: str, tree: Tree) -> Slider:
    """What KEY[,KEY...]=LOW..HIGH UNIT, or KEY*=LOW..HIGH for a factor, means in a scene; LiveError for nothing."""
    parts = _FORM.fullmatch(text)
    ends = [QUANTITY.fullmatch(part) for part in parts.groups()[1:]] if parts else []
    numbers = [(float(end[1]), end[2]) for end in ends if end]
    if parts is None or len(numbers) != 2:
        raise LiveError(f"{text!r} is not of the form KEY=LOW..HIGH UNIT, such as {_EXAMPLE}")
    (low, first_unit), (high, unit) = numbers
    keys, factor = keys_of(parts[1])
    own = [own_value(value_at(tree, key)) for key in keys]
    for key, found in zip(keys, own, strict=True):
        if value_at(tree, key) is None or (found is None and not factor):
            raise LiveError(
                f"{key}: the scene has no number there{meant(tree, key)}; name a key that has one in it"
            )
    start, own_unit = own[0] if own[0] and not factor else (1.0, "")
    if first_unit not in ("", unit) or own_unit != unit:
        wanted = "a plain number" if not own_unit else f"{own_unit}, as in the scene"
        raise LiveError(f"{text!r}: give the range in {wanted}")
    if not (low < high and low <= start <= high):
        value = f"{start:g} {unit}".rstrip()
        raise LiveError(f"{text!r}: the range must rise and contain the value of the scene, which is {value}")
    return Slider(keys, factor, low, high, start, unit)


def sliders(texts: Sequence[str], tree: Tree) -> list[Slider]:
    """Those that are named, or else the usual ones that a scene has, from half to twice what they are."""
    return [slider(text, tree) for text in texts] or list(_usual(tree))


def _usual(tree: Tree) -> Iterator[Slider]:
    motors: dict[str, list[str]] = {}
    for key in keys_in(tree):
        if found := _MOTOR.fullmatch(key):
            motors.setdefault(found[1], []).append(key)
    for keys in motors.values():
        yield Slider(tuple(keys), True, 0.5, 2.0, 1.0, is_chosen=False)
    for key in keys_in(tree):
        own = own_value(value_at(tree, key))
        if own and own[0] > 0.0 and any(fnmatchcase(key, pattern) for pattern in _USUAL):
            yield Slider((key,), False, 0.5 * own[0], 2.0 * own[0], own[0], own[1], is_chosen=False)
