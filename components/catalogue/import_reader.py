"""A table -> an imported body: files, units, points. The keys are those of `[body.import]` in scene files."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ..contract.regular import content
from ..imported.agreement import Stated
from ..imported.body import ImportedBody
from ..imported.files import NAMES
from ..imported.points import JoinedPoint
from ..imported.reading import beside
from .tables import Table


def read_import(table: Table | None) -> tuple[ImportedBody | None, tuple[str, ...], tuple[str, ...]]:
    """The body, its attachment points and its further points; None where the table is not sound."""
    if table is None:
        return None, (), ()
    files = tuple((name, path) for name in NAMES if (path := table.line(name)))
    if "file" not in dict(files) and "stiffness" not in dict(files):
        table.note("file", "is missing; give a file, or stiffness, mass and coordinates, each in its own")
    ends, nodes = table.numbers_of_names("attachment_points"), table.numbers_of_names("nodes")
    rigid, means = _joined(table, "rigid_elements"), _joined(table, "means")
    names = (*ends, *(point.name for point in (*rigid, *means)))
    if not names:
        table.note("attachment_points", "is missing; give names with numbers of nodes")
    length, mass = _units(table)
    stated = _stated(table.table("stated", required=False))
    digest = _digest(table, files)
    table.close()
    body = ImportedBody(
        files, digest, tuple(ends.items()), tuple(nodes.items()), rigid, means, length, mass, stated
    )
    return body if digest and files else None, names, tuple(nodes)


def _units(table: Table) -> tuple[float, float]:
    units = table.table("units", required=False)
    if units is None:
        return 1.0, 1.0
    found = units.number("length", "m", default=1.0), units.number("mass", "kg", default=1.0)
    units.close()
    return found


def _stated(table: Table | None) -> Stated:
    if table is None:
        return Stated()
    stated = Stated(
        table.number("mass", "kg") if "mass" in table else None,
        table.numbers("center_of_mass", "m", 3) if "center_of_mass" in table else None,
        table.numbers("inertia", "kg.m2", 3) if "inertia" in table else None,
    )
    table.close()
    return stated


def _joined(table: Table, key: str) -> tuple[JoinedPoint, ...]:
    found = []
    for entry in table.entries(key):
        position = entry.numbers("position", "m", 3) if "position" in entry else None
        found.append(JoinedPoint(entry.text("name"), entry.whole_numbers("nodes"), position))
        entry.close()
    return tuple(found)


def _digest(table: Table, files: tuple[tuple[str, str], ...]) -> str:
    """Of the content of all files; empty where one cannot be read."""
    found = hashlib.sha256()
    for name, given in files:
        path = Path(given)
        for part in beside(path):
            try:
                found.update(content(part))
            except OSError as error:
                if part == path:
                    table.note(name, f"{path}: cannot be read: {error.strerror}")
                    return ""
    return found.hexdigest()
