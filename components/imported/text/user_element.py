"""Substructures of Abaqus and CalculiX (*SUBSTRUCTURE MATRIX OUTPUT), written as a linear *USER ELEMENT.

Comments list its nodes; the first line of data has the degrees of freedom at the first node, each further one the
place among the nodes from which on others apply, and these. *MATRIX, TYPE=STIFFNESS or MASS has the lower triangle row
by row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np
from scipy import sparse

from ...contract.component import ComponentError
from ..data import Integers
from .labelled import LabelledMatrix

_Number = TypeVar("_Number", int, float)
_KEYWORD = "*USER ELEMENT"
_TYPES = {"TYPE=STIFFNESS": "stiffness", "TYPE=MASS": "mass"}


@dataclass
class _Element:
    """What a file has of its one element."""

    nodes: list[int] = field(default_factory=list)
    freedoms: list[list[int]] = field(default_factory=list)
    """of the first node, then (place, degrees of freedom) where they change"""
    values: dict[str, list[float]] = field(default_factory=dict)


def is_user_element(path: Path) -> bool:
    """Whether a file has such an element."""
    return _KEYWORD in path.read_text(encoding="latin-1").upper()


def read_user_element(path: Path) -> dict[str, LabelledMatrix]:
    """`stiffness` and `mass`, as far as they are there; ComponentError where the file is damaged or has several."""
    element = _read(path)
    dofs = _dofs(path, element)
    found = {}
    for name, values in element.values.items():
        count = len(dofs)
        if len(values) != count * (count + 1) // 2:
            raise ComponentError(
                f"{path.name}: {name} has {len(values)} numbers; {count} degrees of freedom have "
                f"{count * (count + 1) // 2} in their lower triangle, so the file is cut off or damaged"
            )
        matrix = np.zeros((count, count))
        matrix[np.tril_indices(count)] = values
        matrix += np.tril(matrix, -1).T
        found[name] = LabelledMatrix(path.name, dofs, sparse.csr_array(matrix))
    return found


def _read(path: Path) -> _Element:
    element, block, elements = _Element(), "", 0
    for number, line in enumerate(path.read_text(encoding="latin-1").splitlines(), 1):
        text = line.strip().upper()
        if text.startswith("**"):
            if block == "nodes":
                element.nodes += _numbers(path, number, text[2:], int)
            elif "ELEMENT NODES" in text:
                block = "nodes"
        elif text.startswith("*"):
            keyword, _, parameters = text.partition(",")
            elements += keyword.strip() == _KEYWORD
            block = _TYPES.get(parameters.replace(" ", ""), "other") if keyword == "*MATRIX" else "element"
        elif text and block in ("nodes", "element", "freedoms"):
            block = "freedoms"
            element.freedoms.append(_numbers(path, number, text, int))
        elif text and block != "other":
            element.values.setdefault(block, []).extend(_numbers(path, number, text, float))
    if elements > 1:
        raise ComponentError(f"{path.name}: has {elements} elements; write the matrices of one substructure")
    return element


def _numbers(path: Path, number: int, text: str, kind: Callable[[str], _Number]) -> list[_Number]:
    try:
        return [kind(word) for word in text.replace(",", " ").split()]
    except ValueError:
        raise ComponentError(f"{path.name}: line {number}: {text[:40]!r} is no row of numbers") from None


def _dofs(path: Path, element: _Element) -> Integers:
    """Node and component of every row."""
    if not element.nodes or not element.freedoms:
        raise ComponentError(
            f"{path.name}: does not tell the nodes of its element and their degrees of freedom"
        )
    changes = {1: element.freedoms[0], **{row[0]: row[1:] for row in element.freedoms[1:]}}
    active: list[int] = []
    rows = []
    for place, node in enumerate(element.nodes, 1):
        active = changes.get(place, active)
        rows += [(node, component) for component in active]
    return np.array(rows, dtype=np.int64).reshape(-1, 2)
