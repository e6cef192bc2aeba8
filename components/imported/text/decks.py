"""Nodes of input decks of CalculiX (.inp): *NODE, of included files too."""

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

DECK = ".inp"
_NODE_AND_X = 2


def read_deck(path: Path) -> Vector:
    """Node, x, y, z (N, 4) in the deck's axes; ComponentError where nodes have axes of their own, or there are none."""
    turning: set[float] = set()
    rows = [row for row in list(_nodes(path, turning)) if row[0] not in turning]
    if not rows:
        raise ComponentError(f"{path.name}: has no nodes; it is no deck with coordinates, or cut off")
    return np.array(rows)


def _nodes(path: Path, turning: set[float]) -> Iterator[list[float]]:
    """Rows of nodes; turning: takes the numbers of nodes whose displacements are rotations of a rigid body."""
    keyword, lines = "", list(_keywords_and_rows(path))
    glob = any("GLOBAL=YES" in text.upper().replace(" ", "") for _, _, text in lines if text.startswith("*"))
    for file, number, text in lines:
        if not text.startswith("*"):
            if keyword == "*NODE":
                words = text.split(",")
                if len(words) < _NODE_AND_X:
                    raise ComponentError(
                        f"{file}: line {number}: {text!r} is no node with its place; it is cut off"
                    )
                yield _row(file, number, words)
            continue
        keyword, _, parameters = text.upper().replace(" ", "").partition(",")
        if keyword == "*INSTANCE":
            raise ComponentError(
                f"{file}: line {number}: {text} may move the nodes of a part; give a deck without parts and instances"
            )
        if keyword == "*RIGIDBODY" and (rotation := re.search(r"ROTNODE=(\d+)", parameters)):
            turning.add(float(rotation.group(1)))
        if re.search(r"OFFSET[12]?=(?![+-]?0*\.?0*(,|$))", parameters):
            raise ComponentError(
                f"{file}: line {number}: {text} moves shells or beams away from their nodes; put nodes in the middle"
            )
        turned = keyword == "*TRANSFORM" and not glob
        if turned or keyword == "*SYSTEM" or (keyword == "*NODE" and re.search("SYSTEM=[CS]", parameters)):
            raise ComponentError(
                f"{file}: line {number}: {text} gives nodes axes of their own; give all coordinates in one rectangular "
                "system, and matrices in its axes (CalculiX: GLOBAL=YES)"
            )


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


def _row(file: str, number: int, words: list[str]) -> list[float]:
    """Node, x, y, z; zeros where the row ends early."""
    try:
        row = [float(word) if word.strip() else 0.0 for word in words[:4]]
    except ValueError:
        raise ComponentError(
            f"{file}: line {number}: {','.join(words)[:40]!r} is no node with its place"
        ) from None
    return row + [0.0] * (4 - len(row))
