"""Differences between two runs: scene, fidelities, settings, values of the scene."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from .parts import json_of
from .result import Result

_SHOWN = 2
"""Differences in a label."""
_SETTINGS = ("master", "order", "step", "tolerance", "until")
JUDGING = "requirements."
"""Keys of a scene that judge a run and do not change it begin so."""
_DESCRIPTIVE = ("scene.description", "scene.name")


class Difference(NamedTuple):
    """A key of the scene or the run, and its text in both; empty where one has none."""

    key: str
    a: str
    b: str


def differences(a: Result, b: Result) -> list[Difference]:
    """What differs: bodies that are flexible, settings of the run, then values of the scenes by their keys."""
    first, second = _asked_for(a), _asked_for(b)
    keys = dict.fromkeys((*first, *second))
    return [
        Difference(key, first.get(key, ""), second.get(key, ""))
        for key in keys
        if first.get(key, "") != second.get(key, "")
    ]


def scene_note(a: Result, b: Result) -> str:
    """A sentence where two results are of different scenes; empty where they are of one, perhaps in two variants."""
    scenes = [result.provenance.get("scene", "") for result in (a, b)]
    if scenes[0] != scenes[1]:
        return (
            f"A is a run of the scene {scenes[0]!r}, B of {scenes[1]!r}: ratios compare different structures."
        )
    lines = [sorted(line.name for line in result.hinge_lines) for result in (a, b)]
    if lines[0] != lines[1]:
        both = " and ".join(", ".join(names) or "none" for names in lines)
        return f"A and B have different hinge lines, {both}: ratios compare different structures."
    return ""


def distinctions(a: Result, b: Result) -> tuple[str, str]:
    """Short labels of what differs; empty if nothing does, or the scenes differ."""
    found = differences(a, b)
    if not found or scene_note(a, b):
        return "", ""
    more = f", {len(found) - _SHOWN} more" if len(found) > _SHOWN else ""
    texts = [
        ", ".join(f"{one.key} {text or '-'}" for one in found[:_SHOWN] for text in (one[k],)) for k in (1, 2)
    ]
    return texts[0] + more, texts[1] + more


def _asked_for(result: Result) -> dict[str, str]:
    """Texts by key."""
    known = result.provenance
    found = {}
    for fidelity in ("flexible", "large_deformation"):
        names = json_of(known.get(fidelity, "[]"))
        found[fidelity] = ", ".join(map(str, names)) or "none" if isinstance(names, list) else ""
    found |= {name: known[name] for name in _SETTINGS if name in known}
    tree = json_of(known.get("scene_tree", "{}"))
    found |= {
        key: text for key, text in leaves("", tree) if key not in _DESCRIPTIVE and not key.startswith(JUDGING)
    }
    return {
        key: text for key, text in found.items() if not key.startswith("scene.") or key[6:] not in _SETTINGS
    }


def leaves(key: str, value: object) -> Iterator[tuple[str, str]]:
    """Texts of all values of a tree by their dotted keys; entries of arrays by name."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from leaves(f"{key}.{name}" if key else str(name), inner)
    elif isinstance(value, list) and value and all(isinstance(entry, Mapping) for entry in value):
        for k, entry in enumerate(value):
            yield from leaves(f"{key}.{entry.get('name', k)}", entry)
    else:
        yield key, value if isinstance(value, str) else json.dumps(value)
