"""What a study varies: keys of a scene that take one drawn value together, or their own values times it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from components.contract.errors import nearest

from ...scene.layers import Tree
from ...scene.temperature import is_measured
from ...scene.units import QUANTITY
from .distributions import Distribution, StudyError, distribution

Settings = dict[str, object]


@dataclass(frozen=True, slots=True)
class Varied:
    """Keys of a scene and the distribution of the value that all of them get; factor: of the value that they have."""

    keys: tuple[str, ...]
    distribution: Distribution
    factor: bool

    @property
    def name(self) -> str:
        """What it is called in tables and pictures."""
        return ",".join(self.keys) + ("*" if self.factor else "")

    @property
    def text(self) -> str:
        """As it is written, KEY[,KEY...]=DISTRIBUTION or KEY[,KEY...]*=DISTRIBUTION."""
        return f"{self.name}={self.distribution.text}"

    def settings(self, tree: Tree, value: float) -> Settings:
        """The settings that a drawn value means; tree: the scene without them. StudyError where it cannot be scaled."""
        if not self.factor:
            return written_to(self.keys, value, self.distribution.unit)
        return multiplied(tree, self.keys, value)


def all_varied(vary: Mapping[str, str] | Sequence[str]) -> tuple[Varied, ...]:
    """What distributions by key, or texts of `varied`, mean."""
    texts = [f"{key}={text}" for key, text in vary.items()] if isinstance(vary, Mapping) else vary
    return tuple(map(varied, texts))


def varied(text: str) -> Varied:
    """What KEY=DISTRIBUTION or KEY*=DISTRIBUTION means, with keys between commas; StudyError where it means nothing."""
    left, equals, right = text.partition("=")
    keys, factor = keys_of(left)
    if any(key.endswith("*") for key in keys):
        raise StudyError(f"{text!r}: * stands once, behind the last key, and multiplies all of them")
    if not equals or not all(keys):
        raise StudyError(f"{text!r} is not of the form KEY=DISTRIBUTION or KEY*=DISTRIBUTION")
    found = distribution(right.strip())
    if factor and found.unit:
        raise StudyError(f"{text!r}: a factor has no unit")
    return Varied(keys, found, factor)


def keys_of(text: str) -> tuple[tuple[str, ...], bool]:
    """Keys of KEY, KEY,KEY or KEY*, and whether they are multiplied."""
    text = text.rstrip()
    return tuple(key.strip() for key in text.removesuffix("*").split(",")), text.endswith("*")


def written_to(keys: Sequence[str], value: float, unit: str) -> Settings:
    """Settings that give all keys one value."""
    return dict.fromkeys(keys, _written(value, unit))


def multiplied(tree: Tree, keys: Sequence[str], factor: float) -> Settings:
    """Settings that multiply what a scene has under keys; StudyError where it cannot be scaled."""
    return {key: _scaled(key, _to_scale(tree, key), factor) for key in keys}


def own_value(value: object) -> tuple[float, str] | None:
    """What a scene has as a number, with its unit where it has one; None for what is none."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    found = QUANTITY.fullmatch(str(value))
    return None if found is None else (float(found[1]), found[2])


def _written(value: float, unit: str) -> float | str:
    """As scenes take it; whole numbers stay whole, as counts must be."""
    if unit:
        return f"{value!r} {unit}"
    return int(value) if value.is_integer() else value


def _to_scale(tree: Tree, key: str) -> object:
    """What a scene has under a key; StudyError where it has nothing."""
    found = value_at(tree, key)
    if found is None:
        raise StudyError(
            f"{key}: the scene has no value there to multiply{meant(tree, key)}; give it one, or vary it without *"
        )
    own = own_value(found)
    if own is not None and own[0] == 0.0:
        raise StudyError(f"{key}: the scene has {found!r} there, which no factor changes; vary it without *")
    return found


def value_at(tree: Tree, key: str) -> object:
    """What a scene has under a key, None for nothing; a step into an array of tables is the name of an entry."""
    found: object = tree
    for step in key.split("."):
        if isinstance(found, Mapping):
            found = found.get(step)
        elif isinstance(found, Sequence) and not isinstance(found, str):
            named = (one for one in found if isinstance(one, Mapping) and one.get("name") == step)
            found = next(named, None)
        else:
            return None
    return found


def meant(tree: Tree, key: str) -> str:
    """A question for the nearest key that has a value, where there is one that looks alike."""
    near = nearest(key, list(keys_in(tree)))
    return f" (did you mean {near}?)" if near else ""


def keys_in(found: object, before: str = "") -> Iterator[str]:
    """All keys below that have a value, as `value_at` takes them."""
    if isinstance(found, Mapping):
        for step, below in found.items():
            yield from keys_in(below, f"{before}{step}.")
    elif isinstance(found, list) and any(isinstance(one, Mapping) for one in found):
        for one in found:
            if isinstance(one, Mapping) and "name" in one:
                yield from keys_in(one, f"{before}{one['name']}.")
    else:
        yield before.removesuffix(".")


def _scaled(key: str, value: Any, factor: float) -> object:  # noqa: ANN401 - any value of a tree
    """Times a factor: a number, a text with a unit, a list or columns of them; StudyError for anything else."""
    if isinstance(value, bool):
        raise StudyError(f"{key}: {value} cannot be multiplied")
    if isinstance(value, int | float):
        return factor * value
    if isinstance(value, list):
        return [_scaled(key, one, factor) for one in value]
    if is_measured(value):
        return {**value, "value": _scaled(key, value["value"], factor)}
    parts = QUANTITY.fullmatch(value) if isinstance(value, str) else None
    if parts is None:
        raise StudyError(
            f"{key}: {value!r} is no number to multiply; name the numbers within it by their keys"
        )
    return f"{factor * float(parts[1])!r} {parts[2]}"
