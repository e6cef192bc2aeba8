"""A frame as other programs write it: the same matrices, whatever the file; damaged files are sentences."""

import numpy as np
import pytest
from scipy import io, sparse

from components.flexible.reduction import craig_bampton
from components.imported.matrices import to_matrices
from components.imported.nastran import write_op4
from tests.references import matrix_writers as write
from tests.references.frame_model import bar_frame, frame_data, imported

DATA = frame_data(bar_frame())
ENDS = ("left", "right", "tip")
OWN = craig_bampton(bar_frame(), ENDS, 5)


def _columns(folder, data):
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
    path = write.op2(folder / "job.op2", {"kgg": data.stiffness.toarray(), "mgg": data.mass.toarray()})
    return {"file": path, "coordinates": _columns(folder, data)}


def _op4(folder, data):
    write_op4(folder / "job.op4", to_matrices(data))
    return folder / "job.op4"


def _matrix_market(folder, data):
    """*EXPORT of Ansys: one triangle with a heading that says so."""
    paths = {name: folder / f"{name}.mmf" for name in ("stiffness", "mass")}
    for name, path in paths.items():
        with path.open("wb") as file:
            io.mmwrite(file, sparse.coo_array(getattr(data, name)), symmetry="symmetric", precision=17)
    return {**paths, "coordinates": _columns(folder, data)}


WRITERS = {
    "calculix": (write.calculix, 1e-13),
    "abaqus, matrix input": (write.abaqus_matrix_input, 1e-15),
    "abaqus, coordinate": (write.abaqus_coordinate, 1e-15),
    "ansys, hbmat and nwrite": (write.ansys_harwell_boeing, 1e-15),
    "ansys, hbmat and cdwrite": (lambda folder, data: write.ansys_harwell_boeing(folder, data, "cdb"), 1e-15),
    "ansys, matrix market": (_matrix_market, 1e-15),
    "nastran, dmig": (lambda folder, data: write.dmig(folder / "job.pch", data), 1e-9),
    "nastran, op2": (_op2, 0.0),
    "nastran, op4": (_op4, 0.0),
}
"""With the digits that the program writes, of the largest entry."""


@pytest.mark.parametrize("program", WRITERS)
def test_matrices_of_every_program_are_those_that_were_written(tmp_path, program):
    """Frequencies too, to round-off that the digits leave: rotations of a stiff frame cancel."""
    writer, digits = WRITERS[program]
    found = imported(writer(tmp_path, DATA))
    data = found.data()
    order = np.lexsort(data.dofs.T[::-1])
    np.testing.assert_array_equal(data.dofs[order], DATA.dofs)
    np.testing.assert_array_equal(data.nodes, DATA.nodes)
    np.testing.assert_allclose(data.coordinates, DATA.coordinates, atol=max(digits, 1e-13))
    for name in ("stiffness", "mass"):
        matrix, own = getattr(data, name).toarray()[np.ix_(order, order)], getattr(DATA, name).toarray()
        np.testing.assert_allclose(matrix, own, rtol=0, atol=max(digits, 1e-15) * np.abs(own).max())
    frequency = craig_bampton(found.model(), ENDS, 5).frequency
    np.testing.assert_allclose(frequency, OWN.frequency, rtol=1e-6 if digits > 1e-12 else 1e-9)
