"""Files of an imported body -> its data, by the endings of their names and by what is in them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import scipy

from ..contract.component import ComponentError
from .data import FiniteElementData
from .expanded_nodes import with_expanded_nodes
from .files import WHOLE
from .matrices import from_matrices, read_npz
from .opening import reading
from .text.decks import DECK, included, read_deck
from .text.entries import read_columns, read_dofs, read_entries

_BULK = (".pch", ".bdf", ".nas", ".dmig")
ENDINGS = (".npz", ".op4", ".op2", ".asm", *_BULK, ".sti")
"""Of files that hold everything, or K and M at least."""
_CALCULIX = {"stiffness": ".sti", "mass": ".mas", "dofs": ".dof", "coordinates": ".inp"}
_HEAD = b"%%MatrixMarket"
_EXPONENTS = bytes.maketrans(b"dD", b"eE")
_NO_NUMBER = re.compile(rb"[^\s0-9eE+.-]")


def read(paths: Mapping[str, Path]) -> FiniteElementData:
    """The data of a file for all, a file a matrix, or both; ComponentError where one cannot be read."""
    further = {name: path for name, path in paths.items() if name != WHOLE}
    whole = paths.get(WHOLE)
    if whole is None:
        return from_matrices(_matrices(further))
    with reading(whole, "finite elements"):
        return _read_whole(whole, further)


def _read_whole(whole: Path, further: Mapping[str, Path]) -> FiniteElementData:
    ending = whole.suffix.lower()
    if ending == ".npz":
        return read_npz(whole)
    if ending == ".sti":
        return with_expanded_nodes(from_matrices(_matrices(_of_calculix(whole, further))))
    from . import nastran, nastran_bulk  # loads pyYeti

    readers: Mapping[str, Callable[[], FiniteElementData]] = {
        ".op4": lambda: nastran.read_op4(whole, _matrices(further)),
        ".op2": lambda: nastran_bulk.read_op2(whole, _matrices(further)),
        ".asm": lambda: nastran.read_superelement(whole),
        **dict.fromkeys(_BULK, lambda: nastran_bulk.read_bulk(whole, _matrices(further))),
    }
    if ending not in readers:
        raise ComponentError(f"{whole.name}: its name must end with {', '.join(ENDINGS)}")
    return readers[ending]()


def beside(path: Path) -> tuple[Path, ...]:
    """The files that are read with one, itself among them, whether they are there or not."""
    if not path.name:
        return (path,)
    parts = {".asm": (".asm", ".op4", ".pch"), ".sti": tuple(_CALCULIX.values())}
    found = [path.with_suffix(ending) for ending in parts.get(path.suffix.lower(), (path.suffix,))]
    return tuple(part for one in found for part in (included(one) if one.suffix.lower() == DECK else [one]))


def _of_calculix(path: Path, further: Mapping[str, Path]) -> dict[str, Path]:
    """Files of one job by what they hold, but for those that are given."""
    found = {name: path.with_suffix(ending) for name, ending in _CALCULIX.items()}
    found.update(further)
    lost = [f"{part.name} ({name})" for name, part in found.items() if not part.is_file()]
    if lost:
        raise ComponentError(
            f"{', '.join(lost)} is missing; put it next to {path.name}, or name it by its key"
        )
    return found


def _matrices(paths: Mapping[str, Path]) -> dict[str, Any]:
    found = {}
    for name, path in paths.items():
        with reading(path, name.replace("_", " ")):
            found[name] = _matrix(name, path)
    return found


def _matrix(name: str, path: Path) -> Any:  # noqa: ANN401 - dense or sparse, entries or nodes
    """What a file has of a name: Matrix Market, columns of numbers, or what goes with one program."""
    if name == "coordinates" and path.suffix.lower() == DECK:
        return read_deck(path)
    if name == "coordinates" and _has_grids(path):
        from .nastran_bulk import read_grids

        return read_grids(path)
    content = path.read_bytes()
    if content.startswith(_HEAD):
        with reading(path, "Matrix Market"):
            _refuse_other_size(content)
            # SciPy reads beyond the end of a file that is cut off within an exponent, but not beyond a line
            return scipy.sparse.coo_array(scipy.io.mmread(BytesIO(_in_plain_numbers(content) + b"\n")))
    if name == "dofs":
        return read_dofs(path)
    return read_entries(path) if name in ("stiffness", "mass") else read_columns(path)


def _refuse_other_size(content: bytes) -> None:
    """ValueError before memory is taken for a Matrix Market file of more numbers than it has characters."""
    rows, columns, entries, layout, _, symmetry = scipy.io.mminfo(BytesIO(content))
    if layout == "array":
        entries = rows * columns if symmetry == "general" else rows * (rows - 1) // 2
    if max(rows, columns, entries) > len(content):
        raise ValueError(
            f"{rows} rows, {columns} columns and {entries} numbers are announced in {len(content)} characters"
        )


def _in_plain_numbers(content: bytes) -> bytes:
    """A Matrix Market file with exponents of Fortran as others have them; ValueError for what is no number.

    SciPy stops a number at the first letter that it does not know, and goes on without a word.
    """
    lines = content.split(b"\n")
    first = next((k for k, line in enumerate(lines) if not line.startswith(b"%")), len(lines))
    numbers = b"\n".join(lines[first:]).translate(_EXPONENTS)
    if wrong := _NO_NUMBER.search(numbers):
        row = first + 1 + numbers.count(b"\n", 0, wrong.start())
        raise ValueError(
            f"line {row} is {lines[row - 1].decode(errors='replace').strip()!r}, which is no numbers"
        )
    return b"\n".join([*lines[:first], numbers])


def _has_grids(path: Path) -> bool:
    """Whether a line begins with GRID, as bulk data have it."""
    return any(line[:4].upper() == "GRID" for line in path.read_text(encoding="latin-1").splitlines())
