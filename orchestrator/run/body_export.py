"""A body of a scene as finite elements for other programs: reduced, with the table that reads it back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import tomli_w

from components import ComponentError

from ..records import short_repr
from ..scene import PlacedScene, SceneError
from ..scene.bodies import body_definition

if TYPE_CHECKING:
    from components.imported.data import FiniteElementData

    from ..scene.body_tables import Body

ENDINGS = (".npz", ".op4", ".asm")


@short_repr
@dataclass(frozen=True)
class ExportedBody:
    """A file, the numbers of nodes in it by point, and how many fixed-interface modes it has."""

    path: Path
    body: str
    attachment_points: Mapping[str, int]
    nodes: Mapping[str, int]
    modes: int

    def to_toml(self) -> str:
        """The table of a scene file that imports the body from its file next to it."""
        table: dict[str, object] = {
            "file": self.path.name,
            "attachment_points": dict(self.attachment_points),
            "nodes": dict(self.nodes),
        }
        entry = {"name": self.body, "fixed_interface_modes": self.modes, "import": table}
        return tomli_w.dumps({"body": [entry]})


def export_body(scene: PlacedScene, name: str, path: Path, modes: int | None = None) -> ExportedBody:
    """Write a body of a scene, with its attached masses, to an .npz or .op4 file, or to an .asm with .op4 and .pch.

    modes: fixed-interface modes to keep, by default the scene's. SceneError where there is nothing to write, or the
    file cannot be written.
    """
    if path.suffix.lower() not in ENDINGS:
        raise SceneError([f"{path}: a body is written to a file that ends with {', '.join(ENDINGS)}"])
    body = _bending(scene, name)
    definition = body_definition(body)
    asked = body.fixed_interface_modes if modes is None else modes
    try:
        from components.imported.reduced import reduced_data

        count = definition.fixed_interface_modes(asked)
        model = definition.finite_elements(body.masses)
        data = reduced_data(model, definition.attachment_points, definition.nodes, count)
        path.parent.mkdir(parents=True, exist_ok=True)
        _write(path, data)
    except ComponentError as error:
        raise SceneError([f"{scene.file}: body.{name}: {error}"]) from None
    except OSError as error:
        raise SceneError([f"{path}: cannot be written: {error.strerror or error}"]) from None
    ends = len(definition.attachment_points)
    numbers = {point: k for k, point in enumerate(definition.points, 1)}
    return ExportedBody(
        path,
        name,
        {point: k for point, k in numbers.items() if k <= ends},
        {point: k for point, k in numbers.items() if k > ends},
        count,
    )


def _bending(scene: PlacedScene, name: str) -> Body:
    """The body of a name, if it can bend."""
    bodies = {body.name: body for body in scene.bodies}
    if name not in bodies:
        raise SceneError(
            [f"{scene.file}: there is no body {name!r}; bodies are {', '.join(bodies) or 'none'}"]
        )
    if not bodies[name].can_bend:
        raise SceneError(
            [
                f"{scene.file}: body.{name}: is rigid, so it has no finite elements; its mass stands in the scene"
            ]
        )
    return bodies[name]


def _write(path: Path, data: FiniteElementData) -> None:
    from components.imported import matrices, nastran

    writers = {".npz": matrices.write_npz, ".op4": nastran.write_op4, ".asm": nastran.write_superelement}
    writers[path.suffix.lower()](path, data)
