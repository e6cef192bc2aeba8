"""Parts of a result file, each read and checked: whatever is not as it was written is a ValueError in words."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract.roles import LOAD

from ..assembly import Geometry, HingeLine

Vector = NDArray[np.float64]
Event = tuple[float, str, str]
Scalar = float | int | str
MESSAGES = "messages"
"""The text of the provenance that holds the messages of a run, as JSON."""

ESTIMATED_ERRORS = "estimated_errors"
"""Group with the estimated errors of headline numbers."""


class Meaning(NamedTuple):
    """What a signal means: unit in FMI syntax, a sentence, and its role, see `components.contract.roles`."""

    unit: str
    description: str
    role: str = ""

    def attributes(self) -> dict[str, str]:
        """By name, as files have them; no role where there is none."""
        return {name: text for name, text in self._asdict().items() if text or name != "role"}


_LARGEST: Final = 1e100
"""Beyond it squares overflow, and no quantity of a deployment is."""
_SIZES: Final = {
    "interface_force": 3, "interface_torque": 3, "frame_position": 3, "frame_orientation": 4, "attitude": 3,
    "attitude_rate": 3, "reaction_force": 3, "reaction_torque": 3, "hinge_force": 3, "hinge_torque": 3,
}  # fmt: skip
"""Columns of the vectors that pictures and key figures are made of, by the names behind that of a port."""
_SCALARS: Final = (
    "torque", "energy", "force", "angle", "rate", "tension", "tension_a", "tension_b", "step_size", "iterations",
    "numerical_dissipation", "residual",
)  # fmt: skip
"""Endings of the names of the scalars that they are made of, unless they are among the vectors.

