"""Matrices and nodes of Nastran's bulk data (DMIG, GRID), and matrices of op2 files, read by pyYeti."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ..contract.component import ComponentError
from .data import FiniteElementData, NodeTable
from .matrices import from_matrices
from .nastran import named, nodes_of, pyyeti
from .text.labelled import LabelledMatrix

_DAMAGED = "it is damaged or cut off"
_AXES_OF_GRDSET = (1, 5)
"""Its fields with the systems of places and of displacements."""


def read_bulk(path: Path, further: Mapping[str, Any]) -> FiniteElementData:
    """Stiffness and mass as DMIG in bulk data, nodes from GRID entries there unless they are given."""
    found = read_dmig(path)
    if not found:
        raise ComponentError(f"{path.name}: has no DMIG; it is no punched matrix, or cut off")
    nodes = {} if "coordinates" in further else {"coordinates": read_grids(path)}
    return from_matrices({**named(path, found, further), **nodes, **further})


def read_op2(path: Path, further: Mapping[str, Any]) -> FiniteElementData:
    """Stiffness and mass of an op2 file, as DMIG with nodes and components, or as matrices of OUTPUT2 without."""
    found: Mapping[str, Any] = read_dmig(path)
    if not found:
        try:
            found = pyyeti().op2.rdmats(str(path), lower=True)
        except Exception as error:  # whatever pyYeti meets in a damaged file
            raise ComponentError(f"{path.name}: cannot be read as op2, {_DAMAGED}: {_told(error)}") from None
    return from_matrices({**named(path, found, further), **further})


def read_grids(path: Path) -> NodeTable:
    """Nodes of GRID entries with their displacement axes, from CORD2R; ComponentError where there are none."""
    try:
        _refuse_default_axes(path)
        uset = pyyeti().bulk2uset(str(path))[0]
        found = None if uset is None or not len(uset) else nodes_of(uset)
    except ComponentError:
        raise
    except Exception as error:  # whatever pyYeti meets in a damaged file
        raise ComponentError(f"{path.name}: its GRID entries cannot be read: {_told(error)}") from None
    if found is None:
        raise ComponentError(
            f"{path.name}: has no GRID; give coordinates, a file with GRID entries or columns of node, x, y, z"
        )
    return NodeTable(*found)


def _refuse_default_axes(path: Path) -> None:
    """ComponentError where nodes without axes of their own have those of a GRDSET, which pyYeti does not know."""
    for fields in pyyeti().rdcards(str(path), "grdset", return_var="list", no_data_return=[]):
        if any(fields[k : k + 1] not in ([], [""], [0]) for k in _AXES_OF_GRDSET):
            raise ComponentError(
                f"{path.name}: GRDSET gives nodes axes, which are not read; write CP and CD into the GRID entries"
            )


def _told(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def read_dmig(path: Path) -> dict[str, LabelledMatrix]:
    """Square real DMIG by name, of bulk data or an op2; ComponentError where they cannot be read."""
    try:
        frames = pyyeti().rddmig(str(path))
    except Exception as error:  # whatever pyYeti meets in a damaged file
        raise ComponentError(f"{path.name}: its DMIG cannot be read, {_DAMAGED}: {_told(error)}") from None
    found = {}
    for name, frame in (frames or {}).items():
        values = frame.to_numpy()
        if frame.columns.nlevels != 2 or not frame.index.equals(frame.columns) or np.iscomplexobj(values):
            continue
        dofs = np.array(frame.index.to_list(), dtype=np.int64)
        found[name] = LabelledMatrix(path.name, dofs, scipy.sparse.csr_array(values))
    return found
