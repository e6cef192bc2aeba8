"""A scene file, with its layers, as a checked scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from components import ComponentError
from components._frames import Vector3

from . import scene_check
from .scene_bodies import attachments, body_points, scene_points, start_poses
from .scene_body_tables import Base, Body
from .scene_components import connection_problems
from .scene_connection_tables import Ccl, Connection, Damper
from .scene_layers import Tree, read_layers, variant_names
from .scene_line_tables import Friction, HingeLine, Joint
from .scene_schema import Header, Scene
from .scene_table import SceneError, Table

T = TypeVar("T", bound=Table)

_TABLES = {"scene", "base", "joint", "friction"}
_ARRAYS = {"body", "hinge_line", "ccl", "damper", "connection"}


def _scene_folder() -> Path:
    return Path(str(files(__package__))) / "scenes"


def list_scenes() -> tuple[str, ...]:
    """Names of the scenes that come with Fanfold."""
    return tuple(sorted(path.stem for path in _scene_folder().glob("*.toml")))


def find_scene(name_or_path: str) -> Path:
    """The file of a named scene or at a path; SceneError if there is neither."""
    for path in (_scene_folder() / f"{name_or_path}.toml", Path(name_or_path)):
        if path.is_file():
            return path
    known = ", ".join(list_scenes())
    raise SceneError([f"there is no scene and no file {name_or_path!r}; scenes are {known}"])


def load_scene(path: Path, variants: Sequence[str] = (), settings: Sequence[str] = ()) -> Scene:
    """Read and check a scene file with variants and settings; SceneError with everything that is wrong with it."""
    scene = read_scene(path.name, read_layers(path, find_scene, variants, settings))
    known = scene_variants(path) if scene.header.phases else ()
    problems = [
        f"{path.name}: scene.phases: there is no variant {phase!r}; variants are {', '.join(known) or 'none'}"
        for phase in scene.header.phases
        if phase not in known
    ]
    if problems:
        raise SceneError(problems)
    return scene


def scene_variants(path: Path) -> tuple[str, ...]:
    """Names of the variants of a scene file."""
    return variant_names(path, find_scene)


def read_scene(file: str, tree: Tree) -> Scene:
    """Check a tree of tables; SceneError with everything that is wrong with it."""
    reader = _Reader(tree)
    scene = reader.scene(file)
    if scene is None or reader.problems:
        raise SceneError([f"{file}: {problem}" for problem in reader.problems])
    return scene


class _Reader:
    """Checks every table on its own, then what can be checked between those that are sound."""

    def __init__(self, raw: Tree) -> None:
        self.raw = raw
        known = ", ".join(sorted(_TABLES | _ARRAYS))
        self.problems = [
            f"{key}: is not a known table; tables are {known}" for key in raw if key not in _TABLES | _ARRAYS
        ]

    def scene(self, file: str) -> Scene | None:
        """The scene; None, or problems, if something is wrong."""
        header, base = self._table("scene", Header), self._table("base", Base)
        joint, friction = self._table("joint", Joint), self._table("friction", Friction)
        bodies, lines = self._tables("body", Body), self._tables("hinge_line", HingeLine)
        loops, dampers = self._tables("ccl", Ccl), self._tables("damper", Damper)
        connections = self._tables("connection", Connection)
        self._check_references(base, bodies, lines, loops, dampers, connections)
        for connection in connections:
            self.problems += connection_problems(connection)
        if self.problems or header is None or base is None or joint is None or friction is None:
            return None
        scene = Scene(
            file, self.raw, header, base, joint, friction, bodies, lines, loops, dampers, connections
        )
        points = scene_points(scene)
        self.problems += scene_check.open_hinges(scene, points, start_poses(scene, points))
        return scene

    def _table(self, key: str, model: type[T]) -> T | None:
        raw = self.raw.get(key, {})
        if key in ("scene", "base") and key not in self.raw:
            self.problems.append(f"{key}: is missing")
            return None
        return self._validated(model, raw, key)

    def _tables(self, key: str, model: type[T]) -> tuple[T, ...]:
        entries = self.raw.get(key, [])
        if not isinstance(entries, list):
            self.problems.append(f"{key}: is one table; write it as [[{key}]], because there can be several")
            return ()
        found = [self._validated(model, raw, _entry(key, raw, i)) for i, raw in enumerate(entries)]
        return tuple(table for table in found if table is not None)

    def _validated(self, model: type[T], raw: object, key: str) -> T | None:
        try:
            return model.model_validate(raw)
        except ValidationError as error:
            self.problems += [f"{_key(key, raw, e['loc'])}: {_sentence(e)}" for e in error.errors()]
            return None

    def _names(self, key: str) -> list[str]:
        """Names of all entries, sound or not."""
        entries = self.raw.get(key, [])
        named = [e.get("name") for e in entries if isinstance(e, dict)] if isinstance(entries, list) else []
        return [name for name in named if isinstance(name, str)]

    def _check_references(
        self,
        base: Base | None,
        bodies: tuple[Body, ...],
        lines: tuple[HingeLine, ...],
        loops: tuple[Ccl, ...],
        dampers: tuple[Damper, ...],
        connections: tuple[Connection, ...],
    ) -> None:
        named = [("base", base.name)] if base else []
        named += [(key, name) for key in _ARRAYS for name in self._names(key)]
        named += [(f"hinge_line.{line.name}.hinges", hinge.name) for line in lines for hinge in line.hinges]
        self.problems += scene_check.repeated_names((f"{key}.{name}", name) for key, name in named)
        found = list(attachments(lines, loops, dampers, connections))
        points: dict[str, Mapping[str, Vector3] | None] = dict.fromkeys(self._names("body"))
        points |= {body.name: self._points(body) for body in bodies}
        if base is None:
            return
        self.problems += scene_check.unknown_places(found, {base.name: base.points, **points})
        self.problems += scene_check.misplaced(bodies, {base.name: base.points, **points})
        self.problems += scene_check.repeated_ports(found, lines)
        if len(lines) == len(self.raw.get("hinge_line", [])):
            self.problems += scene_check.unknown_hinges(dampers, lines)
            placed = [body.name for body in bodies if body.place is not None]
            self.problems += scene_check.broken_tree(base.name, self._names("body"), lines, placed)

    def _points(self, body: Body) -> Mapping[str, Vector3] | None:
        try:
            return body_points(body)
        except ComponentError as error:
            self.problems.append(f"body.{body.name}.catalogue: {error}")
            return None


def _entry(key: str, raw: object, position: int) -> str:
    """Key of an entry of an array: by its name if it has one."""
    name = raw.get("name") if isinstance(raw, dict) else None
    return f"{key}.{name}" if isinstance(name, str) else f"{key}[{position + 1}]"


def _key(key: str, raw: object, location: tuple[int | str, ...]) -> str:
    """Dotted key of a place inside a table."""
    for step in location:
        if isinstance(step, int):
            raw = raw[step] if isinstance(raw, list) and step < len(raw) else None
            key = _entry(key, raw, step)
        else:
            raw = raw.get(step) if isinstance(raw, dict) else None
            key = f"{key}.{step}"
    return key


def _sentence(error: ErrorDetails) -> str:
    """What a validation error means to the author of the file."""
    context = error.get("ctx", {})
    if error["type"] == "missing":
        return "is missing"
    if error["type"] == "extra_forbidden":
        return "is not a known key"
    if error["type"] == "value_error":
        return str(context["error"])
    if error["type"] == "literal_error":
        return f"is {error['input']!r}; it must be {context['expected']}"
    return f"is {error['input']!r}; {error['msg'][0].lower()}{error['msg'][1:]}"
