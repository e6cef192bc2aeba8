"""Nastran's external superelements and op4 matrices, read by pyYeti, as finite-element data."""

from __future__ import annotations

import tempfile
from collections.abc import Container, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ..cache.disk import users_folder
from ..contract.component import ComponentError, Vector
from .data import AMPLITUDE, FiniteElementData, Integers
from .files import OP4_NAMES
from .matrices import from_matrices, to_matrices
from .nastran_recovery import with_recovery

_OTHERS = {
    "stiffness": ("kxx", "kaax", "kgg", "k2gg", "khh", "k"),
    "mass": ("mxx", "maax", "mgg", "m2gg", "mhh", "m"),
}
"""What Nastran may call the matrices instead."""
_OF_SUPERELEMENTS = ("kaa", "maa", "baa", "k4xx", "pa", "gpxx", "gdxx", "rvax", "va", "mug1")
"""Matrices of external superelements that are written, in Nastran's order; those we have not are empty."""
_FIRST_AMPLITUDE = 1_000_001
"""Number of the first scalar point; nodes come before."""


def pyyeti() -> Any:  # noqa: ANN401 - an optional library without types
    """Its package for Nastran; ComponentError where it is not installed."""
    try:
        return import_module("pyyeti.nastran")
    except RuntimeError:
        # numba keeps what it compiles beside a library or at home, neither of which may be there to be written to
        import_module("numba").config.CACHE_DIR = str(users_folder() or tempfile.gettempdir())
        return import_module("pyyeti.nastran")
    except ImportError:
        raise ComponentError(
            "files of Nastran need pyYeti; install fanfold with its extra: pip install 'fanfold[nastran]'"
        ) from None


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
    return from_matrices({**named(path, read_matrices(path), further), **further})


def named(path: Path, found: Mapping[str, Any], given: Container[str] = ()) -> dict[str, Any]:
    """Matrices by our names, from their names in files of Nastran; `given` are those that come from elsewhere.

    ComponentError where K or M is in neither.
    """
    known = {name: found[short] for name, short in OP4_NAMES.items() if short in found}
    for name, others in _OTHERS.items():
        short = next((other for other in others if other in found), None)
        if name not in known and short is not None:
            known[name] = found[short]
    missing = [name for name in ("stiffness", "mass") if name not in known and name not in given]
    if missing:
        sought = " and ".join(f"{name} ({', '.join((OP4_NAMES[name], *_OTHERS[name]))})" for name in missing)
        raise ComponentError(
            f"{path.name}: there is no matrix of {sought}; matrices are {', '.join(found) or 'none'}"
        )
    return known


def write_op4(path: Path, data: FiniteElementData) -> None:
    """Write all matrices by their names of op4 files."""
    pyyeti().op4.write(str(path), _short_names(data))


def _short_names(data: FiniteElementData) -> dict[str, Vector]:
    named = {OP4_NAMES[name]: np.atleast_2d(matrix) for name, matrix in to_matrices(data).items()}
    return {short: matrix.T if short == "smass" else matrix for short, matrix in named.items()}


def write_superelement(path: Path, data: FiniteElementData, number: int = 101) -> None:
    """Write reduced data, attachment components first, as an external superelement: .asm, .op4, .pch beside each other.

    Recovered nodes are its displacement recovery. Behind what Nastran reads, the op4 has all that ours have, in full
    digits; the nodes of the .asm have eight behind the point.
    """
    nastran, uset = pyyeti(), None
    for node, place in zip(data.nodes.tolist(), data.coordinates, strict=True):
        uset = nastran.addgrid(uset, node, "b", 0, place, 0)
    extra = _short_names(data)
    if (recovery := data.recovery) is not None:
        extra["mug1"] = recovery.motion.toarray()
        extra["tug1"] = np.column_stack(
            [np.repeat(recovery.nodes, 6), np.tile(np.arange(1, 7), len(recovery.nodes))]
        )
    nastran.wtextseout(
        str(path.with_suffix("")),
        se=number,
        bset=np.arange(6 * len(data.nodes)),
        uset=uset,
        spoint1=_FIRST_AMPLITUDE,
        namelist=[*_OF_SUPERELEMENTS, *(name for name in extra if name not in (*_OF_SUPERELEMENTS, "tug1"))],
        **extra,
    )


def read_superelement(path: Path) -> FiniteElementData:
    """An external superelement: its .asm, with the .op4 and, for recovery, the .pch of the same name beside it."""
    nastran = pyyeti()
    matrices = read_matrices(_beside(path, ".op4"))
    try:
        whole, kept = (nastran.asm2uset(str(path), try_rdextrn=reduced)[0] for reduced in (False, True))
    except Exception as error:
        raise ComponentError(
            f"{path.name}: cannot be read as the assembly of an external superelement (EXTSEOUT with ASMBULK): {error}"
        ) from None
    nodes, coordinates, axes = nodes_of(whole)
    dofs = dofs_of(kept)  # by the .pch, of all six components or fewer
    known = named(path.with_suffix(".op4"), matrices)
    if "dofs" in known:
        return _own(path, known, dofs)
    data = FiniteElementData(
        stiffness=scipy.sparse.csr_array(known["stiffness"]),
        mass=scipy.sparse.csr_array(known["mass"]),
        nodes=nodes,
        coordinates=coordinates,
        dofs=dofs,
        axes=axes,
    )
    punch = path.with_suffix(".pch")
    if data.stiffness.shape[0] != len(dofs):
        raise ComponentError(
            f"{path.name} lists {len(dofs)} degrees of freedom, and the matrices of {path.with_suffix('.op4').name} "
            f"have {data.stiffness.shape[0]} rows; the files are not of one superelement"
        )
    if not punch.is_file():
        return data
    try:
        return with_recovery(data, nastran, punch, matrices)
    except (ValueError, OSError) as error:
        raise ComponentError(f"{punch.name}: its tables of recovered rows cannot be read: {error}") from None


def _own(path: Path, known: Mapping[str, Any], dofs: Integers) -> FiniteElementData:
    """What we wrote ourselves, of whose matrices the assembly must be."""
    data = from_matrices(known)
    moving = [rows[rows[:, 1] != AMPLITUDE] for rows in (data.dofs, dofs)]
    if len(data.dofs) != len(dofs) or not np.array_equal(*moving):
        raise ComponentError(f"{path.name} and {path.with_suffix('.op4').name} are not of one superelement")
    return data


def _beside(path: Path, ending: str) -> Path:
    found = path.with_suffix(ending)
    if not found.is_file():
        raise ComponentError(f"{found.name}: is missing; put it next to {path.name}")
    return found


def dofs_of(uset: Any) -> Integers:  # noqa: ANN401 - a pandas table
    """Node and component (n, 2) of the rows of such a table, 0 of scalar points."""
    index = np.array(uset.index.to_list(), dtype=np.int64)
    return np.column_stack([index[:, 0], np.where(index[:, 1] == 0, AMPLITUDE, index[:, 1])])


def nodes_of(uset: Any) -> tuple[Integers, Vector, Vector]:  # noqa: ANN401 - a pandas table
    """Numbers, basic coordinates and displacement axes of a table of pyYeti's `asm2uset`.

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
    return index[first, 0], values[first], axes
