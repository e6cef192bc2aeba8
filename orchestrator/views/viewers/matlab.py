"""Signals, events and modes as a file of MATLAB (version 5, which Octave and SciPy read too)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ...assembly import Geometry
from ...results.result import Result, ResultError
from .output import whole
from .signals import Chosen

_LONGEST = 63
"""Characters of a name in MATLAB."""
_KEYWORDS = (
    "break", "case", "catch", "classdef", "continue", "else", "elseif", "end", "for", "function", "global", "if",
    "otherwise", "parfor", "persistent", "return", "spmd", "switch", "try", "while",
)  # fmt: skip
_LARGEST = 2**31 - 2**24
"""Bytes of one variable in version 5, less room for the names within."""


def write_mat(path: Path, found: Chosen) -> None:
    """Write the structs signals, units, names, events, modes, run and the column time (N, 1) in s."""
    result = found.result
    columns = {key: _column(found.values(key)) for key in found.keys}
    size = sum(values.nbytes for values in columns.values())
    if size > _LARGEST:
        raise ResultError(
            f"{path}: the signals are {size / 1e9:.1f} GB, and a variable of a .mat file holds 2; choose fewer "
            "signals, or rows farther apart (every)"
        )
    signals, units, names = {}, {}, {}
    variables = _by_component(found)
    for component, field in valid_names(variables).items():
        fields = valid_names(variables[component])
        keys = {name: (component, variable) for variable, name in fields.items()}
        signals[field] = {name: columns[key] for name, key in keys.items()}
        units[field] = {name: result.unit(*key) for name, key in keys.items()}
        names[field] = {name: ".".join(key) for name, key in keys.items()}
    content: dict[str, Any] = {
        "time": _column(found.time),
        "signals": signals,
        "units": units,
        "names": names,
        "events": _events(result),
        "modes": _modes(result.geometry),
        "run": _run(result),
    }
    with whole(path) as part:
        scipy.io.savemat(
            part, content, appendmat=False, long_field_names=True, do_compression=True, oned_as="column"
        )


def valid_names(names: Iterable[str]) -> dict[str, str]:
    """A name that MATLAB allows for each, no two alike: letters, digits and low lines, a letter first."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
        if plain in _KEYWORDS or not re.match(r"[A-Za-z]", plain):
            plain = f"x{plain}"
        unique, count = plain[:_LONGEST], 1
        while unique in taken:
            count += 1
            unique = f"{plain[: _LONGEST - len(str(count)) - 1]}_{count}"
        taken.add(unique)
        found[name] = unique
    return found


def _by_component(found: Chosen) -> dict[str, list[str]]:
    variables: dict[str, list[str]] = {}
    for component, variable in found.keys:
        variables.setdefault(component, []).append(variable)
    return variables


def _column(values: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    return values[:, None] if values.ndim == 1 else values


def _events(result: Result) -> dict[str, Any]:
    """Times (k, 1) in s, and cells of texts (k, 1)."""
    times, components, texts = zip(*result.events, strict=True) if result.events else ((), (), ())
    return {
        "time": _column(np.array(times, dtype=float)),
        "component": _cells(components),
        "event": _cells(texts),
    }


def _cells(texts: Iterable[str]) -> np.ndarray[Any, np.dtype[np.object_]]:
    return np.array(list(texts), dtype=object).reshape(-1, 1)


def _modes(geometry: Mapping[str, Geometry]) -> dict[str, Any]:
    """By body: nodes (D, 3) m and shapes (D, 3, M) in its frame, faces (F, 4) counted from 1."""
    return {
        field: {
            "positions": np.asarray(geometry[body].positions),
            "shapes": np.asarray(geometry[body].shapes),
            "faces": np.asarray(geometry[body].faces) + 1.0,
        }
        for body, field in valid_names(geometry).items()
    }


def _run(result: Result) -> dict[str, Any]:
    """What the result is of, and whether the run came to its end."""
    known = {name: result.provenance.get(name, "") for name in ("scene", "fanfold", "date")}
    return {**known, "complete": float(result.complete)}
