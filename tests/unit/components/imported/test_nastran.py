"""External superelements of Nastran: the public pair that comes with pyYeti, against what Nastran prints of it."""

from importlib.resources import files
from pathlib import Path
from shutil import copy

import numpy as np
import pytest
from scipy import sparse

import orchestrator as fanfold
from components.contract.component import ComponentError
from components.flexible.reduction import craig_bampton_basis, orthonormal_modes
from components.imported import nastran
from components.imported.agreement import free_hertz
from components.imported.body import ImportedBody
from components.imported.data import transformed
from components.imported.nastran import read_matrices, read_superelement, write_superelement
from components.imported.nastran_bulk import read_dmig
from orchestrator.scene.builder import Scene
from tests.references.imports.nastran_results import by_mode

PAIR = Path(str(files("pyyeti"))) / "tests" / "nas2cam_extseout"
POINTS = {"a": 3, "b": 11, "c": 19, "d": 27}
INCHES = {"length": "25.4 mm", "mass": "175.1268 kg"}  # 1 lbf s2/in
PRINTED = ["1.69880", "1.76749", "1.85772", "3.41961", "7.02421", "7.02541", "10.72361"]


def write_op4(path: Path, matrices: dict[str, np.ndarray]) -> None:
    """Write matrices as another library does."""
    from pyyeti.nastran import op4  # takes long, and whoever collects tests imports this file

    op4.write(str(path), matrices)


def _superelement(name: str, folder: Path = PAIR) -> ImportedBody:
    return ImportedBody(
        (("file", str(folder / f"{name}.asm")),), f"{folder}{name}", tuple(POINTS.items()), length=0.0254, mass=175.1268
    )  # fmt: skip


@pytest.fixture(scope="module")
def pair():
    """Modes of both, 24 shared coordinates; welds of 1e12 N/m move frequencies by less than a printed digit."""
    scene = Scene("pair", until="1 s")
    scene.base(points={"origin": (0, 0, 0)})
    scene.joint(axial_stiffness="1e12 N/m", radial_stiffness="1e12 N/m", cross_stiffness="1e12 N.m/rad")
    for name in ("inboard", "outboard"):
        table = {"file": str(PAIR / f"{name}.asm"), "units": INCHES, "attachment_points": POINTS}
        place = {"body": "base", "point": "origin"}
        scene.body(name, fixed_interface_modes=22, place=place, **{"import": table})
    for point in POINTS:
        ports = {"inboard": ("inboard", point), "outboard": ("outboard", point)}
        scene.connection(f"weld_{point}", "hinge", preset="fixed", ports=ports)
    return fanfold.modes(scene, as_posed=True)


def test_what_numba_compiles_has_a_place_where_neither_home_nor_the_library_has(monkeypatch):
    """Regression: a service without a home got numba's traceback from every file of Nastran."""
    usual, numba, asked = nastran.import_module, nastran.import_module("numba"), []

    def without_home(name):
        if name == "pyyeti.nastran" and not asked:
            asked.append(name)
            raise RuntimeError("cannot cache function '_numba_interp': no locator available for file")
        return usual(name)

    monkeypatch.setattr(nastran, "import_module", without_home)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    assert nastran.pyyeti().op4 is not None
    assert asked
    assert Path(numba.config.CACHE_DIR).is_dir()


def test_the_pair_welded_swings_as_nastran_says(pair):
    assert [f"{hertz:.5f}" for hertz in pair.frequencies[:7]] == PRINTED


INCH, POUND = 0.0254, 175.1268 * 0.0254
"""m; N"""
PER_MODE = np.sqrt(175.1268) * INCH
"""Modes of unit modal mass in lbf s2/in are so many times those in kg."""
SI = {"Pa": POUND / INCH**2, "N": POUND, "N.m": POUND * INCH}
FORCES = ("moment a1", "moment a2", "moment b1", "moment b2", "shear 1", "shear 2", "axial", "torque")
AREA = {11: 12.566, 23: 12.566, 89: 201.06}
"""in2, of elements whose stress comes along; they have no points C to F, so bending stresses none"""


def _printed(label, unit, forces):
    """What OEF1X says of an output, inches and pounds; stress along the axis is force over area."""
    _, element, name = label.split(" ", 2)
    own = forces[int(element)]
    if unit != "Pa":
        return own[FORCES.index(name)]
    return own[FORCES.index("axial")] / AREA[int(element)] if name == "axial" else 0.0


