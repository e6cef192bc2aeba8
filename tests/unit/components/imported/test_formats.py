"""A frame as other programs write it: the same matrices, whatever the file; damaged files are sentences."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import linalg, sparse

from components.contract.component import ComponentError
from components.flexible.finite_elements import OutputRows
from components.flexible.reduction import craig_bampton, fixed_interface_frequencies
from components.imported.data import FiniteElementData
from components.imported.matrices import write_npz
from components.imported.nastran import write_op4
from components.imported.points import JoinedPoint
from tests.references.imports import matrix_writers as write
from tests.references.imports.frame_model import bar_frame, frame_data, imported

DATA = frame_data(bar_frame())
ENDS = ("left", "right", "tip")
OWN = craig_bampton(bar_frame(), ENDS, 5)


@pytest.mark.parametrize("program", write.WRITERS)
def test_matrices_of_every_program_are_those_that_were_written(tmp_path, program):
    """Frequencies too, to round-off that the digits leave: rotations of a stiff frame cancel."""
    writer, digits = write.WRITERS[program]
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


@pytest.mark.parametrize("program", write.WRITERS)
def test_files_cut_off_are_sentences(tmp_path, program):
    """Every file of every program, at three places: no traceback, and nothing that passes for the frame."""
    files = write.WRITERS[program][0](tmp_path, DATA)
    for path in sorted(tmp_path.iterdir()):
        content = path.read_bytes()
        for part in (0.0, 0.02, 0.45):
            path.write_bytes(content[: int(part * len(content))])
            with pytest.raises(ComponentError, match=r"\w{3}.* \w"):
                imported(files).model()
        path.write_bytes(content)
    assert imported(files).model().mass == pytest.approx(bar_frame().mass, rel=1e-9)


@pytest.mark.parametrize("sizes", ["72 72", "99999999999 72"])
def test_matrix_market_cut_off_within_an_exponent_or_with_a_wrong_size_is_a_sentence(tmp_path, sizes):
    """SciPy's reader would look for digits beyond the end of the first, and fill all memory for the second."""
    files = {
        "stiffness": tmp_path / "k.mtx",
        "mass": tmp_path / "k.mtx",
        "coordinates": write.columns(tmp_path, DATA),
    }
    end = "e-" if sizes == "72 72" else "e-03"
    files["mass"].write_text(
        f"%%MatrixMarket matrix coordinate real symmetric\n{sizes} 9\n1 1 1.0\n2 2 3.1763735522{end}"
    )
    with pytest.raises(ComponentError, match=r"k\.mtx: .*Matrix Market"):
        imported(files).model()


