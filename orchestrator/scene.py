"""A TOML file -> a checked scene -> an assembly at one fidelity."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from components import ComponentError
from components._frames import Vector3
from components.modal import ModalData

from . import scene_check
from .assembly import Assembly, Geometry, Link, Part
from .port_starts import with_port_starts
from .scene_bodies import (
    Attachment,
    attachments,
    base_model,
    body_model,
    body_points,
    scene_points,
    start_poses,
)
from .scene_connections import (
    WrenchMode,
    assembly_line,
    damper_part,
    hinge_parts,
    line_latch,
    loop_part,
)
from .scene_schema import (
    Base,
    Body,
    Ccl,
    Damper,
    Friction,
    Header,
    HingeLine,
    Joint,
    Scene,
    SceneError,
    Table,
)

__all__ = ["Scene", "SceneError", "assemble", "find_scene", "list_scenes", "load_scene"]

T = TypeVar("T", bound=Table)

_TABLES = {"scene", "base", "joint", "friction"}
_ARRAYS = {"body", "hinge_line", "ccl", "damper"}


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


def load_scene(path: Path) -> Scene:
    """Read and check a scene file; SceneError with everything that is wrong with it."""
    try:
        text = path.read_text(encoding="utf-8")
        raw = tomllib.loads(text)
    except UnicodeDecodeError as error:
        raise SceneError(
            [f"{path.name}: is not a text file in UTF-8: {error.reason} at byte {error.start}"]
        ) from None
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise SceneError([f"{path.name}: {error}"]) from None
    reader = _Reader(raw)
    scene = reader.scene(path.name, text)
    if scene is None or reader.problems:
        raise SceneError([f"{path.name}: {problem}" for problem in reader.problems])
    return scene


class _Reader:
    """Checks every table on its own, then what can be checked between those that are sound."""

    def __init__(self, raw: Mapping[str, Any]) -> None:
        self.raw = raw
        known = ", ".join(sorted(_TABLES | _ARRAYS))
        self.problems = [
            f"{key}: is not a known table; tables are {known}" for key in raw if key not in _TABLES | _ARRAYS
        ]

    def scene(self, file: str, text: str) -> Scene | None:
        """The scene; None, or problems, if something is wrong."""
        header, base = self._table("scene", Header), self._table("base", Base)
        joint, friction = self._table("joint", Joint), self._table("friction", Friction)
        bodies, lines = self._tables("body", Body), self._tables("hinge_line", HingeLine)
        loops, dampers = self._tables("ccl", Ccl), self._tables("damper", Damper)
        self._check_references(base, bodies, lines, loops, dampers)
        if self.problems or header is None or base is None or joint is None or friction is None:
            return None
        scene = Scene(file, text, header, base, joint, friction, bodies, lines, loops, dampers)
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
    ) -> None:
        named = [("base", base.name)] if base else []
        named += [(key, name) for key in ("body", "hinge_line", "ccl", "damper") for name in self._names(key)]
        named += [(f"hinge_line.{line.name}.hinges", hinge.name) for line in lines for hinge in line.hinges]
        self.problems += scene_check.repeated_names((f"{key}.{name}", name) for key, name in named)
        found = list(attachments(lines, loops, dampers))
        points: dict[str, Mapping[str, Vector3] | None] = dict.fromkeys(self._names("body"))
        points |= {body.name: self._points(body) for body in bodies}
        if base is None:
            return
        self.problems += scene_check.unknown_places(found, {base.name: base.points, **points})
        self.problems += scene_check.repeated_ports(found, lines)
        if len(lines) == len(self.raw.get("hinge_line", [])):
            self.problems += scene_check.unknown_hinges(dampers, lines)
            self.problems += scene_check.broken_tree(base.name, self._names("body"), lines)

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


def choose_fidelity(scene: Scene, rigid: Collection[str], flexible: Collection[str]) -> dict[str, bool]:
    """Whether each body is flexible: its default, unless named (or meant by "all") in one of the two sets."""
    bodies = {body.name: body for body in scene.bodies}
    problems = [
        f"{scene.file}: there is no body {name!r}; bodies are {', '.join(bodies)}"
        for name in sorted({*rigid, *flexible} - {*bodies, "all"})
    ]
    to_rigid = set(bodies) if "all" in rigid else set(rigid)
    entries = {name for name, body in bodies.items() if body.catalogue is not None}
    to_flexible = entries if "all" in flexible else set(flexible)
    for name in bodies:
        if name in to_rigid and name in to_flexible:
            problems.append(f"{scene.file}: body.{name}: it cannot be both rigid and flexible")
        if name in to_flexible - entries:
            problems.append(f"{scene.file}: body.{name}: only a body of the catalogue can be flexible")
    if problems:
        raise SceneError(problems)
    return {
        name: name in to_flexible or (body.flexible and name not in to_rigid) for name, body in bodies.items()
    }


def assemble(
    scene: Scene,
    rigid: Collection[str] = (),
    flexible: Collection[str] = (),
    wrench_mode: WrenchMode = "mean",
) -> Assembly:
    """Parts, links and hinge lines of a scene at the given fidelity; SceneError for impossible fidelities."""
    is_flexible = choose_fidelity(scene, rigid, flexible)
    models = {body.name: _model(scene, body, is_flexible[body.name]) for body in scene.bodies}
    found = list(attachments(scene.hinge_lines, scene.loops, scene.dampers))
    latches = [line_latch(scene, line, is_flexible, wrench_mode) for line in scene.hinge_lines]
    parts = [_base_part(scene, found), *_body_parts(scene, models, found)]
    for line, latch in zip(scene.hinge_lines, latches, strict=True):
        parts += hinge_parts(scene, line, latch, is_flexible, wrench_mode)
    parts += [loop_part(loop, wrench_mode) for loop in scene.loops]
    parts += [damper_part(scene, damper, wrench_mode) for damper in scene.dampers]
    header = scene.header
    links = tuple(Link((a.body, a.connection), (a.connection, a.port)) for a in found)
    return Assembly(
        name=header.name,
        scene_text=scene.text,
        parts=with_port_starts(parts, links),
        links=links,
        hinge_lines=tuple(map(assembly_line, scene.hinge_lines, latches)),
        base=scene.base.name,
        until=header.until,
        tolerance=header.tolerance,
        largest_step=header.largest_step,
        preload=header.preload,
        geometry={
            name: Geometry(data.display_positions, data.display_shapes, data.display_faces)
            for name, data in models.items()
            if len(data.display_positions)
        },
    )


def _model(scene: Scene, body: Body, flexible: bool) -> ModalData:
    try:
        return body_model(body, flexible)
    except ComponentError as error:
        raise SceneError([f"{scene.file}: body.{body.name}: {error}"]) from None


def _ports(body: str, found: list[Attachment]) -> list[dict[str, Any]]:
    """One port for every connection of a body, named after it."""
    return [
        {"name": port.connection, "point": port.point, "offset": port.offset}
        for port in found
        if port.body == body
    ]


def _base_part(scene: Scene, found: list[Attachment]) -> Part:
    """The spacecraft as ground, or as a rigid body with the same ports."""
    base, model, ports = scene.base, base_model(scene.base), _ports(scene.base.name, found)
    if model is not None:
        return Part(base.name, "body", {"modal": model.to_arrays(), "ports": ports}, {})
    fixed = [
        {
            "name": port["name"],
            "position": tuple(a + b for a, b in zip(base.points[port["point"]], port["offset"], strict=True)),
        }
        for port in ports
    ]
    return Part(base.name, "fixed_base", {"ports": fixed}, {})


def _body_parts(scene: Scene, models: Mapping[str, ModalData], found: list[Attachment]) -> list[Part]:
    """Bodies in their stowed poses, at rest."""
    poses = start_poses(scene, scene_points(scene))
    return [
        Part(
            body.name,
            "body",
            {
                "modal": models[body.name].to_arrays(),
                "ports": _ports(body.name, found),
                "inertia_coupling": body.inertia_coupling,
            },
            {
                "initial_position": poses[body.name].position,
                "initial_orientation": poses[body.name].orientation,
                "damping_scale": body.damping_scale,
            },
        )
        for body in scene.bodies
    ]