@pytest.mark.parametrize(("name", "count", "off"), [("inboard", 8, 4e-3), ("outboard", 22, 5e-3)])
def test_forces_and_stresses_in_modes_of_the_pair_are_nastrans_of_the_whole(pair, name, count, off):
    """Against OEF1X of full.op2, the structure in one piece: the pair lacks modes beyond 50 Hz of its parts.

    Of the largest value in the seven modes: what bends a bar a little has few digits beside what bends it most.
    """
    model, rows = _superelement(name).model(), pair.model.mechanism.rows[name]
    shapes = orthonormal_modes(model, tuple(POINTS), count)[1]
    free, whole = np.flatnonzero(pair.shapes.is_free).size, by_mode(PAIR / "full.op2", "OEF1X")[6:13]
    outputs, units = model.outputs, np.array([SI[unit] for unit in model.outputs.units])
    moved = shapes @ pair.shapes.shapes[rows.start + 6 : rows.stop, free : free + 7]
    found = PER_MODE * (outputs.rows @ moved).T / units
    exact = np.array(
        [
            [_printed(*of, forces) for of in zip(outputs.labels, outputs.units, strict=True)]
            for _, forces in whole
        ]
    )
    found *= np.sign(np.sum(found * exact, axis=1))[:, None]
    # a bar's forces beside its largest, stresses beside the largest of all
    kinds = [
        unit if unit == "Pa" else label.split()[1] + unit
        for label, unit in zip(outputs.labels, outputs.units, strict=True)
    ]
    scale = {kind: np.abs(exact[:, [k == kind for k in kinds]]).max() for kind in kinds}
    error = np.abs(found - exact).max(axis=0) / [scale[kind] for kind in kinds]
    assert error.max() < off


def test_stresses_forces_and_displacements_in_fixed_interface_modes_are_those_that_nastran_wrote():
    """Against OES1X1, OEF1X and OUGV1 of inboard.op2, in single precision; modes by our own eigensolution."""
    data, model = _superelement("inboard").data(), _superelement("inboard").model()
    held = craig_bampton_basis(model, tuple(POINTS), 3)[:, :3]
    outputs, units = model.outputs, np.array([SI[unit] for unit in model.outputs.units])
    found = PER_MODE * (outputs.rows @ held).T / units
    motion = PER_MODE * (data.recovery.motion @ held).T.reshape(3, -1, 6) / ([INCH] * 3 + [1.0] * 3)
    places = [data.recovery.nodes.tolist().index(node) for node in (4, 16)]
    tables = (by_mode(PAIR / "inboard.op2", name) for name in ("OES1X1", "OEF1X", "OUGV1"))
    for mode, ((_, stress), (_, force), (_, moved)) in enumerate(zip(*tables, strict=True)):
        # a bar: four stresses at end A, along the axis, extremes and margin, the same at end B
        exact = np.concatenate(
            [*(stress[e][[0, 1, 2, 3, 4, 8, 9, 10, 11]] for e in (11, 23, 89)), force[10], force[97]]
        )
        nodes = np.array([moved[node][1:] for node in (4, 16)])
        sign = np.sign(found[mode] @ exact)
        for part in (slice(0, 27), slice(27, 35), slice(35, 43)):
            np.testing.assert_allclose(
                sign * found[mode, part], exact[part], rtol=0, atol=2e-6 * np.abs(exact[part]).max()
            )
        np.testing.assert_allclose(
            sign * motion[mode, places], nodes, rtol=0, atol=2e-6 * np.abs(nodes).max()
        )


def test_mass_and_centre_are_those_that_nastran_prints():
    """Grid point weights of inboard.out, in lbf s2/in and in."""
    model = _superelement("inboard").model()
    assert model.mass == pytest.approx(1.755052 * 175.1268, rel=1e-6)
    np.testing.assert_allclose(model.center_of_mass / 0.0254, [1039.998, 150.0, 150.0], rtol=1e-6)
    about = np.array([3.590520e4, 3.682012e5, 3.682012e5])
    np.testing.assert_allclose(np.diag(model.inertia) / (175.1268 * 0.0254**2), about, rtol=1e-6)


def test_recovered_nodes_are_where_the_bulk_data_has_them_and_rigid_motions_stress_nothing():
    """Places follow from rigid motions of recovered rows; those of grids 4 and 16 stand in inboard.blk."""
    data = _superelement("inboard").data()
    assert data.recovery is not None
    places = dict(zip(data.recovery.nodes.tolist(), data.recovery.coordinates / 0.0254, strict=True))
    np.testing.assert_allclose(places[4], [900.0, 0.0, 300.0], atol=1e-4)
    np.testing.assert_allclose(places[16], [2100.0, 300.0, 300.0], atol=1e-4)
    assert data.outputs is not None
    assert data.outputs.labels[4] == "element 11 axial"
    outputs = np.abs(data.outputs.rows @ data.rigid_motions())
    assert np.all(outputs < 1e-5 * np.abs(data.outputs.rows).max(axis=1, keepdims=True) + 1e-3)


