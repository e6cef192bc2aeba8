"""An earlier result where a run is to write: it gives way to a run of the same settings, and to no other.

A result says what it was made with: its scene with all layers merged, and the settings of its run. A file that does
not say so is lost only where that is asked for.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import h5py

from .differences import JUDGING, leaves
from .parts import json_of
from .result import HDF5_ERRORS, ResultError

SETTINGS, _TREE = "settings", "scene_tree"
"""Texts of the provenance: what a run was asked for, and its scene, as JSON."""
_TOLD = 3
"""Differences that a sentence has room for."""
WAY_OUT = "name another file (--output), or allow its loss by --replace (replace=True)"


def settings_text(settings: Mapping[str, object]) -> str:
    """As the provenance has them."""
    return json.dumps(settings)


def refuse_to_lose(path: Path, tree: Mapping[str, object], settings: Mapping[str, object]) -> None:
    """ResultError where a file is no result of this scene and these settings, and would be lost to a run of them.

    path: one that `refuse_to_replace` accepts. tree: of the scene, with all layers merged. A result without rows is
    nothing to lose.
    """
    if not path.is_file() or not path.stat().st_size:
        return
    try:
        with h5py.File(path, "r") as file:
            if not len(file["time"]):
                return
            before = {name: _text(file, name) for name in (_TREE, SETTINGS)}
    except HDF5_ERRORS:
        raise ResultError(f"{path}: this file is damaged and cannot be compared; {WAY_OUT}") from None
    if not all(before.values()):
        raise ResultError(f"{path}: this result does not say what it was made with; {WAY_OUT}")
    now = {_TREE: json.dumps(tree), SETTINGS: settings_text(settings)}
    if sentence := unlike(path, _leaves(before), _leaves(now)):
        raise ResultError(sentence)


def unlike(path: Path, before: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Why a file stays: by key, what it was made with and what is asked for now differ; empty where they do not."""
    differing = [
        f"{key} {before.get(key, '-')} instead of {now.get(key, '-')}"
        for key in dict.fromkeys((*before, *now))
        if before.get(key) != now.get(key)
    ]
    if not differing:
        return ""
    more = f" and {len(differing) - _TOLD} more" if len(differing) > _TOLD else ""
    told = ", ".join(differing[:_TOLD])
    return f"{path}: this file was made with other settings, {told}{more}. It stays: {WAY_OUT}"


def _text(file: h5py.File, name: str) -> str:
    """A text of the provenance, empty where there is none."""
    found = file["provenance"].get(name)
    return "" if found is None else str(found.asstr()[()])


def _leaves(texts: Mapping[str, str]) -> dict[str, str]:
    """Every setting and every value of the scene by its key."""
    every = {key: text for name in (SETTINGS, _TREE) for key, text in leaves("", json_of(texts[name]))}
    return {key: text for key, text in every.items() if not key.startswith(JUDGING)}
