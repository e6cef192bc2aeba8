"""Entries of matrices in columns, .sti and .mas of CalculiX among them; and whose degrees of freedom they are.

Three columns are row, column and value, counted from 1, of one triangle or both. Five are node and component of the
row, those of the column, and value. Each line of the .dof of CalculiX (*FREQUENCY, SOLVER=MATRIXSTORAGE) is
node.direction.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...contract.component import ComponentError, Vector
from ..data import Integers
from .labelled import Entries, LabelledMatrix, labelled

_COMMENTS = ("#", "*", "%")
_ROW_AND_COLUMN, _NODES = 3, 5
"""Columns of a table with entries by row and column, by nodes and components."""


def text_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Lines that are neither empty nor comments, with their numbers; ComponentError where the file is no text."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ComponentError(f"{path.name}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise ComponentError(f"{path.name}: is not text; write the matrix as text (ASCII)") from None
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if stripped and not stripped.startswith(_COMMENTS):
            yield number, stripped


def read_columns(path: Path) -> Vector:
    """A table of numbers with commas or blanks; ComponentError tells the line that is none of it."""
    rows: list[list[float]] = []
    for number, line in text_lines(path):
        words = line.replace(",", " ").split()
        try:
            rows.append([float(word) for word in words])
        except ValueError:
            raise ComponentError(f"{path.name}: line {number}: {line[:40]!r} is no row of numbers") from None
        if len(words) != len(rows[0]):
            raise ComponentError(
                f"{path.name}: line {number} has {len(words)} numbers, and those before it have {len(rows[0])}; "
                "the file is cut off or damaged"
            )
    if not rows:
        raise ComponentError(f"{path.name}: holds no numbers; it is empty or cut off")
    return np.array(rows)


def read_entries(path: Path) -> Vector | Entries | LabelledMatrix:
    """A matrix of columns of numbers: its entries in three or five columns, or else all of it, row by row."""
    table = read_columns(path)
    count, columns = table.shape
    if columns == count or columns not in (_ROW_AND_COLUMN, _NODES):
        return table
    places = _whole(path, table[:, :-1])
    if columns == _ROW_AND_COLUMN:
        return Entries(path.name, places[:, 0] - 1, places[:, 1] - 1, table[:, -1])
    if (lowest := places[:, (0, 2)].min()) < 1:
        raise ComponentError(f"{path.name}: node {lowest} is none; nodes count from 1")
    return labelled(path.name, places[:, :2], places[:, 2:], table[:, -1])


def _whole(path: Path, values: Vector) -> Integers:
    found = np.round(values).astype(np.int64)
    if not np.array_equal(found, values):
        raise ComponentError(f"{path.name}: a row, column, node or component is not a whole number")
    return found


def read_dofs(path: Path) -> Vector:
    """Node and component of every row (n, 2): .dof of CalculiX, or two columns."""
    if path.suffix.lower() == ".dof":
        return np.array(
            [_node_and_direction(path, number, line) for number, line in text_lines(path)], dtype=float
        )
    return read_columns(path)


def _node_and_direction(path: Path, number: int, line: str) -> tuple[int, int]:
    node, point, direction = line.partition(".")
    if not (point and node.isdecimal() and direction in tuple("123456")):
        raise ComponentError(
            f"{path.name}: line {number}: {line[:40]!r} is no node.direction with a direction from 1 to 6"
        )
    return int(node), int(direction)
