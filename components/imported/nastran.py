"""Nastran's external superelements and op4 matrices, read by pyYeti, as finite-element data."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from ..contract.component import ComponentError, Vector
from .data import AMPLITUDE, FiniteElementData, Integers, Recovery, StressRows
from .files import OP4_NAMES
from .matrices import from_matrices

_BAR, _BAR_STRESSES = 34, ("sa1", "sa2", "sa3", "sa4", "axial", "sb1", "sb2", "sb3", "sb4")
"""Element type of CBAR, and its stresses at the four points of end A, along the axis, at those of end B."""


_TURNED = 1e-3
"""How far recovered axes are from orthonormal by the seven digits of the files."""


def _pyyeti() -> Any:  # noqa: ANN401 - an optional library without types
    try:
        from pyyeti import nastran
    except ImportError:
        raise ComponentError(
            "files of Nastran need pyYeti; install fanfold with its extra: pip install 'fanfold[nastran]'"
        ) from None
    return nastran


def read_matrices(path: Path) -> dict[str, Any]:
    """Matrices of an op4 file by name; ComponentError where it is damaged."""
    nastran = _pyyeti()
    try:
        found = nastran.op4.read(str(path))
    except Exception as error:  # whatever pyYeti meets in a damaged file
        raise ComponentError(
            f"{path.name}: cannot be read as op4, it is damaged or cut off: {type(error).__name__}: {error}"
        ) from None
    if not found:
        raise ComponentError(f"{path.name}: holds no matrix; it is damaged or cut off")
    return dict(found)


def read_op4(path: Path, further: Mapping[str, Any]) -> FiniteElementData:
    """The data of an op4 file that holds everything, or of one with K and M alone and further matrices."""
    found = read_matrices(path)
    named = {name: found[short] for name, short in OP4_NAMES.items() if short in found}
    for name, others in {"stiffness": ("kxx", "kgg", "k"), "mass": ("mxx", "mgg", "m")}.items():
        short = next((other for other in others if other in found), None)
        if name not in named and short is not None:
            named[name] = found[short]
    lengths = {len(np.atleast_2d(matrix)) for name, matrix in named.items() if name in ("stiffness", "mass")}
    if len(lengths) > 1:
        raise ComponentError(
            f"{path.name}: stiffness and mass have {' and '.join(map(str, sorted(lengths)))} rows"
        )
    return from_matrices({**named, **further})


def write_op4(path: Path, matrices: Mapping[str, Any]) -> None:
    """Write matrices by their names of op4 files."""
    nastran = _pyyeti()
    named = {OP4_NAMES[name]: np.atleast_2d(matrix) for name, matrix in matrices.items()}
    named = {short: m.T if short == "smass" else m for short, m in named.items()}
    nastran.op4.write(str(path), named)


def read_superelement(path: Path) -> FiniteElementData:
    """An external superelement: its .asm, with the .op4 and, for recovery, the .pch of the same name beside it."""
    nastran = _pyyeti()
    matrices = read_matrices(_beside(path, ".op4"))
    try:
        uset, _, _ = nastran.asm2uset(str(path))
    except Exception as error:
        raise ComponentError(
            f"{path.name}: cannot be read as the assembly of an external superelement (EXTSEOUT with ASMBULK): {error}"
        ) from None
    nodes, coordinates, axes, dofs = _nodes(uset)
    missing = [name for name in ("kxx", "mxx") if name not in matrices]
    if missing:
        raise ComponentError(
            f"{path.with_suffix('.op4').name}: there is no matrix {' and no '.join(missing)}"
        )
    data = FiniteElementData(
        stiffness=sparse.csr_array(matrices["kxx"]),
        mass=sparse.csr_array(matrices["mxx"]),
        nodes=nodes,
        coordinates=coordinates,
        dofs=dofs,
        axes=axes,
    )
    punch = path.with_suffix(".pch")
    if not punch.is_file() or data.stiffness.shape[0] != len(dofs):
        return data
    stress = _stresses(nastran, punch, matrices)
    return FiniteElementData(
        **{**vars(data), "recovery": _recovery(nastran, punch, matrices, data), "stress": stress}
    )


def _beside(path: Path, ending: str) -> Path:
    found = path.with_suffix(ending)
    if not found.is_file():
        raise ComponentError(f"{found.name}: is not there; it belongs beside {path.name}")
    return found


def _nodes(uset: Any) -> tuple[Integers, Vector, Vector, Integers]:  # noqa: ANN401 - a pandas table
    """Numbers, basic coordinates, displacement axes and degrees of freedom of a table of pyYeti's `asm2uset`.

    Rows of a node: its place, its system, then origin and axes (as columns) of that system.
    """
    index = np.array(uset.index.to_list(), dtype=np.int64)
    values = uset.loc[:, "x":"z"].to_numpy(dtype=float)
    first = np.flatnonzero(index[:, 1] == 1)
    axes = np.array([values[row + 3 : row + 6].T for row in first]).reshape(-1, 3, 3)
    kinds = np.array([int(values[row + 1, 1]) for row in first])
    if np.any(kinds != 1):
        curved = index[first[kinds != 1][0], 0]
        raise ComponentError(
            f"node {curved} has cylindrical or spherical displacement axes; give attachment nodes rectangular ones"
        )
    dofs = np.where(index[:, 1] == 0, AMPLITUDE, index[:, 1])
    return index[first, 0], values[first], axes, np.column_stack([index[:, 0], dofs])


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
    return Recovery(np.array(nodes), np.array(places), sparse.csr_array(np.concatenate(motions)))


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


def _stresses(nastran: Any, punch: Path, matrices: Mapping[str, Any]) -> StressRows | None:  # noqa: ANN401
    """Stress recovery with the elements of the table TES1: type, number, how many components, first row."""
    rows = matrices.get("mes1")
    if rows is None or rows.shape[0] <= 1:
        return None
    return StressRows(_stress_labels(punch, len(rows)), np.asarray(rows))


def _stress_labels(punch: Path, count: int) -> tuple[str, ...]:
    """Element and component of every row."""
    labels = [f"row {k + 1}" for k in range(count)]
    for kind, element, components, first in _elements(punch):
        names = _BAR_STRESSES if kind == _BAR else tuple(str(k + 1) for k in range(components))
        for k in range(min(components, count - first + 1)):
            labels[first - 1 + k] = f"element {element} {names[k]}"
    return tuple(labels)


def _elements(punch: Path) -> list[tuple[int, int, int, int]]:
    """Quadruples of record 2 of the table TES1, in fixed fields of eight characters."""
    words: list[int] = []
    within = False
    for line in punch.read_text(encoding="latin-1").splitlines():
        if line.startswith("DTI"):
            within = line[8:16].strip() == "TES1" and line[16:24].strip() == "2"
            fields = line[24:72]
        else:
            fields = line[8:72]
        if within:
            parts = [fields[k : k + 8].strip() for k in range(0, len(fields), 8)]
            words += [int(part) for part in parts if part.lstrip("-").isdigit()]
    return [(words[k], words[k + 1], words[k + 2], words[k + 3]) for k in range(0, len(words) - 3, 4)]