Loads may have three axes, but for those of contacts, which are looked at touch by touch.
"""
_OF_ELEMENTS: Final = ("section_force",)
"""Names that end like those of scalars and hold three numbers of every element of a beam."""


def times(file: Any) -> Vector:  # noqa: ANN401
    """Times of the rows that every signal has; fewer than some have where a run was interrupted."""
    lengths = [d.shape[0] for group in file["signals"].values() for d in group.values()]
    found = _numbers(file["time"][: min(lengths, default=None)], "time", 1)
    missing = np.flatnonzero(np.isnan(found))
    found = found[: missing[0]] if missing.size else found
    _refuse(not np.all(np.abs(found) < _LARGEST), "its times are not finite")
    _refuse(bool(np.any(np.diff(found) < 0.0)), "its times run back")
    return found


def ends_alike(file: Any, expected: Vector) -> bool:  # noqa: ANN401
    """Whether a file has the last of these times (N,) in its place, as it has unless another was written there."""
    found = file["time"]
    return bool(len(found) >= expected.size and found[expected.size - 1] == expected[-1])


def signal(dataset: Any, variable: str, rows: int) -> Vector:  # noqa: ANN401
    """Values of a signal at so many rows, (N,) or (N, size)."""
    _refuse(np.ndim(dataset) not in (1, 2), f"{variable} has {np.ndim(dataset)} dimensions")
    found = _numbers(dataset[:rows], variable, np.ndim(dataset))
    _refuse(len(found) < rows, f"{variable} has {len(found)} rows of {rows}")
    _refuse(
        not np.all(np.abs(found) < _LARGEST),
        f"{variable} has values that are no numbers, or beyond all bounds",
    )
    size = _SIZES.get(variable.rpartition(".")[2])
    if size is not None:
        _refuse(found.shape != (rows, size), f"{variable} must have {size} columns")
    elif variable.endswith(_SCALARS) and variable not in _OF_ELEMENTS:
        of_axes = found.shape[1:] == (3,) and variable != "contact_force"
        is_load = dataset.attrs.get("role") == LOAD
        _refuse(found.ndim != 1 and not (of_axes and is_load), f"{variable} must be one number a row")
    return found


def events(folder: Any) -> list[Event]:  # noqa: ANN401
    """Time (s), component and text of every event; what is not printable is shown as its code."""
    components, texts = folder["component"].asstr()[:], folder["event"].asstr()[:]
    when = _numbers(folder["time"][:], "events", 1)
    _refuse(not np.all(np.abs(when) < _LARGEST), "the times of its events are not finite")
    rows = zip(when.tolist(), components, texts, strict=False)
    return [(time, printable(str(name)), printable(str(words))) for time, name, words in rows]


def estimated_errors(file: Any) -> dict[tuple[str, str], float] | None:  # noqa: ANN401
    """Estimated errors of headline numbers by quantity and component; None where the file has none."""
    if ESTIMATED_ERRORS not in file:
        return None
    folder = file[ESTIMATED_ERRORS]
    quantities, components = folder["quantity"].asstr()[:], folder["of"].asstr()[:]
    found = _numbers(folder["error"][:], "the estimated errors", 1)
    _refuse(not np.all(found >= 0.0), "its estimated errors are no numbers")
    keys = zip(map(printable, quantities), map(printable, components), strict=True)
    return dict(zip(keys, found.tolist(), strict=True))


def text(dataset: Any) -> str:  # noqa: ANN401
    """A text; what is not printable is shown as its code."""
    return printable(str(dataset.asstr()[()]))


def scalar(value: Any) -> Scalar:  # noqa: ANN401
    """A number or text about the run."""
    found = value.item() if isinstance(value, np.generic) else value
    _refuse(
        not isinstance(found, int | float | str),
        f"a statistic is {type(found).__name__}, no number and no text",
    )
    return printable(found) if isinstance(found, str) else found


def catalogue(component: str, group: Any) -> dict[str, Meaning]:  # noqa: ANN401
    """What the signals of a component mean, by their names."""
    for name in (component, *group):
        _refuse(not name.isprintable(), f"the name {name!r} is not printable")
    return {
        name: Meaning(*(printable(str(d.attrs.get(key, ""))) for key in Meaning._fields))
        for name, d in group.items()
    }


def noun(group: Any) -> str:  # noqa: ANN401
    """What people call a component."""
    return printable(str(group.attrs.get("noun", "")))


def geometry(file: Any, name: str) -> Geometry:  # noqa: ANN401
    """Nodes, shapes and faces of a body, which fit each other and its modal coordinates."""
    group, own = file["geometry"][name], file["signals"].get(name, {})
    positions, shapes = _numbers(group["positions"][:], name, 2), _numbers(group["shapes"][:], name, 3)
    faces = np.asarray(group["faces"][:])
    modes = int(np.prod(own["modal_coordinate"].shape[1:])) if "modal_coordinate" in own else shapes.shape[2]
    nodes = len(positions)
    fits = positions.shape == (nodes, 3) and shapes.shape == (nodes, 3, modes) and faces.ndim == 2
    _refuse(not name.isprintable() or not fits, f"the geometry of {name!r} does not fit together")
    _refuse(not np.all(np.abs(positions) < _LARGEST), f"the geometry of {name} is not finite")
    _refuse(not np.all(np.abs(shapes) < _LARGEST), f"the geometry of {name} is not finite")
    inside = (
        faces.dtype.kind in "iu" and faces.shape[1:] == (4,) and bool(np.all((faces >= 0) & (faces < nodes)))
    )
    _refuse(not inside, f"the faces of {name} are not those of its nodes")
    return Geometry(positions, shapes, faces.astype(np.int64))


def hinge_lines(dataset: Any) -> tuple[HingeLine, ...]:  # noqa: ANN401
    """The hinge lines, which are JSON."""
    listed = json.loads(text(dataset))
    _refuse(not isinstance(listed, list), "its hinge lines are no list")
    return tuple(_hinge_line(fields) for fields in listed)


def _hinge_line(fields: Mapping[str, Any]) -> HingeLine:
    sequences = {key: tuple(fields.get(key, ())) for key in ("hinges", "parts", "axis", "known", "tapes")}
    coupled = tuple(fields.get("coupled", ()))
    _refuse(any(np.shape(one) != (2,) for one in coupled), "a hinge line is not as it was written")
    line = HingeLine(**{**fields, **sequences, "coupled": tuple((name, rate) for name, rate in coupled)})
    texts = (
        line.name,
        line.sensor,
        *line.hinges,
        *line.parts,
        *line.tapes,
        *(name for name, _ in line.coupled),
    )
    angle = line.deployed_angle
    sound = all(isinstance(one, str) for one in texts) and all(
        isinstance(one, bool) for one in (line.latches, line.kinematic)
    )
    _refuse(
        not sound
        or not all(
            isinstance(one, float | int) for one in (*line.axis, *line.known, *(r for _, r in line.coupled))
        )
        or len(line.known) not in (0, 2)
        or not all(one is None or isinstance(one, float | int) for one in (angle, line.inertia)),
        "a hinge line is not as it was written",
    )
    return line


def json_of(words: str) -> object:
    """What a text of the provenance holds; nothing where it is not JSON."""
    try:
        return json.loads(words)
    except (ValueError, RecursionError):
        return None


def sentences_of(words: str) -> tuple[str, ...]:
    """The sentences that a text of the provenance holds, for people; none where it holds something else."""
    found = json_of(words)
    return tuple(printable(one) for one in found if isinstance(one, str)) if isinstance(found, list) else ()


def printable(words: str) -> str:
    """A text that a terminal shows and does not obey: control characters as their codes, line ends as they are."""
    return "".join(c if c.isprintable() or c in "\n\t" else ascii(c)[1:-1] for c in words)


def _numbers(values: Any, what: str, dimensions: int) -> Vector:  # noqa: ANN401
    """Values as floating-point numbers of so many dimensions."""
    found = np.asarray(values)
    _refuse(found.dtype.kind not in "fiu" or found.ndim != dimensions, f"{what} is no array of numbers")
    return found.astype(np.float64)


def _refuse(wrong: bool, words: str) -> None:
    if wrong:
        raise ValueError(words)