def _edited(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def _internal_node(folder):
    files = write.entries_by_node(folder, DATA)
    _edited(files["mass"], "\n1,1, 1,1,", "\n-3,1, -3,1,")
    return files


def _local_axes(folder):
    path = write.calculix(folder, DATA)
    _edited(folder / "job.inp", "*ELEMENT", "*TRANSFORM, NSET=all, TYPE=C\n0, 0, 0, 0, 0, 1\n*ELEMENT")
    return path


def _cylindrical(folder):
    path = write.calculix(folder, DATA)
    _edited(folder / "job.inp", "*NODE, NSET", "*Node, System=C, NSET")
    return path


def _unsymmetric(folder):
    files = write.entries_by_row(folder, DATA)
    lines = files["stiffness"].read_text().splitlines()
    row, column, value = min((line.split() for line in lines), key=lambda words: float(words[2]))
    _edited(files["stiffness"], " ".join((row, column, value)), f"{row} {column} {1.2 * float(value)!r}")
    return files


def _of_another_model(folder):
    """Mass of a finer frame."""
    path = write.dmig(folder / "job.pch", DATA)
    other = write.dmig(folder / "other.pch", frame_data(bar_frame(5)), nodes=False)
    path.write_text(
        path.read_text().partition("DMIG    MAAX")[0]
        + "DMIG    MAAX"
        + other.read_text().partition("DMIG    MAAX")[2]
    )
    return path


def _rectangular(folder):
    path = write.op2(
        folder / "job.op2", {"kgg": DATA.stiffness.toarray(), "mgg": DATA.mass.toarray()[:, :-6]}
    )
    return {"file": path, "coordinates": write.columns(folder, DATA)}


def _no_grid(folder):
    return write.dmig(folder / "job.pch", DATA, nodes=False)


def _mixed(folder):
    files = write.entries_by_node(folder, DATA)
    return files | {"mass": write.entries_by_row(folder, DATA)["mass"]}


def _millimetres(folder):
    scale = sparse.diags_array(np.where(DATA.dofs[:, 1] <= 3, 1e-3, 1.0))
    return write.dmig(
        folder / "job.pch",
        replace(
            DATA,
            stiffness=sparse.csr_array(1e3 * scale @ DATA.stiffness @ scale),
            mass=sparse.csr_array(1e3 * scale @ DATA.mass @ scale),
            coordinates=1e3 * DATA.coordinates,
        ),
    )


def _no_mass(folder):
    path = write.calculix(folder, DATA)
    (folder / "job.mas").unlink()
    return path


def _too_many_freedoms(folder):
    path = write.calculix(folder, DATA)
    with (folder / "job.dof").open("a") as file:
        file.write("13.1\n")
    return path


def _itself(folder):
    path = write.calculix(folder, DATA)
    _edited(folder / "more.inc", "*Node", "*INCLUDE, INPUT=job.inp\n*Node")
    return path


BROKEN = {
    r"job\.mas \(mass\) .*job\.sti": _no_mass,
    r"job\.sti: .*72 rows.*73 ": _too_many_freedoms,
    r"job\.inp: includes itself": _itself,
    r"job_MASS1\.txt: node -3 ": _internal_node,
    r"job\.inp: line \d+: \*TRANSFORM": _local_axes,
    r"job\.inp: line 4: \*Node, System=C": _cylindrical,
    "stiffness.*symmetric": _unsymmetric,
    r"job\.pch: node 13 component 1 ": _of_another_model,
    "mass .*72 x 66.*72 x 72": _rectangular,
    r"job\.pch: .*GRID": _no_grid,
    "both name": _mixed,
    "kg/m3": _millimetres,
}


@pytest.mark.parametrize("told", BROKEN)
def test_what_does_not_fit_is_a_sentence(tmp_path, told):
    files = BROKEN[told](tmp_path)
    with pytest.raises(ComponentError, match=told):
        imported(files).model()


def _with_rows():
    """The frame with axial force and mean stress of its first element, and a moment."""
    rows = np.zeros((3, len(DATA.dofs)))
    along = DATA.coordinates[1] - DATA.coordinates[0]
    along = along / np.linalg.norm(along)
    rows[0, 0:3], rows[0, 6:9] = -along, along
    rows[1] = 2e6 * rows[0]
    rows[2, 3], rows[2, 9] = 1.0, -1.0
    return replace(
        DATA, outputs=OutputRows(("bar force", "bar stress", "bar moment"), ("N", "Pa", "N.m"), rows)
    )


@pytest.mark.parametrize("ending", [".npz", ".op4"])
def test_rows_of_stress_and_force_are_read_back_in_si_units(tmp_path, ending):
    """Written in mm and t: stress in MPa, moments in N.mm; labels in npz only."""
    data, path = _with_rows(), tmp_path / f"frame{ending}"
    # one N by m is 1e-3 N by mm; rotations stay, and N.m are 1e3 N.mm
    scale = np.where(data.dofs[:, 1] <= 3, 1e-3, 1.0)
    units = np.array([1.0, 1e-6, 1e3])
    turned = sparse.diags_array(scale)
    millimetres = replace(
        data,
        stiffness=sparse.csr_array(1e3 * turned @ data.stiffness @ turned),
        mass=sparse.csr_array(1e3 * turned @ data.mass @ turned),
        coordinates=1e3 * data.coordinates,
        outputs=replace(data.outputs, rows=units[:, None] * data.outputs.rows * scale),
    )
    {".npz": write_npz, ".op4": write_op4}[ending](path, millimetres)
    found = imported(path, length=1e-3, mass=1e3).model().outputs
    labels = (
        ("bar stress", "bar force", "bar moment") if ending == ".npz" else ("stress 1", "force 1", "moment 1")
    )
    assert found.labels == labels
    assert found.units == ("Pa", "N", "N.m")
    np.testing.assert_allclose(found.rows, data.outputs.rows[[1, 0, 2]], rtol=1e-12)


def test_rows_that_rigid_motions_stress_are_a_sentence(tmp_path):
    data = _with_rows()
    rows = np.roll(data.outputs.rows, 1, axis=1)
    write_npz(tmp_path / "frame.npz", replace(data, outputs=replace(data.outputs, rows=rows)))
    with pytest.raises(ComponentError, match=r"rigid motions.*row"):
        imported(tmp_path / "frame.npz").model()


def _truss():
    """A boom of three bays of bars with nodes of three components, as solids of CalculiX have them."""
    corners = np.array([(0.3, 0.0), (-0.15, 0.26), (-0.15, -0.26)])
    places = np.array([(0.8 * bay, *corner) for bay in range(4) for corner in corners])
    bars = [(3 * b + k, 3 * b + j) for b in range(4) for k, j in ((0, 1), (1, 2), (2, 0))]
    bars += [
        (3 * b + k, 3 * b + 3 + j)
        for b in range(3)
        for k, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
    ]
    stiffness, mass = np.zeros((36, 36)), np.zeros((36, 36))
    for one, other in bars:
        span = places[other] - places[one]
        length = np.linalg.norm(span)
        rows = np.r_[3 * one : 3 * one + 3, 3 * other : 3 * other + 3]
        ends = np.concatenate([-span, span]) / length
        stiffness[np.ix_(rows, rows)] += 2e6 / length * np.outer(ends, ends)
        mass[np.ix_(rows, rows)] += 0.3 * length / 6.0 * np.kron([[2.0, 1.0], [1.0, 2.0]], np.eye(3))
    numbers = np.arange(1, 13)
    dofs = np.column_stack([np.repeat(numbers, 3), np.tile([1, 2, 3], 12)])
    return FiniteElementData(sparse.csr_array(stiffness), sparse.csr_array(mass), numbers, places, dofs)


CALCULIX = Path(__file__).parents[3] / "references" / "imports" / "calculix"
HELD = (3.740016e3, 4.256768e3, 1.409530e4, 2.522646e4, 2.718989e4, 2.786417e4)
"""rad/s; of the same bar held at its root, from *FREQUENCY of CalculiX 2.20."""


def test_files_that_calculix_wrote():
    """Mass of the bar, and the frequencies that CalculiX itself finds with its root held, to its seven digits."""
    root = JoinedPoint("root", (1, 2, 3, 4))
    model = imported(CALCULIX / "bar.sti", points=(), rigid_elements=(root,)).model()
    assert model.mass == pytest.approx(2700.0 * 0.3 * 0.04 * 0.02, rel=1e-12)
    np.testing.assert_allclose(fixed_interface_frequencies(model, ("root",), 6), HELD, rtol=2e-7)


def test_solids_of_calculix_are_held_by_a_rigid_element(tmp_path):
    """Against the eigenvalues of the truss itself with the three nodes of its root held."""
    data = _truss()
    root = JoinedPoint("root", (1, 2, 3))
    model = imported(write.calculix(tmp_path, data), points=(), rigid_elements=(root,)).model()
    free = slice(9, None)
    exact = linalg.eigh(
        data.stiffness.toarray()[free, free], data.mass.toarray()[free, free], eigvals_only=True
    )
    np.testing.assert_allclose(fixed_interface_frequencies(model, ("root",), 6) ** 2, exact[:6], rtol=1e-9)
    assert model.mass == pytest.approx(np.sum(data.mass.toarray()[::3, ::3]), rel=1e-12)