def test_damaged_files_are_sentences(tmp_path):
    for ending in (".asm", ".pch", ".op4"):
        copy(PAIR / f"outboard{ending}", tmp_path)
    whole = (tmp_path / "outboard.op4").read_bytes()
    (tmp_path / "outboard.op4").write_bytes(whole[: len(whole) // 3])
    with pytest.raises(ComponentError, match=r"outboard\.op4: "):
        _superelement("outboard", tmp_path).model()
    (tmp_path / "outboard.op4").unlink()
    with pytest.raises(ComponentError, match=r"outboard\.op4: "):
        _superelement("outboard", tmp_path).data()
    write_op4(tmp_path / "outboard.op4", {"kgg": np.eye(3)})
    with pytest.raises(ComponentError, match=r"mass \(maa, mxx"):
        _superelement("outboard", tmp_path).data()


def test_inches_taken_for_metres_are_told():
    body = ImportedBody((("file", str(PAIR / "inboard.asm")),), "inches", tuple(POINTS.items()))
    with pytest.raises(ComponentError, match="kg/m3"):
        body.model()


def test_a_superelement_that_we_write_is_read_back_in_full_and_by_what_nastran_knows_of_it(tmp_path):
    """Ours with all digits; without what we add, nodes have eight digits and recovered ones follow from their rows."""
    data = _superelement("outboard").data()
    order = np.argsort(data.dofs[:, 1] == 0, kind="stable")
    data = transformed(data, sparse.eye_array(len(order), format="csr")[:, order], data.dofs[order])
    path = tmp_path / "wing.asm"
    write_superelement(path, data)
    found = read_superelement(path)
    for name in ("stiffness", "mass"):
        assert abs(getattr(found, name) - getattr(data, name)).max() == 0.0
    np.testing.assert_array_equal(found.coordinates, data.coordinates)
    np.testing.assert_array_equal(found.recovery.coordinates, data.recovery.coordinates)
    assert abs(found.recovery.motion - data.recovery.motion).max() == 0.0
    matrices = read_matrices(tmp_path / "wing.op4")
    write_op4(tmp_path / "wing.op4", {name: matrices[name] for name in ("kaa", "maa", "va", "mug1")})
    found = read_superelement(path)
    np.testing.assert_array_equal(found.dofs[:, 1], data.dofs[:, 1])
    assert abs(found.stiffness - data.stiffness).max() == 0.0
    np.testing.assert_allclose(found.coordinates, data.coordinates, atol=1e-8)
    np.testing.assert_allclose(found.recovery.coordinates, data.recovery.coordinates, atol=1e-6)
    (tmp_path / "wing.op4").write_bytes((PAIR / "inboard.op4").read_bytes())
    with pytest.raises(ComponentError, match=r"46 .*wing\.op4.*32 rows"):
        read_superelement(path)


def test_a_superelement_with_one_component_of_a_node_has_the_free_modes_that_nastran_wrote():
    """Against LAMBDA of two versions of Nastran; 508 nodes recovered, one boundary node with one component."""
    points = (("a", 373), ("b", 411), ("c", 441))
    body = ImportedBody(
        (("file", str(PAIR / "reduced_bset_notall6.asm")),), "notall6", points, length=0.0254, mass=175.1268
    )
    found = free_hertz(body.model(), 4)
    for version in ("nx2021", "msc2017"):
        eigenvalues = read_matrices(PAIR / f"nas2cam_notall6_{version}.op4")["lambda"].ravel()
        np.testing.assert_allclose(found, np.sqrt(eigenvalues[6:]) / (2.0 * np.pi), rtol=1e-8)
    assert len(body.data().recovery.nodes) == 508


def test_dmig_of_an_op2_that_nastran_wrote_are_those_it_was_given_as_text():
    """The public pair of pyYeti's tests: a bulk file, and what Nastran made of it by MATMOD and OUTPUT2."""
    folder = PAIR.parent / "nastran_dmig_data"
    punched, written = read_dmig(folder / "matrix_factory.pch"), read_dmig(folder / "matrix.op2")
    assert set(punched) == {"patrn", "ident", "randm"}
    for name, matrix in punched.items():
        other = written[f"m{name}"]
        np.testing.assert_array_equal(other.dofs, matrix.dofs)
        assert abs(other.matrix - matrix.matrix).max() < 1e-9 * abs(matrix.matrix).max()
