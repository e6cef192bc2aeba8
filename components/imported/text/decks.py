"""Nodes of input decks: *NODE of Abaqus and CalculiX (.inp), NWRITE (.node) and CDWRITE (.cdb) of Ansys."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from os.path import normpath
from pathlib import Path

import numpy as np

from ...contract.component import ComponentError, Vector
from ...contract.regular import is_regular
from ..opening import reading
from .entries import text_lines

DECKS = (".inp", ".node", ".cdb")
_NODE_AND_X = 2
_PLACE = 7
"""Numbers of an instance's place: a translation, or two points of an axis and an angle."""


def read_deck(path: Path) -> Vector:
    """Node, x, y, z (N, 4) in the deck's axes; ComponentError where nodes have axes of their own, or there are none."""
    readers = {".inp": _inp, ".node": _node, ".cdb": _cdb}
    rows = list(readers[path.suffix.lower()](path))
    if not rows:
        raise ComponentError(f"{path.name}: has no nodes; it is no deck with coordinates, or cut off")
    return np.array(rows)


def _inp(path: Path) -> Iterator[list[float]]:
    keyword, lines = "", list(_keywords_and_rows(path))
    glob = any("GLOBAL=YES" in text.upper().replace(" ", "") for _, _, text in lines if text.startswith("*"))
    for file, number, text in lines:
        if not text.startswith("*"):
            if keyword == "*INSTANCE" and _moves(_row(file, number, text.split(","), _PLACE)):
                raise ComponentError(
                    f"{file}: line {number}: {text!r} puts an instance elsewhere than its part; give the nodes where "
                    "they are in the assembly, as a deck without parts and instances does"
                )
            if keyword == "*NODE":
                words = text.split(",")
                if len(words) < _NODE_AND_X:
                    raise ComponentError(
                        f"{file}: line {number}: {text!r} is no node with its place; it is cut off"
                    )
                yield _row(file, number, words)
            continue
        keyword, _, parameters = text.upper().replace(" ", "").partition(",")
        turned = keyword == "*TRANSFORM" and not glob
        if turned or keyword == "*SYSTEM" or (keyword == "*NODE" and re.search("SYSTEM=[CS]", parameters)):
            raise ComponentError(
                f"{file}: line {number}: {text} gives nodes axes of their own; give all coordinates in one rectangular "
                "system, and matrices in its axes (CalculiX: GLOBAL=YES)"
            )


def _moves(place: list[float]) -> bool:
    """Whether a translation, or a rotation by its last number about an axis, does anything."""
    return place[-1] != 0.0 if any(place[3:]) else any(place)


def included(path: Path) -> list[Path]:
    """An .inp and the files that it includes, whether they are there or not."""
    found, left = dict[Path, None](), [path]
    while left:
        part = left.pop()
        if part in found:
            continue
        found[part] = None
        if is_regular(part):
            written = part.stat()
            left += _includes(part, written.st_mtime_ns, written.st_size)
    return list(found)


@lru_cache(maxsize=64)
def _includes(path: Path, _time: int, _size: int) -> tuple[Path, ...]:
    """What a deck that was written at a time includes; decks may be long, and are asked for often."""
    lines = path.read_text(encoding="latin-1").splitlines()
    return tuple(other for line in lines if (other := _included(path, line)) is not None)


def _included(path: Path, line: str) -> Path | None:
    """The file that a line of a deck includes."""
    keyword, _, parameters = line.partition(",")
    if keyword.strip().upper() not in ("*INCLUDE", "*NODE"):
        return None
    found = re.search(r"INPUT\s*=\s*([^,]+)", parameters, re.IGNORECASE)
    return None if found is None else Path(normpath(path.parent / found.group(1).strip().strip('"')))


def _keywords_and_rows(path: Path) -> Iterator[tuple[str, int, str]]:
    """File, number and text of all lines that are no comments, with those of included files.

    Each file is read once. ComponentError where one cannot be read, or includes itself.
    """
    path = Path(normpath(path))
    seen, open_files = {path}, [(path, _numbered(path))]
    while open_files:
        path, lines = open_files[-1]
        number, text = next(lines, (0, ""))
        if not number:
            open_files.pop()
            continue
        yield path.name, number, text
        part = _included(path, text)
        if part is None:
            continue
        if any(part == other for other, _ in open_files):
            raise ComponentError(f"{part.name}: includes itself")
        if part not in seen:
            seen.add(part)
            open_files.append((part, _numbered(part)))


def _numbered(path: Path) -> Iterator[tuple[int, str]]:
    """Numbers and texts of the lines of a file that are no comments."""
    with reading(path, "a part of the deck that includes it"):
        lines = path.read_text(encoding="latin-1").splitlines()
    stripped = ((number, line.strip()) for number, line in enumerate(lines, 1))
    return ((number, text) for number, text in stripped if text and not text.startswith("**"))


def _node(path: Path) -> Iterator[list[float]]:
    """Node, x, y, z and angles of the node's axes; what is zero up to the end is not written."""
    for number, line in text_lines(path):
        row = _row(path.name, number, line.replace(",", " ").split(), 7)
        yield _straight(path, number, row, row[4:])


def _cdb(path: Path) -> Iterator[list[float]]:
    """The NBLOCK: node, two numbers, then x, y, z and angles in fields whose widths stand in the line before them."""
    within, widths = "", (9, 3, 21)
    for number, line in enumerate(path.read_text(encoding="latin-1").splitlines(), 1):
        if line.upper().startswith("NBLOCK"):
            within = "format"
        elif within == "format":
            found = re.match(r"\((\d+)i(\d+),\d+[eg](\d+)", line.strip().lower())
            if found is None:
                raise ComponentError(
                    f"{path.name}: line {number}: {line.strip()!r} is no format of an NBLOCK"
                )
            widths, within = (int(found.group(2)), int(found.group(1)), int(found.group(3))), "rows"
            if not widths[0] or not widths[2]:
                raise ComponentError(f"{path.name}: line {number}: {line.strip()!r} has fields of no width")
        elif within == "rows":
            if line.upper().startswith("N,") or line.strip().startswith("-1"):
                return
            width, integers, each = widths
            start = width * integers
            words = [line[:width], *(line[k : k + each] for k in range(start, len(line.rstrip()), each))]
            row = _row(path.name, number, words, 7)
            yield _straight(path, number, row, row[4:])


def _straight(path: Path, number: int, row: list[float], angles: list[float]) -> list[float]:
    if any(angles):
        raise ComponentError(
            f"{path.name}: line {number}: node {row[0]:g} has axes of its own; turn all nodes into the global ones "
            "(NROTAT)"
        )
    return row[:4]


def _row(file: str, number: int, words: list[str], length: int = 4) -> list[float]:
    """Numbers of a row, zeros where it ends early."""
    try:
        row = [float(word) if word.strip() else 0.0 for word in words[:length]]
    except ValueError:
        raise ComponentError(
            f"{file}: line {number}: {','.join(words)[:40]!r} is no node with its place"
        ) from None
    return row + [0.0] * (length - len(row))
