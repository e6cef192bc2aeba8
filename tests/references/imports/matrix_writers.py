"""Matrices as other programs write them, from their manuals: numbers of our own models, none of their output.

A model is dofs (n, 2), nodes (N,), places (N, 3), K and M (n, n). Each writer renumbers equations as its program might.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
from scipy import io, sparse

from components.imported.nastran import write_op4

NAMES = ("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")


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


def abaqus_matrix_input(folder, data):
    """*MATRIX OUTPUT, FORMAT=MATRIX INPUT: nodes and degrees of freedom, one triangle, no zeros."""
    for name, matrix in (("STIF1", data.stiffness.toarray()), ("MASS1", data.mass.toarray())):
        rows = (
            f"{data.dofs[i, 0]},{data.dofs[i, 1]}, {data.dofs[j, 0]},{data.dofs[j, 1]}, {value:24.16e}\n"
            for i, j, value in _triangle(matrix)
            if value
        )
        (folder / f"job_{name}.mtx").write_text("**\n** matrix\n**\n" + "".join(rows))
    (folder / "job.inp").write_text(
        "*Heading\n*Node\n" + _inp_rows(data, slice(None)) + "*Element, type=B31\n1, 1, 2\n"
    )
    return {
        "stiffness": folder / "job_STIF1.mtx",
        "mass": folder / "job_MASS1.mtx",
        "coordinates": folder / "job.inp",
    }


def abaqus_coordinate(folder, data):
    """*MATRIX OUTPUT, FORMAT=COORDINATE: rows and columns, both triangles, nodes in order."""
    for name, matrix in (("STIF1", data.stiffness), ("MASS1", data.mass)):
        entries = sparse.coo_array(matrix)
        np.savetxt(
            folder / f"c_{name}.mtx",
            np.column_stack([entries.row + 1, entries.col + 1, entries.data]),
            "%d %d %.16e",
        )
    (folder / "c.inp").write_text("*Node\n" + _inp_rows(data, slice(None)))
    return {
        "stiffness": folder / "c_STIF1.mtx",
        "mass": folder / "c_MASS1.mtx",
        "coordinates": folder / "c.inp",
    }


def abaqus_substructure(folder, data):
    """*SUBSTRUCTURE MATRIX OUTPUT, OUTPUT FILE=USER DEFINED: all components at every node, rows of four numbers."""
    numbers = [
        ", ".join(f"{node:9d}" for node in data.nodes[k : k + 10]) for k in range(0, len(data.nodes), 10)
    ]
    lines = [
        "**",
        "** SUBSTRUCTURE",
        f"*USER ELEMENT, NODES={len(data.nodes):10d}, LINEAR",
        "** ELEMENT NODES",
    ]
    lines += [f"** {row}," for row in numbers]
    lines += ["         1,         2,         3,         4,         5,         6"]
    for name, matrix in (("STIFFNESS", data.stiffness.toarray()), ("MASS", data.mass.toarray())):
        lines.append(f"*MATRIX,TYPE={name}")
        for row in range(len(matrix)):
            values = [f"{value:24.16e}" for value in matrix[row, : row + 1]]
            lines += [", ".join(values[k : k + 4]) + "," for k in range(0, len(values), 4)]
    (folder / "sub.mtx").write_text("\n".join(lines) + "\n")
    return {"file": folder / "sub.mtx", "coordinates": columns(folder, data)}


def calculix_substructure(folder, data):
    """The same of CalculiX, which lists a node for every degree of freedom, and no mass: that of *FREQUENCY."""
    (folder / "job.inp").write_text("*NODE\n" + _inp_rows(data, slice(None)))
    nodes, matrix = data.dofs[:, 0], data.stiffness.toarray()
    lines = [
        "**",
        "** GENERATION OF SUBSTRUCTURE",
        f"*USER ELEMENT,NODES= {len(nodes):10d},LINEAR",
        "** ELEMENT NODES",
    ]
    lines += ["**" + "".join(f"{node:10d}," for node in nodes[k : k + 10]) for k in range(0, len(nodes), 10)]
    lines += [f"{data.dofs[0, 1]:10d}", *(f"{k:10d},{c:10d}" for k, c in enumerate(data.dofs[1:, 1], 2))]
    lines.append("*MATRIX,TYPE=STIFFNESS")
    for column in range(len(matrix)):
        values = [f"{value:20.13e}," for value in matrix[: column + 1, column]]
        lines += ["".join(values[k : k + 4]) for k in range(0, len(values), 4)]
    (folder / "sub.mtx").write_text("\n".join(lines) + "\n")
    labels = (f"{a} {b} {c} {d} {v:.16e}\n" for (a, b), (c, d), v in _labelled(data))
    (folder / "mass.txt").write_text("".join(labels))
    return {"stiffness": folder / "sub.mtx", "mass": folder / "mass.txt", "coordinates": folder / "job.inp"}


def _labelled(data):
    """Node and component of row and column, and value, of the mass."""
    entries = sparse.coo_array(data.mass)
    for row, column, value in zip(entries.row, entries.col, entries.data, strict=True):
        yield data.dofs[row], data.dofs[column], value


def _fortran(values, form, each):
    """Lines of so many fields each."""
    words = [format(value, form).replace("e", "D") for value in values]
    return ["".join(words[k : k + each]) + "\n" for k in range(0, len(words), each)]


def _harwell_boeing(path, matrix, right_hand_side):
    """RSA: pointers, rows and values of the lower triangle column by column; a load behind."""
    entries = list(_triangle(matrix))
    counts = np.bincount([column for _, column, _ in entries], minlength=len(matrix))
    pointers = _fortran(np.concatenate([[1], 1 + np.cumsum(counts)]).tolist(), "14d", 1)
    rows = _fortran([row + 1 for row, _, _ in entries], "14d", 1)
    values = _fortran([value for _, _, value in entries], "25.16e", 3)
    loads = _fortran([0.0] * len(matrix), "25.16e", 3) if right_hand_side else []
    parts = [len(lines) for lines in (pointers, rows, values, loads)]
    head = [
        f"{'a frame':72}{'KEY':8}\n",
        "".join(f"{n:14d}" for n in (sum(parts), *parts)) + "\n",
        f"{'RSA':14}" + "".join(f"{n:14d}" for n in (len(matrix), len(matrix), len(entries), 0)) + "\n",
        f"{'(1I14)':16}{'(1I14)':16}{'(1P,3D25.16)':20}{'(1P,3D25.16)':20}\n",
    ]
    if right_hand_side:
        head.append(f"{'F':14}{1:14d}{len(matrix):14d}\n")
    path.write_text("".join([*head, *pointers, *rows, *values, *loads]))


def ansys_harwell_boeing(folder, data, nodes="node"):
    """HBMAT with mapping, stiffness with a right-hand side; nodes by NWRITE or by CDWRITE."""
    dofs, stiffness, mass = _renumbered(data, seed=11)
    _harwell_boeing(folder / "k.matrix", stiffness, right_hand_side=True)
    _harwell_boeing(folder / "m.matrix", mass, right_hand_side=False)
    rows = (f"{k:12d}{node:12d}{NAMES[component - 1]:>8}\n" for k, (node, component) in enumerate(dofs, 1))
    (folder / "k.mapping").write_text("  Matrix Eqn.     Node      DOF\n" + "".join(rows))
    write = {"node": _nwrite, "cdb": _cdwrite}[nodes]
    write(folder / f"n.{nodes}", data)
    return {
        "stiffness": folder / "k.matrix", "mass": folder / "m.matrix", "dofs": folder / "k.mapping",
        "coordinates": folder / f"n.{nodes}",
    }  # fmt: skip


def _filled(place):
    """Places without the zeros at their end, in fields of 21."""
    values = [*place]
    while values and values[-1] == 0.0:
        values.pop()
    return "".join(f"{value:21.13E}" for value in values)


def _nwrite(path, data):
    rows = zip(data.nodes.tolist(), data.coordinates.tolist(), strict=True)
    path.write_text("".join(f"{node:9d}{_filled(place)}\n" for node, place in rows))


def _cdwrite(path, data):
    rows = zip(data.nodes.tolist(), data.coordinates.tolist(), strict=True)
    path.write_text(
        "/COM,ANSYS RELEASE\n/PREP7\nNBLOCK,6,SOLID,    13,    13\n(3i9,6e21.13e3)\n"
        + "".join(f"{node:9d}{0:9d}{0:9d}{_filled(place)}\n" for node, place in rows)
        + "N,R5.3,LOC,       -1,\nEBLOCK,19,SOLID\n(19i9)\n       -1\n"
    )


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
    """*EXPORT of Ansys: one triangle with a heading that says so."""
    paths = {name: folder / f"{name}.mmf" for name in ("stiffness", "mass")}
    for name, path in paths.items():
        with path.open("wb") as file:
            io.mmwrite(file, sparse.coo_array(getattr(data, name)), symmetry="symmetric", precision=17)
    return {**paths, "coordinates": columns(folder, data)}


WRITERS = {
    "calculix": (calculix, 1e-13),
    "abaqus, matrix input": (abaqus_matrix_input, 1e-15),
    "abaqus, coordinate": (abaqus_coordinate, 1e-15),
    "abaqus, substructure": (abaqus_substructure, 1e-15),
    "calculix, substructure": (calculix_substructure, 1e-13),
    "ansys, hbmat and nwrite": (ansys_harwell_boeing, 1e-15),
    "ansys, hbmat and cdwrite": (lambda folder, data: ansys_harwell_boeing(folder, data, "cdb"), 1e-15),
    "ansys, matrix market": (_matrix_market, 1e-15),
    "nastran, dmig": (lambda folder, data: dmig(folder / "job.pch", data), 1e-9),
    "nastran, op2": (_op2, 0.0),
    "nastran, op4": (_op4, 0.0),
}
"""With the digits that the program writes, of the largest entry."""
