"""Entries of matrices in columns, .sti and .mas of CalculiX among them; and whose degrees of freedom they are.

Three columns are row, column and value, counted from 1, of one triangle or both. Five are node and component of the
row, those of the column, and value. Each line of the .dof of CalculiX (*FREQUENCY, SOLVER=MATRIXSTORAGE) is
node.direction.
"""

from __future__ import annotations

import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...contract.component import ComponentError, Vector
from ..data import Integers
from .labelled import Entries, LabelledMatrix, labelled

_COMMENTS = ("#", "*", "%")
_BINARY = re.compile(rb"[\x00-\x08\x0e-\x1f]")
_HEADING = re.compile(r'"?[^\W\d_]|\D*$')
_DECIMAL_COMMAS = re.compile(r"(?=.*[^,][;\t ])([^,]|(?<=\d),(?=\d))*")
_BLANKS = str.maketrans(';"', "  ")
_BLANKS_AND_COMMA = str.maketrans(';",', "   ")
_ROW_AND_COLUMN, _NODES = 3, 5
"""Columns of a table with entries by row and column, by nodes and components."""


def text_lines(path: Path) -> Iterator[tuple[int, str]]:
    """Lines that are neither empty nor comments, with their numbers; ComponentError where the file is no text."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ComponentError(f"{path.name}: cannot be read: {error.strerror}") from None
    for number, line in enumerate(_decoded(path, content).splitlines(), 1):
        stripped = line.strip()
        if stripped and not stripped.startswith(_COMMENTS):
            yield number, stripped


def _decoded(path: Path, content: bytes) -> str:
    """Text in UTF-16 or UTF-8 by its byte order mark, else in UTF-8 or, with letters of Windows, in Latin-1."""
    try:
        if content.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
            return content.decode("utf-16")
        if not _BINARY.search(content):
            return content.decode("utf-8-sig" if _is_utf8(content) else "latin-1")
    except UnicodeDecodeError:
        pass
    raise ComponentError(f"{path.name}: is not text; write the matrix as text (ASCII)")


def _is_utf8(content: bytes) -> bool:
    try:
        content.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return True


def read_columns(path: Path) -> Vector:
    """A table of numbers in columns; ComponentError with the line that has none.

    Semicolons, tabs, commas or blanks separate columns. Commas are decimal where another separator is on the line and
    no number of the file has a point. Lines before the first number that begin with a letter are a heading.
    """
    lines = list(text_lines(path))
    first = next((k for k, (_, line) in enumerate(lines) if not _HEADING.match(line)), 0)
    lines = lines[first:]
    decimal_commas = all("." not in line and _DECIMAL_COMMAS.fullmatch(line) for _, line in lines)
    blank = _BLANKS if decimal_commas else _BLANKS_AND_COMMA
    decimal = {ord(","): ".", ord("d"): "e", ord("D"): "e"}
    rows: list[list[float]] = []
    for number, line in lines:
        words = [word for word in line.translate(blank).split() if word]
        try:
            rows.append([float(word.translate(decimal)) for word in words])
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
