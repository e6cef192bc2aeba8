"""What every table of a scene file is made of: strict models, names, axes, inertia tensors."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, ClassVar, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, model_validator

from components import ComponentError, FanfoldError
from components.body import Body as BodyComponent
from components.contract.frames import (
    Quaternion,
    Vector3,
    cross,
    norm,
    quaternion_of_axes,
    scaled,
)
from components.flexible.modal import ModalData

from .units import Position, schema_of, to_si, written_as

Tensor = tuple[Vector3, Vector3, Vector3]

_LONGEST_NAME = 200  # file systems allow 255, of which endings and marks of temporary files need some

_PARALLEL = 1e-6
_AXES = {
    f"{sign}{letter}": tuple(factor if i == j else 0.0 for j in range(3))
    for sign, factor in (("+", 1.0), ("-", -1.0))
    for i, letter in enumerate("xyz")
}


class SceneError(FanfoldError):
    """Everything that is wrong with a scene, one sentence a problem."""

    def __init__(self, problems: list[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = problems


class BodyError(ComponentError):
    """Everything that is wrong with how a body is built, one sentence a problem, each with its key."""

    def __init__(self, problems: Sequence[str]) -> None:
        super().__init__("\n".join(problems))
        self.problems = tuple(problems)


def _short(value: str) -> str:
    size = len(value.encode())
    if size > _LONGEST_NAME:
        raise ValueError(
            f"is {size} bytes long; files are called by it, so a name has {_LONGEST_NAME} bytes at most"
        )
    return value


def identifier(value: str) -> str:
    """The value; ValueError with a sentence where it is no name."""
    if not re.fullmatch(r"[A-Za-z]\w*", value):
        raise ValueError(f"is {value!r}; a name starts with a letter and has only letters, digits and _")
    return value


def _scene_name(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z][\w-]*", value):
        raise ValueError(f"is {value!r}; a name starts with a letter and has only letters, digits, _ and -")
    return value


def _axis(value: object) -> object:
    """Unit vector of a named axis, or along three components."""
    if isinstance(value, list | tuple):
        x, y, z = _direction(value)
        return scaled(1.0 / norm((x, y, z)), (x, y, z))
    if not isinstance(value, str) or value not in _AXES:
        raise ValueError(f"is {value!r}; it must be one of +x, -x, +y, -y, +z, -z, or three components")
    return _AXES[value]


def _tensor(value: object) -> object:
    """Moments about the axes (3), xx, yy, zz, xy, xz, yz (6) or the rows of the tensor as a symmetric matrix."""
    if not isinstance(value, list | tuple) or len(value) not in (3, 6):
        raise ValueError(
            f"is {value!r}; give three moments, the six entries xx, yy, zz, xy, xz, yz, or three rows of three"
        )
    if any(isinstance(entry, list | tuple) for entry in value):
        return _symmetric(value)
    entries = [to_si(entry, "kg.m2") for entry in value]
    a, b, c, d, e, f = entries if len(entries) == 6 else (*entries, 0.0, 0.0, 0.0)
    return ((a, d, e), (d, b, f), (e, f, c))


def _symmetric(rows: Sequence[object]) -> object:
    """Rows of a tensor as they are."""
    table = [
        [to_si(entry, "kg.m2") for entry in row]
        for row in rows
        if isinstance(row, list | tuple) and len(row) == 3
    ]
    if len(rows) != 3 or len(table) != 3:
        raise ValueError(f"is {rows!r}; a tensor has three rows of three")
    for i, j in ((0, 1), (0, 2), (1, 2)):
        if table[i][j] != table[j][i]:
            raise ValueError(
                f"has {table[i][j]:g} and {table[j][i]:g} across its diagonal; a tensor is symmetric"
            )
    return tuple(tuple(row) for row in table)


def _physical(value: Tensor) -> Tensor:
    """The body component itself says what it accepts."""
    try:
        BodyComponent(modal=ModalData.rigid(1.0, (0.0,) * 3, value, {}).to_arrays(), ports=[])
    except ComponentError as error:
        raise ValueError(str(error)) from None
    return value


def _direction(value: object) -> Vector3:
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError(f"is {value!r}; give the three components of a direction")
    x, y, z = (to_si(entry, "1") for entry in value)
    if norm((x, y, z)) == 0.0:
        raise ValueError(f"is {value!r}; a direction needs a length")
    return x, y, z


_THREE = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
_NAMED_AXIS = {"anyOf": [{"enum": list(_AXES)}, _THREE]}
_MOMENT = schema_of("kg.m2")
_TENSOR = {
    "anyOf": [
        {"type": "array", "items": items, "minItems": size, "maxItems": size}
        for items, size in (
            (_MOMENT, 3),
            (_MOMENT, 6),
            ({"type": "array", "items": _MOMENT, "minItems": 3, "maxItems": 3}, 3),
        )
    ]
}
Direction = Annotated[Vector3, BeforeValidator(_direction, json_schema_input_type=written_as(_THREE))]
Name = Annotated[str, AfterValidator(identifier), AfterValidator(_short)]
SceneName = Annotated[str, AfterValidator(_scene_name), AfterValidator(_short)]
Axis = Annotated[Vector3, BeforeValidator(_axis, json_schema_input_type=written_as(_NAMED_AXIS))]
Inertia = Annotated[
    Tensor, BeforeValidator(_tensor, json_schema_input_type=written_as(_TENSOR)), AfterValidator(_physical)
]
Y_AXIS: Vector3 = (0.0, 1.0, 0.0)
ORIGIN: Vector3 = (0.0, 0.0, 0.0)


class Table(BaseModel):
    """A table of the file: frozen, no unknown keys."""

    # built where it is first used: tables within others are never built on their own, which takes 0.1 s of each command
    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)
    removed: ClassVar[Mapping[str, str]] = MappingProxyType({})
    """Keys of former versions, with what to do instead."""


class Seat(Table):
    """Where something sits on a body: a point and a rigid arm from it."""

    body: str
    """Name of the body."""
    point: str
    """One of the body's points."""
    offset: Position = ORIGIN
    """Rigid arm from the point, in axes of the body."""


class Orientation(Table):
    """Axes in the world: x along one direction, z as near another as x allows."""

    x: Direction = (1.0, 0.0, 0.0)
    """Direction of the x axis in the world."""
    z: Direction = (0.0, 0.0, 1.0)
    """Direction of the z axis in the world, as near as x allows."""

    @property
    def quaternion(self) -> Quaternion:
        """That turns the world's axes into these."""
        x, y, z = _right_handed(self.x, self.z)
        return quaternion_of_axes(x, y, z)

    @model_validator(mode="after")
    def _spans(self) -> Self:
        if norm(cross(self.z, self.x)) < _PARALLEL * norm(self.z) * norm(self.x):
            raise ValueError(
                f"x and z{'' if 'z' in self.model_fields_set else ', by default (0, 0, 1),'} have one direction; give "
                "two that differ"
            )
        return self


def _right_handed(x: Vector3, z: Vector3) -> tuple[Vector3, Vector3, Vector3]:
    """Unit vectors: x, what is normal to both, and what completes them."""
    along, normal = scaled(1.0 / norm(x), x), cross(z, x)
    across = scaled(1.0 / norm(normal), normal)
    return along, across, cross(along, across)


class Place(Seat):
    """Where the origin of a body starts, and how it is turned."""

    offset: Position = ORIGIN
    """Of the origin from that point, world axes."""
    orientation: Orientation = Orientation()
    """How the body is turned."""
