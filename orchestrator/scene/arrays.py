"""[[array]]: bodies and connections written once, repeated around an axis, with their number in their names."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from components.contract.frames import Quaternion, Vector3, exponential, rotate, scaled

from .body_tables import Motion
from .layers import Tree
from .table import Axis, Name, Table
from .units import to_si
from .validation import EntryReader

_MOTION_AXES = {
    f"{kind}_axis": list(Motion.model_fields[f"{kind}_axis"].default) for kind in ("translation", "rotation")
}
_PARTS = ("body", "connection", "hinge_line", "ccl", "damper")


def _entries(value: object) -> object:
    if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
        raise ValueError("is no array of tables")
    return value


_Entries = Annotated[tuple[dict[str, Any], ...], BeforeValidator(_entries)]


class Array(Table):
    """[[array]]: count copies, each turned by a further share of a full turn about an axis.

    In every text {i} is the number of the copy, from 1, and {next} that of the one after it, the first after the last.
    Turned are the places of bodies, that is their offset and orientation, the axes of their motions, and the axes of
    connections; points of other bodies are those that the texts name. A hinge line puts its outboard body in the axes
    of the inboard one, so that copies on one body outside the array stand parallel.
    """

    name: Name
    """Name of the array."""
    count: Annotated[int, Field(ge=1, le=1000)]
    """Number of copies."""
    axis: Axis = (0.0, 0.0, 1.0)
    """Axis about which they are turned."""
    body: _Entries = ()
    """Bodies to repeat."""
    connection: _Entries = ()
    """Connections to repeat."""
    hinge_line: _Entries = ()
    """Hinge lines to repeat."""
    ccl: _Entries = ()
    """Cable loops to repeat."""
    damper: _Entries = ()
    """Dampers to repeat."""

    def turn(self, number: int) -> Quaternion:
        """Of the copy of a number."""
        return exponential(scaled(2.0 * pi * (number - 1) / self.count, self.axis))


def expanded(tree: Tree) -> tuple[Tree, list[str]]:
    """The tree with every array carried out, and what is wrong with those that cannot be."""
    whole = {key: value for key, value in tree.items() if key != "array"}
    reader = EntryReader(tree, ())
    for array in reader.tables("array", Array).sound:
        for part in _PARTS:
            copies = [
                _copy(array, entry, i) for i in range(1, array.count + 1) for entry in getattr(array, part)
            ]
            if copies and isinstance(whole.get(part, []), list):
                whole[part] = [*whole.get(part, []), *copies]
    return whole, reader.problems


def _copy(array: Array, entry: Mapping[str, Any], number: int) -> Tree:
    """A part of one copy; what is no place or axes of the right form is left for others to complain of."""
    following = number % array.count + 1
    copy: Tree = _numbered(dict(entry), number, following)
    turn = array.turn(number)
    place = copy.get("place")
    if isinstance(place, dict):
        turned = {"orientation": _turned(place.get("orientation", {}), turn)}
        if "offset" in place:
            turned["offset"] = _turned_vector(place["offset"], turn, "m")
        copy["place"] = place | turned
    motion = copy.get("motion")
    if isinstance(motion, dict):
        turned = {key: _turned_vector(motion.get(key, axis), turn, "1") for key, axis in _MOTION_AXES.items()}
        copy["motion"] = motion | turned
    if "axes" in copy:
        copy["axes"] = _turned(copy["axes"], turn)
    return copy


def _numbered(value: Any, number: int, following: int) -> Any:  # noqa: ANN401 - any value of a tree
    if isinstance(value, str):
        return value.replace("{i}", str(number)).replace("{next}", str(following))
    if isinstance(value, dict):
        return {
            _numbered(key, number, following): _numbered(v, number, following) for key, v in value.items()
        }
    return [_numbered(entry, number, following) for entry in value] if isinstance(value, list) else value


def _turned(axes: Any, turn: Quaternion) -> Any:  # noqa: ANN401 - what a scene says
    """An orientation, whose axes are those of the world where it does not say."""
    if not isinstance(axes, dict):
        return axes
    whole = {"x": [1.0, 0.0, 0.0], "z": [0.0, 0.0, 1.0]} | axes
    return {key: _turned_vector(value, turn, "1") if key in "xz" else value for key, value in whole.items()}


def _turned_vector(value: Any, turn: Quaternion, unit: str) -> Any:  # noqa: ANN401 - what a scene says
    if not isinstance(value, list) or len(value) != 3:
        return value
    try:
        x, y, z = (to_si(entry, unit) for entry in value)
    except ValueError:
        return value
    vector: Vector3 = (x, y, z)
    return list(rotate(turn, vector))
