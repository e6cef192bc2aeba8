"""Matrices in Harwell-Boeing files, as HBMAT of Ansys writes them: assembled, real, symmetric (one triangle) or not.

SciPy's `hb_read` takes unsymmetric ones without a right-hand side only. Duff, Grimes and Lewis 1992: four lines of
heading, a fifth where there is a right-hand side, then column pointers, rows and values in fields of fixed width.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy import sparse

from ...contract.component import ComponentError, Vector
from ...flexible.finite_elements import SparseMatrix
from .labelled import whole

_FIELD = re.compile(r"[IEDFG](\d+)")
_TYPES = ("RSA", "RUA")


def is_harwell_boeing(path: Path) -> bool:
    """Whether the heading is that of such a file."""
    try:
        with path.open(encoding="latin-1") as file:
            heading = [file.readline() for _ in range(4)]
    except OSError:
        return False
    return bool(re.match(r"[RCP][SUHZR][AE]\s", heading[2])) and bool(_FIELD.search(heading[3].upper()))


def read_harwell_boeing(path: Path) -> SparseMatrix:
    """The matrix (n, n) with both triangles; ComponentError where the file is damaged or of another kind."""
    lines = path.read_text(encoding="latin-1").splitlines()
    kind = lines[2][:3]
    if kind not in _TYPES:
        raise ComponentError(
            f"{path.name}: is of type {kind}; only assembled real matrices can be read, {' or '.join(_TYPES)}"
        )
    try:
        counts = [int(lines[1][k : k + 14] or 0) for k in range(14, 70, 14) if lines[1][k : k + 14].strip()]
        rows, columns, entries = (int(lines[2][k : k + 14]) for k in (14, 28, 42))
        if rows > sum(map(len, lines)):
            raise ValueError(f"{rows} rows are announced")
        formats = [lines[3][:16], lines[3][16:32], lines[3][32:52]]
        first = 5 if len(counts) > 3 and counts[3] else 4
        parts = []
        for count, form, length in zip(counts, formats, (columns + 1, entries, entries), strict=False):
            parts.append(_numbers(path, lines[first : first + count], form, length))
            first += count
        pointers, places, values = parts
        found = sparse.csc_array(
            (values, places.astype(np.int64) - 1, pointers.astype(np.int64) - 1), shape=(rows, columns)
        )
        found.check_format()
    except (ValueError, IndexError) as error:
        raise ComponentError(
            f"{path.name}: cannot be read as Harwell-Boeing, it is damaged: {error}"
        ) from None
    square = sparse.csr_array(found)
    return whole(square) if kind == "RSA" else square


def _numbers(path: Path, lines: Sequence[str], form: str, length: int) -> Vector:
    """So many numbers in fields of the width of a Fortran format."""
    field = _FIELD.search(form.upper())
    if field is None:
        raise ValueError(f"{form.strip()!r} is no format of numbers")
    width = int(field.group(1))
    words = [line[k : k + width] for line in lines for k in range(0, len(line.rstrip()), width)]
    if len(words) != length:
        raise ComponentError(f"{path.name}: has {len(words)} of {length} numbers; it is cut off")
    return np.array([float(word.upper().replace("D", "E")) for word in words])
