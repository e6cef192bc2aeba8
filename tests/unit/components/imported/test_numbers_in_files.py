"""Numbers as programs write them, and models whose units or matrices are hardly those of a body."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import io, sparse

from components.contract.component import ComponentError
from components.flexible.reduction import craig_bampton
from components.imported.matrices import to_matrices
from tests.references.imports.frame_model import bar_frame, frame_data, imported


def matrix_market(folder, data):
    """Files of stiffness, mass and nodes."""
    files = {name: str(folder / f"{name}.mtx") for name in ("stiffness", "mass")}
    io.mmwrite(files["stiffness"], sparse.coo_array(data.stiffness), symmetry="general", precision=17)
    io.mmwrite(files["mass"], sparse.coo_array(data.mass), symmetry="general", precision=17)
    files["coordinates"] = str(folder / "nodes.csv")
    rows = np.column_stack([data.nodes, data.coordinates]).tolist()
    Path(files["coordinates"]).write_text("\n".join(",".join(map(repr, row)) for row in rows))
    return files


def rewritten(path, change):
    """The numbers of a file in another way."""
    head, *lines = Path(path).read_text().splitlines()
    Path(path).write_text("\n".join([head, *(change(line) for line in lines)]))


def test_exponents_of_fortran(tmp_path):
    """Definition: 8.0D-02 is 0.08. Regression: SciPy stopped at the D, and it was 8."""
    data = frame_data(bar_frame())
    files = matrix_market(tmp_path, data)
    rewritten(files["mass"], lambda line: re.sub("e", "D", line))
    found = imported(files).data()
    assert abs(found.mass - data.mass).max() <= 1e-15 * abs(data.mass).max()


@pytest.mark.parametrize(
    "change",
    [lambda line: line.replace(".", ","), lambda line: line.replace("e-01", "e-01kg")],
    ids=["comma", "unit"],
)
def test_what_is_no_number_is_a_sentence(tmp_path, change):
    """Regression: SciPy took what came before it for the number."""
    files = matrix_market(tmp_path, frame_data(bar_frame()))
    rewritten(files["mass"], change)
    with pytest.raises(ComponentError, match=r"mass.mtx: .*Matrix Market: line [0-9]+ "):
        imported(files).data()


def test_complex_matrices_are_a_sentence(tmp_path):
    """Regression: structural damping in the stiffness was cut off with a warning of SciPy's."""
    data = frame_data(bar_frame())
    path = tmp_path / "frame.npz"
    np.savez(path, **{**to_matrices(data), "stiffness": data.stiffness.toarray() * (1.0 + 0.02j)})
    with pytest.raises(ComponentError, match=r"complex.*0.02"):
        imported(path).data()
    np.savez(path, **{**to_matrices(data), "stiffness": data.stiffness.toarray() + 0.0j})
    assert imported(path).data().stiffness.dtype == float


def test_masses_that_are_negative_in_some_motion(tmp_path):
    """A positive diagonal, and the mass of rigid motions, say nothing of a motion with negative energy."""
    data = frame_data(bar_frame())
    mass = sparse.lil_array(data.mass)
    mass[12, 13] = mass[13, 12] = 3.0 * mass[12, 12]
    path = tmp_path / "frame.npz"
    np.savez(path, **to_matrices(replace(data, mass=sparse.csr_array(mass))))
    with pytest.raises(ComponentError, match=r"mass: .*negative"):
        imported(path).model()


def test_small_models_in_millimetres_are_told(tmp_path):
    """A frame a tenth as large: its size would be that of a structure, its density is that of nothing."""
    small = replace(frame_data(bar_frame()), coordinates=0.1 * frame_data(bar_frame()).coordinates)
    length, mass = 1e3, 1e-3  # mm, t
    turning = np.where(small.dofs[:, 1] > 3, length, 1.0)
    scale = sparse.diags_array(turning)
    in_millimetres = replace(
        small,
        coordinates=small.coordinates * length,
        stiffness=sparse.csr_array(scale @ small.stiffness @ scale) * mass,
        mass=sparse.csr_array(scale @ small.mass @ scale) * mass,
    )
    path = tmp_path / "frame.npz"
    np.savez(path, **to_matrices(in_millimetres))
    with pytest.raises(ComponentError, match="kg/m3"):
        imported(path).model()


def test_without_modes_at_one_point_a_body_is_rigid():
    """Definition: six motions of the point are those of the body. Regression: a traceback."""
    found = craig_bampton(bar_frame(), ("left",), 0)
    assert found.frequency.size == 0
    assert found.display_shapes.shape == (len(found.display_positions), 3, 0)
