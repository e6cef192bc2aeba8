"""Measured columns over the temperature: `{ temperature = [...], value = [...] }` in place of a value of a scene.

The temperature of the scene chooses the value, linearly between two columns, never beyond them. Values are numbers,
texts with one unit, or lists of these, such as the torques of a table.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from .layers import Tree
from .units import QUANTITY, kelvin

_COLUMNS = {"temperature", "value"}
_LEAST = 2


def is_measured(value: object) -> bool:
    """Whether a value of a scene is a table of columns over the temperature."""
    return isinstance(value, dict) and value.keys() == _COLUMNS


def at_temperature(tree: Tree, scene: Mapping[str, Any] | None = None) -> tuple[Tree, list[str]]:
    """The tree with values in place of all columns, and what is wrong with columns, which give their first value.

    scene: the table with the temperature; by default that of the tree.
    """
    header = tree.get("scene") if scene is None else scene
    given = header.get("temperature") if isinstance(header, Mapping) else None
    problems: list[str] = []
    found = {key: _chosen(one, given, key, problems) for key, one in tree.items()}
    try:
        kelvin(given)
    except ValueError:
        return found, [] if given is not None else problems  # the table [scene] says what is wrong
    return found, problems


def _chosen(value: Any, given: object, key: str, problems: list[str]) -> Any:  # noqa: ANN401 - any part of a tree
    if is_measured(value):
        try:
            return _at(value["temperature"], value["value"], given)
        except ValueError as error:
            problems.append(f"{key}: {error}")
            values = value["value"]
            return values[0] if isinstance(values, list) and values else values
    if isinstance(value, dict):
        return {name: _chosen(one, given, f"{key}.{name}", problems) for name, one in value.items()}
    if isinstance(value, list):
        names = [one.get("name", k + 1) if isinstance(one, dict) else k + 1 for k, one in enumerate(value)]
        return [
            _chosen(one, given, f"{key}.{name}", problems) for name, one in zip(names, value, strict=True)
        ]
    return value


def _at(columns: object, values: object, given: object) -> Any:  # noqa: ANN401 - any value of a tree
    """The value at a temperature; ValueError with a sentence where there is none."""
    if not isinstance(columns, list) or not isinstance(values, list) or len(columns) != len(values):
        raise ValueError("give lists temperature and value of one length")
    places = [_kelvin("temperature", one) for one in columns]
    if len(places) < _LEAST or any(b <= a for a, b in pairwise(places)):
        raise ValueError("give two or more temperatures, increasing")
    if given is None:
        raise ValueError('has values by temperature; set temperature in [scene], such as "-30 C"')
    place = _kelvin("scene.temperature", given)
    if not places[0] <= place <= places[-1]:
        raise ValueError(
            f"has values from {columns[0]} to {columns[-1]}, and scene.temperature is {given}; choose one between them"
        )
    k = min(bisect_right(places, place), len(places) - 1) - 1
    return _between(values[k], values[k + 1], (place - places[k]) / (places[k + 1] - places[k]))


def _kelvin(key: str, value: object) -> float:
    try:
        return kelvin(value)
    except ValueError as error:
        raise ValueError(f"{key} {error}") from None


def _between(low: Any, high: Any, share: float) -> Any:  # noqa: ANN401 - any value of a tree
    """Linear interpolation of numbers, texts with one unit, or lists of these."""
    if isinstance(low, list) and isinstance(high, list) and len(low) == len(high):
        return [_between(a, b, share) for a, b in zip(low, high, strict=True)]
    first, last = (QUANTITY.fullmatch(str(one)) for one in (low, high))
    if (
        first is None
        or last is None
        or first[2] != last[2]
        or isinstance(low, str) != isinstance(high, str)
        or isinstance(low, bool | list)
    ):
        raise ValueError(
            f"has values {low!r} and {high!r}; give numbers, texts with one unit, or lists of these"
        )
    number = float(first[1]) * (1.0 - share) + float(last[1]) * share
    return f"{number!r} {first[2]}".strip() if isinstance(low, str) else number
