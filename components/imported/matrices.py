"""Named matrices, of whatever files, -> finite-element data, and the way back; npz files.

One set of names for all: `stiffness`, `mass` (n, n), `coordinates` (N, 4: node, x, y, z), `dofs` (n, 2: node and
component 1 to 6, 0 for amplitudes of modes); by choice `sample_masses` (Q,), `sample_positions` (Q, 3),
`sample_displacement` (3 Q, n), `recovered_nodes` (R, 4), `recovered_motion` (6 R, n), and rows (S, n) of outputs:
`stress`, `force`, `moment`, `force_per_length`, of which npz files also have `stress_labels` and so on. Names in op4
have eight letters.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ..contract.component import ComponentError, Vector
from ..flexible.finite_elements import OutputRows, SparseMatrix
from .data import AMPLITUDE, FiniteElementData, Integers, MassSamples, NodeTable, Recovery
from .files import OP4_NAMES, OUTPUTS
from .opening import arrays, reading
from .text.labelled import Entries, LabelledMatrix

Matrices = Mapping[str, Any]
_ENTRIES = "_entries"
_SQUARE = ("stiffness", "mass")
_TABLES = ("coordinates", "sample_masses", "sample_positions", "recovered_nodes")
_STORED = frozenset(
    (*OP4_NAMES, *(f"{name}{_ENTRIES}" for name in OP4_NAMES), *(f"{name}_labels" for name in OUTPUTS))
)
"""What is read of an npz file."""
_EMPTY = 100
"""Rows to an entry, beyond which a number of a row is damaged."""


def from_matrices(found: Matrices) -> FiniteElementData:
    """The data of named matrices; ComponentError where one is missing or has no possible shape."""
    missing = [name for name in ("stiffness", "mass", "coordinates") if name not in found]
    if missing:
        known = ", ".join(found) or "none"
        raise ComponentError(f"there is no matrix {' and no '.join(missing)}; matrices are {known}")
    table = _nodes(found)
    stiffness, mass, dofs = _square(found, table.nodes)
    # decks also list nodes without degrees of freedom, such as those that turn the sections of beams
    table = table.of(dofs[dofs[:, 1] != AMPLITUDE, 0])
    samples = recovery = None
    if "sample_masses" in found:
        samples = MassSamples(
            _dense(_needed(found, "sample_masses")).ravel(),
            _table(found, "sample_positions", 3),
            _sparse(_needed(found, "sample_displacement")),
        )
    if "recovered_nodes" in found:
        places = _table(found, "recovered_nodes", 4)
        motion = _sparse(_needed(found, "recovered_motion"))
        recovery = Recovery(_whole("recovered_nodes", places[:, 0]), places[:, 1:], motion)
    outputs = _outputs(found)
    return FiniteElementData(
        stiffness, mass, table.nodes, table.coordinates, dofs, samples, recovery, outputs, table.axes
    )


def _nodes(found: Matrices) -> NodeTable:
    if isinstance(found["coordinates"], NodeTable):
        return found["coordinates"]
    nodes = _table(found, "coordinates", 4)
    return NodeTable(_whole("coordinates", nodes[:, 0]), nodes[:, 1:], np.zeros((0, 3, 3)))


def _square(found: Matrices, nodes: Integers) -> tuple[SparseMatrix, SparseMatrix, Integers]:
    """Stiffness, mass, and their degrees of freedom: their own, those that are given, or all of the nodes in order."""
    stiffness, mass = found["stiffness"], found["mass"]
    both = isinstance(stiffness, LabelledMatrix), isinstance(mass, LabelledMatrix)
    if any(both):
        if not all(both) or "dofs" in found:
            raise ComponentError(
                "stiffness and mass must both name the node and component of their entries, and then dofs is not "
                "given; take both matrices from one program"
            )
        return stiffness.matrix, mass.on(stiffness.dofs), stiffness.dofs
    dofs = _listed(found) if "dofs" in found else None
    if dofs is not None and isinstance(stiffness, Entries) and stiffness.count < len(dofs):
        raise ComponentError(
            f"{stiffness.file}: has {stiffness.count} rows, and {len(dofs)} degrees of freedom are listed; one of the "
            "files is cut off"
        )
    listed = [matrix for matrix in (stiffness, mass) if isinstance(matrix, Entries)]
    count = max((matrix.count for matrix in listed), default=0) if dofs is None else len(dofs)
    stiffness, mass = (
        matrix.matrix(count) if isinstance(matrix, Entries) else _sparse(matrix)
        for matrix in (stiffness, mass)
    )
    return stiffness, mass, _in_order(nodes, stiffness.shape[0]) if dofs is None else dofs


def _listed(found: Matrices) -> Any:  # noqa: ANN401 - integers
    """Node and component of every row; of a column of nodes, as Ansys writes it, all three or six of each."""
    if found["dofs"].shape[1:] != (1,):
        return _whole("dofs", _table(found, "dofs", 2))
    stiffness = found["stiffness"]
    rows = stiffness.count if isinstance(stiffness, Entries) else stiffness.shape[0]
    return _in_order(_whole("dofs", _table(found, "dofs", 1)[:, 0]), rows)


def _outputs(found: Matrices) -> OutputRows | None:
    """Rows of all outputs, one quantity after the other."""
    labels: list[str] = []
    units: list[str] = []
    rows: list[Vector] = []
    for name, unit in OUTPUTS.items():
        if name not in found:
            continue
        own = np.atleast_2d(_dense(found[name]))
        given = found.get(f"{name}_labels")
        told = [f"{name} {k + 1}" for k in range(len(own))] if given is None else np.ravel(given).tolist()
        if len(told) != len(own):
            raise ComponentError(f"{name} has {len(own)} rows and {len(told)} labels; give one for each")
        labels += map(str, told)
        units += [unit] * len(own)
        rows.append(own)
    if len({own.shape[1] for own in rows}) > 1:
        raise ComponentError(f"{', '.join(name for name in OUTPUTS if name in found)} differ in columns")
    return OutputRows(tuple(labels), tuple(units), np.vstack(rows)) if rows else None


def to_matrices(data: FiniteElementData) -> dict[str, Any]:
    """Inverse of `from_matrices`, without labels of outputs, which are sorted by quantity."""
    found: dict[str, Any] = {
        "stiffness": data.stiffness.toarray(),
        "mass": data.mass.toarray(),
        "coordinates": np.column_stack([data.nodes, data.coordinates]),
        "dofs": data.dofs.astype(float),
    }
    if (samples := data.samples) is not None:
        found |= {"sample_masses": samples.masses, "sample_positions": samples.positions}
        found["sample_displacement"] = samples.displacement.toarray()
    if (recovery := data.recovery) is not None:
        found["recovered_nodes"] = np.column_stack([recovery.nodes, recovery.coordinates])
        found["recovered_motion"] = recovery.motion.toarray()
    if (outputs := data.outputs) is not None:
        found |= {name: outputs.rows[own] for name, own in _quantities(outputs).items()}
    return found


def _quantities(outputs: OutputRows) -> dict[str, Any]:
    """Numbers of the rows of each quantity that there is."""
    units = np.array(outputs.units)
    return {name: np.flatnonzero(units == unit) for name, unit in OUTPUTS.items() if unit in outputs.units}


def write_npz(path: Path, data: FiniteElementData) -> None:
    """Write all matrices to an npz file."""
    found = to_matrices(data)
    if data.outputs is not None:
        names = np.array(data.outputs.labels)
        found |= {f"{name}_labels": names[own] for name, own in _quantities(data.outputs).items()}
    np.savez_compressed(path, allow_pickle=False, **found)


def _needed(found: Matrices, name: str) -> Any:  # noqa: ANN401 - dense or sparse
    if name not in found:
        raise ComponentError(f"there is no matrix {name}; matrices are {', '.join(found)}")
    return found[name]


def _sparse(matrix: Any) -> SparseMatrix:  # noqa: ANN401 - dense or sparse
    if not scipy.sparse.issparse(matrix) and np.ndim(matrix) != 2:
        raise ComponentError(f"a matrix has {np.ndim(matrix)} dimensions; it must have two")
    return scipy.sparse.csr_array(_real(matrix), dtype=float)


def _dense(matrix: Any) -> Vector:  # noqa: ANN401 - dense or sparse
    dense = (
        matrix.toarray() if isinstance(matrix, scipy.sparse.coo_array | scipy.sparse.csr_array) else matrix
    )
    return np.array(_real(dense), dtype=np.float64)


def _real(matrix: Any) -> Any:  # noqa: ANN401 - dense or sparse
    """A matrix without the imaginary part of zero that it may have; ComponentError for any other."""
    if not np.iscomplexobj(matrix):
        return matrix
    share = abs(matrix.imag).max() / max(abs(matrix).max(), np.finfo(float).tiny)
    if share > 0.0:
        raise ComponentError(
            f"a matrix is complex, with imaginary parts up to {share:.3g} of its largest entry; give its real part, "
            "and damping as modal_damping_ratio or structural_damping"
        )
    return matrix.real


def _table(found: Matrices, name: str, columns: int) -> Vector:
    table = _dense(_needed(found, name))
    if table.ndim != 2 or table.shape[1] != columns:
        raise ComponentError(f"{name} is {' x '.join(map(str, table.shape))}; it must have {columns} columns")
    return table


def _whole(name: str, values: Vector) -> Any:  # noqa: ANN401 - integers of any shape
    if not np.array_equal(values, np.round(values)):
        raise ComponentError(f"{name}: a number is not whole")
    return values.astype(np.int64)


def _in_order(nodes: Integers, count: int) -> Any:  # noqa: ANN401 - integers
    """Degrees of freedom of the nodes in their order, all three or all six."""
    for each in (3, 6):
        if count == each * len(nodes):
            return np.column_stack([np.repeat(nodes, each), np.tile(np.arange(1, each + 1), len(nodes))])
    raise ComponentError(
        f"{len(nodes)} nodes do not have {count} degrees of freedom, neither 3 nor 6 each; give dofs: node and "
        "component of every row"
    )


def read_npz(path: Path) -> FiniteElementData:
    """The data of an npz file, whose matrices are dense, or NAME_entries with row, column (from 1) and value."""
    with reading(path, "npz"):
        found: dict[str, Any] = dict(arrays(path, _STORED))
    entries = (name for name in found if name.endswith(_ENTRIES))
    # stiffness and mass first, as other matrices have as many columns
    for name in sorted(entries, key=lambda one: one.removesuffix(_ENTRIES) not in _SQUARE):
        found[name.removesuffix(_ENTRIES)] = _from_entries(name, found.pop(name), found)
    return from_matrices(found)


def _from_entries(name: str, entries: Vector, found: Matrices) -> scipy.sparse.coo_array:
    """A sparse matrix of its entries (k, 3)."""
    if np.ndim(entries) != 2 or np.shape(entries)[1] != 3 or not len(entries):
        raise ComponentError(f"{name} is {np.shape(entries)}; it must have three columns: row, column, value")
    rows, columns = _whole(name, entries[:, 0]) - 1, _whole(name, entries[:, 1]) - 1
    if min(rows.min(), columns.min()) < 0:
        raise ComponentError(f"{name}: rows and columns count from 1")
    height, count = _shape(name.removesuffix(_ENTRIES), int(rows.max()) + 1, int(columns.max()) + 1, found)
    if count > len(entries) * _EMPTY:
        raise ComponentError(f"{name}: an entry is in row or column {count}, and there are {len(entries)}")
    if columns.max() >= count or rows.max() >= height:
        raise ComponentError(
            f"{name}: an entry is in row {rows.max() + 1} and column {columns.max() + 1}, and there are {height} rows "
            f"and {count} columns"
        )
    return scipy.sparse.coo_array((entries[:, 2], (rows, columns)), shape=(height, count))


def _shape(matrix: str, last_row: int, last_column: int, found: Matrices) -> tuple[int, int]:
    """Rows and columns of a matrix whose entries reach to these, counted from 1.

    Square ones have as many as `dofs`; others have as many rows as labels, and columns as `dofs` or the stiffness, but
    for tables, whose columns are no degrees of freedom.
    """
    dofs = len(found["dofs"]) if "dofs" in found else None
    if matrix in _SQUARE:
        size = max(last_row, last_column) if dofs is None else dofs
        return size, size
    labels = found.get(f"{matrix}_labels")
    height = last_row if labels is None else np.size(labels)
    if matrix in _TABLES:
        return height, last_column
    if dofs is None and np.ndim(found.get("stiffness", 0)) == 2:
        dofs = found["stiffness"].shape[1]
    return height, last_column if dofs is None else dofs
