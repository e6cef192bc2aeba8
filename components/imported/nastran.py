"""Nastran's external superelements and op4 matrices, read by pyYeti, as finite-element data."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from ..contract.component import ComponentError, Vector
from .data import AMPLITUDE, FiniteElementData, Integers
from .files import OP4_NAMES
from .matrices import from_matrices
from .nastran_recovery import with_recovery

_OTHERS = {
    "stiffness": ("kxx", "kaax", "kgg", "k2gg", "khh", "k"),
    "mass": ("mxx", "maax", "mgg", "m2gg", "mhh", "m"),
}
"""What Nastran may call the matrices instead."""


def pyyeti() -> Any:  # noqa: ANN401 - an optional library without types
    """Its package for Nastran; ComponentError where it is not installed."""
    try:
        from pyyeti import nastran
    except ImportError:
        raise ComponentError(
            "files of Nastran need pyYeti; install fanfold with its extra: pip install 'fanfold[nastran]'"
        ) from None
    return nastran


def read_matrices(path: Path) -> dict[str, Any]:
    """Matrices of an op4 file by name; ComponentError where it is damaged."""
    nastran = pyyeti()
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
    return from_matrices({**named(path, read_matrices(path)), **further})


def named(path: Path, found: Mapping[str, Any]) -> dict[str, Any]:
    """Matrices by our names, from their names in files of Nastran; ComponentError where K and M differ in size."""
    known = {name: found[short] for name, short in OP4_NAMES.items() if short in found}
    for name, others in _OTHERS.items():
        short = next((other for other in others if other in found), None)
        if name not in known and short is not None:
            known[name] = found[short]
    missing = [name for name in ("stiffness", "mass") if name not in known]
    if missing:
        sought = " and ".join(f"{name} ({', '.join((OP4_NAMES[name], *_OTHERS[name]))})" for name in missing)
        raise ComponentError(
            f"{path.name}: there is no matrix of {sought}; matrices are {', '.join(found) or 'none'}"
        )
    lengths = {len(np.atleast_2d(known[name])) for name in ("stiffness", "mass")}
    if len(lengths) > 1:
        raise ComponentError(
            f"{path.name}: stiffness and mass have {' and '.join(map(str, sorted(lengths)))} rows"
        )
    return known


def write_op4(path: Path, matrices: Mapping[str, Any]) -> None:
    """Write matrices by their names of op4 files."""
    nastran = pyyeti()
    named = {OP4_NAMES[name]: np.atleast_2d(matrix) for name, matrix in matrices.items()}
    named = {short: m.T if short == "smass" else m for short, m in named.items()}
    nastran.op4.write(str(path), named)


def read_superelement(path: Path) -> FiniteElementData:
    """An external superelement: its .asm, with the .op4 and, for recovery, the .pch of the same name beside it."""
    nastran = pyyeti()
    matrices = read_matrices(_beside(path, ".op4"))
    try:
        uset, _, _ = nastran.asm2uset(str(path))
    except Exception as error:
        raise ComponentError(
            f"{path.name}: cannot be read as the assembly of an external superelement (EXTSEOUT with ASMBULK): {error}"
        ) from None
    nodes, coordinates, axes, dofs = nodes_of(uset)
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
    try:
        return with_recovery(data, nastran, punch, matrices)
    except (ValueError, OSError) as error:
        raise ComponentError(f"{punch.name}: its tables of recovered rows cannot be read: {error}") from None


def _beside(path: Path, ending: str) -> Path:
    found = path.with_suffix(ending)
    if not found.is_file():
        raise ComponentError(f"{found.name}: is not there; it belongs beside {path.name}")
    return found


def nodes_of(uset: Any) -> tuple[Integers, Vector, Vector, Integers]:  # noqa: ANN401 - a pandas table
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
