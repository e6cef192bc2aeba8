"""What external superelements of Nastran recover: displacements, stresses and forces of elements, by tables in .pch."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from ..flexible.finite_elements import OutputRows
from .data import FiniteElementData, Recovery

_TURNED = 1e-3
"""How far recovered axes are from orthonormal by the seven digits of the files."""
_BAR_STRESSES = ("sa1", "sa2", "sa3", "sa4", "axial", "sb1", "sb2", "sb3", "sb4")
_STRESSES = {34: _BAR_STRESSES}
"""Stresses by element type: of CBAR at the four points of end A, along the axis, and at those of end B."""
_BAR = (("moment a1", "N.m"), ("moment a2", "N.m"), ("moment b1", "N.m"), ("moment b2", "N.m"))
_ROD = (("axial", "N"), ("torque", "N.m"))
_SPRING = (("force", "N"),)
_SHELL = (
    *((name, "N/m") for name in ("fx", "fy", "fxy")),
    *((name, "N") for name in ("mx", "my", "mxy")),
    *((name, "N/m") for name in ("qx", "qy")),
)
_FORCES: Mapping[int, tuple[tuple[str, str], ...]] = {
    1: _ROD,
    3: _ROD,
    10: _ROD,
    **dict.fromkeys((11, 12, 13, 14), _SPRING),
    33: _SHELL,
    74: _SHELL,
    34: (*_BAR, ("shear 1", "N"), ("shear 2", "N"), *_ROD),
    102: (*((f"f{axis}", "N") for axis in "xyz"), *((f"m{axis}", "N.m") for axis in "xyz")),
}
"""Forces by element type (rods, springs, shells of 4 and 3 corners, bar, bush), as Nastran orders them, with units."""


def with_recovery(
    data: FiniteElementData,
    nastran: Any,  # noqa: ANN401 - an optional library without types
    punch: Path,
    matrices: Mapping[str, Any],
) -> FiniteElementData:
    """The data with what the matrices recover: mug1 displacements, mes1 stresses, mef1 forces of elements.

    Forces of types whose components we do not know stay behind, as their units cannot be told.
    """
    parts = [*_stresses(punch, matrices, len(data.dofs)), *_forces(punch, matrices, len(data.dofs))]
    labels, units, rows = zip(*parts, strict=True) if parts else ((), (), ())
    outputs = OutputRows(labels, units, np.array(rows)) if parts else None
    return replace(data, recovery=_recovery(nastran, punch, matrices, data), outputs=outputs)


def _recovery(
    nastran: Any,  # noqa: ANN401 - an optional library without types
    punch: Path,
    matrices: Mapping[str, Any],
    data: FiniteElementData,
) -> Recovery | None:
    """Nodes of the displacement recovery, whose places and axes follow from what rigid motions do to them."""
    rows = matrices.get("mug1")
    if rows is None or rows.shape[1] != len(data.dofs):
        return None
    try:
        listed = np.asarray(nastran.rddtipch(str(punch), name="TUG1"))
    except Exception as error:
        raise ComponentError(f"{punch.name}: its table TUG1 cannot be read: {error}") from None
    if len(listed) != len(rows):
        raise ComponentError(f"{punch.name}: TUG1 lists {len(listed)} rows, and matrix mug1 has {len(rows)}")
    rigid = _basic_rigid(data)
    nodes, places, motions = [], [], []
    for node in dict.fromkeys(listed[listed[:, 1] > 0, 0].tolist()):
        own = np.flatnonzero(listed[:, 0] == node)
        if len(own) != 6:
            continue
        moved = rows[own] @ rigid
        axes = moved[:3, :3]
        if not np.allclose(axes @ axes.T, np.eye(3), atol=_TURNED):
            continue  # a scalar point, or a node that rows do not follow in full
        arm = axes.T @ moved[:3, 3:]  # -skew of the place
        nodes.append(node)
        places.append([arm[1, 2], arm[2, 0], arm[0, 1]])
        motions.append(np.vstack([axes.T @ rows[own[:3]], moved[3:, 3:].T @ rows[own[3:]]]))
    if not nodes:
        return None
    return Recovery(np.array(nodes), np.array(places), scipy.sparse.csr_array(np.concatenate(motions)))


def _basic_rigid(data: FiniteElementData) -> Vector:
    """Values (n, 6) of the degrees of freedom, in their own axes, under rigid motions in basic axes."""
    motions = data.rigid_motions()
    turned = motions.copy()
    for node, axes in zip(data.nodes, data.axes, strict=True):
        own = data.dofs_of(int(node))
        for first in (1, 4):
            rows = [own[first + k] for k in range(3) if first + k in own]
            if len(rows) == 3:
                turned[rows] = axes @ motions[rows]
    return turned


_Rows = Iterator[tuple[str, str, Vector]]
"""Label, unit and row of every output."""


def _stresses(punch: Path, matrices: Mapping[str, Any], columns: int) -> _Rows:
    rows = matrices.get("mes1")
    if rows is None or rows.shape[1] != columns:
        return
    for kind, element, components, first in _elements(punch, "TES1", len(rows)):
        names = _STRESSES.get(kind, tuple(f"stress {k + 1}" for k in range(components)))
        for k, name in enumerate(names[:components]):
            yield f"element {element} {name}", "Pa", np.asarray(rows[first - 1 + k])


def _forces(punch: Path, matrices: Mapping[str, Any], columns: int) -> _Rows:
    rows = matrices.get("mef1")
    if rows is None or rows.shape[1] != columns:
        return
    for kind, element, components, first in _elements(punch, "TEF1", len(rows)):
        names = _FORCES.get(kind, ())
        if len(names) == components:
            for k, (name, unit) in enumerate(names):
                yield f"element {element} {name}", unit, np.asarray(rows[first - 1 + k])


def _elements(punch: Path, table: str, count: int) -> list[tuple[int, int, int, int]]:
    """Record 2 of a table, in fixed fields of eight characters: type, number, how many components, first row (from 1).

    ComponentError where it lists rows that the matrix, of `count`, does not have.
    """
    words: list[int] = []
    within = False
    for line in punch.read_text(encoding="latin-1").splitlines():
        if line.startswith("DTI"):
            within = line[8:16].strip() == table and line[16:24].strip() == "2"
            fields = line[24:72]
        else:
            fields = line[8:72]
        if within:
            parts = [fields[k : k + 8].strip() for k in range(0, len(fields), 8)]
            words += [int(part) for part in parts if part.lstrip("-").isdigit()]
    found = [(words[k], words[k + 1], words[k + 2], words[k + 3]) for k in range(0, len(words) - 3, 4)]
    listed = max((first + components - 1 for _, _, components, first in found), default=0)
    if listed != count:
        raise ComponentError(
            f"{punch.name}: {table} lists {listed} rows, and its matrix has {count}; one is cut off"
        )
    return found
