"""Matrices as other programs write them: numbers of our own models. What CalculiX itself wrote is in `calculix`.

A model is dofs (n, 2), nodes (N,), places (N, 3), K and M (n, n). Each writer renumbers equations as its program might.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
from scipy import io, sparse

from components.imported.nastran import write_op4


def _renumbered(data, seed=7):
    """Another order of the equations: dofs, K, M as dense arrays."""
    order = np.random.default_rng(seed).permutation(len(data.dofs))
    return data.dofs[order], *(m.toarray()[np.ix_(order, order)] for m in (data.stiffness, data.mass))


def _triangle(matrix):
    """Row, column (from 0) and value of the lower triangle, column by column, the diagonal whole."""
    for column in range(len(matrix)):
        for row in range(column, len(matrix)):
            if row == column or matrix[row, column]:
                yield row, column, matrix[row, column]


def calculix(folder, data):
    """job.sti, .mas, .dof of *FREQUENCY, SOLVER=MATRIXSTORAGE and the nodes of job.inp."""
    dofs, stiffness, mass = _renumbered(data)
    for ending, matrix in ((".sti", stiffness), (".mas", mass)):
        rows = (f"{column + 1} {row + 1} {value:20.13e}\n" for row, column, value in _triangle(matrix))
        (folder / f"job{ending}").write_text("".join(rows))
    (folder / "job.dof").write_text("".join(f"{node}.{component}\n" for node, component in dofs))
    half = len(data.nodes) // 2
    (folder / "more.inc").write_text("*Node, nset=more\n" + _inp_rows(data, slice(half, None)))
    (folder / "job.inp").write_text(
        f"** a comment\n*HEADING\nframe\n*NODE, NSET=all\n{_inp_rows(data, slice(half))}*INCLUDE, INPUT=more.inc\n"
        "*NODE\n999, 7.5, 8.5\n*ELEMENT, TYPE=U1\n1, 1, 2\n*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n1\n"
        "*NODE FILE\nU\n*END STEP\n"
    )
    return folder / "job.sti"


def _inp_rows(data, part):
    rows = zip(data.nodes[part].tolist(), data.coordinates[part].tolist(), strict=True)
    return "".join(f"{node}, {x!r}, {y!r}, {z!r}\n" for node, (x, y, z) in rows)


def entries_by_node(folder, data):
    """Node and component of row and column, and value: one triangle, no zeros."""
    for name, matrix in (("STIF1", data.stiffness.toarray()), ("MASS1", data.mass.toarray())):
        rows = (
            f"{data.dofs[i, 0]},{data.dofs[i, 1]}, {data.dofs[j, 0]},{data.dofs[j, 1]}, {value:24.16e}\n"
            for i, j, value in _triangle(matrix)
            if value
        )
        (folder / f"job_{name}.txt").write_text("**\n** matrix\n**\n" + "".join(rows))
    (folder / "job.inp").write_text(
        "*Heading\n*Node\n" + _inp_rows(data, slice(None)) + "*Element, type=B31\n1, 1, 2\n"
    )
    return {
        "stiffness": folder / "job_STIF1.txt",
        "mass": folder / "job_MASS1.txt",
        "coordinates": folder / "job.inp",
    }


def entries_by_row(folder, data):
    """Row, column, value: both triangles, nodes in order."""
    for name, matrix in (("STIF1", data.stiffness), ("MASS1", data.mass)):
        entries = sparse.coo_array(matrix)
        np.savetxt(
            folder / f"c_{name}.txt",
            np.column_stack([entries.row + 1, entries.col + 1, entries.data]),
            "%d %d %.16e",
        )
    (folder / "c.inp").write_text("*Node\n" + _inp_rows(data, slice(None)))
    return {
        "stiffness": folder / "c_STIF1.txt",
        "mass": folder / "c_MASS1.txt",
        "coordinates": folder / "c.inp",
    }


def dmig(path, data, names=("KAAX", "MAAX"), nodes=True):
    """DMIG punched in fields of 16 with ten digits, GRID entries before them."""
    lines = []
    if nodes:
        for node, place in zip(data.nodes.tolist(), data.coordinates.tolist(), strict=True):
            fields = "".join(f"{value:16.9E}" for value in place[:2])
            lines += [f"GRID*   {node:16d}{0:16d}{fields}", f"*       {place[2]:16.9E}{0:16d}"]
    for name, matrix in zip(names, (data.stiffness.toarray(), data.mass.toarray()), strict=True):
        lines.append(f"DMIG    {name:8}{0:8d}{6:8d}{2:8d}{0:8d}{'':16}{len(matrix):8d}")
        for column in range(len(matrix)):
            node, component = data.dofs[column]
            lines.append(f"DMIG*   {name:16}{'':16}{node:16d}{component:16d}"[:72].rstrip())
            lines[-1] = f"DMIG*   {name:16}{node:16d}{component:16d}"
            for row in range(column, len(matrix)):
                if matrix[row, column]:
                    other, direction = data.dofs[row]
                    lines.append(f"*       {other:16d}{direction:16d}{matrix[row, column]:16.9E}")
    path.write_text("\n".join(lines) + "\n")
    return path


def op2(path, matrices):
    """OUTPUT2 matrices of double precision by name, dense columns, 32-bit little-endian records."""
    out = bytearray()

    def record(content):
        out.extend(struct.pack("<i", len(content)) + content + struct.pack("<i", len(content)))

    def keys(*values):
        for value in values:
            record(struct.pack("<i", value))

    def words(values):
        keys(len(values))
        record(struct.pack(f"<{len(values)}i", *values))

    words((11, 23, 26))
    keys(7)
    record(b"NASTRAN FORT TAPE ID CODE - ")
    keys(2)
    record(b"XXXXXXXX")
    keys(-1, 0)
    for name, matrix in matrices.items():
        rows, columns = matrix.shape
        keys(2)
        record(f"{name.upper():8}".encode())
        keys(-1)
        words((101, columns, rows, 6, 2, rows, 10000))
        keys(-2, 1, 0)
        keys(2)
        record(f"{name.upper():8}".encode())
        keys(-3, 1, 1)
        for k, column in enumerate(matrix.T):
            keys(1 + 2 * rows)
            record(struct.pack(f"<i{rows}d", 1, *column))
            keys(-4 - k, 1, 1 if k + 1 < columns else 0)
        keys(0)
    keys(0)
    Path(path).write_bytes(out)
    return path


def columns(folder, data):
    """node, x, y, z in a table."""
    path = folder / "nodes.csv"
    np.savetxt(
        path,
        np.column_stack([data.nodes, data.coordinates]),
        "%d, %.17g, %.17g, %.17g",
        header="node, x, y, z",
    )
    return path


def _op2(folder, data):
    path = op2(folder / "job.op2", {"kgg": data.stiffness.toarray(), "mgg": data.mass.toarray()})
    return {"file": path, "coordinates": columns(folder, data)}


def _op4(folder, data):
    write_op4(folder / "job.op4", data)
    return folder / "job.op4"


def _matrix_market(folder, data):
    """One triangle with a heading that says so."""
    paths = {name: folder / f"{name}.mmf" for name in ("stiffness", "mass")}
    for name, path in paths.items():
        with path.open("wb") as file:
            io.mmwrite(file, sparse.coo_array(getattr(data, name)), symmetry="symmetric", precision=17)
    return {**paths, "coordinates": columns(folder, data)}


WRITERS = {
    "calculix": (calculix, 1e-13),
    "entries by node": (entries_by_node, 1e-15),
    "entries by row": (entries_by_row, 1e-15),
    "matrix market": (_matrix_market, 1e-15),
    "nastran, dmig": (lambda folder, data: dmig(folder / "job.pch", data), 1e-9),
    "nastran, op2": (_op2, 0.0),
    "nastran, op4": (_op4, 0.0),
}
"""With the digits that the program writes, of the largest entry."""
