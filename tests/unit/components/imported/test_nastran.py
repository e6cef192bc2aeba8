"""External superelements of Nastran: the public pair that comes with pyYeti, against what Nastran prints of it."""

from importlib.resources import files
from pathlib import Path
from shutil import copy

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.component import ComponentError
from components.imported.body import ImportedBody
from components.imported.nastran import write_op4
from orchestrator.scene.builder import Scene

PAIR = Path(str(files("pyyeti"))) / "tests" / "nas2cam_extseout"
POINTS = {"a": 3, "b": 11, "c": 19, "d": 27}
INCHES = {"length": "25.4 mm", "mass": "175.1268 kg"}  # 1 lbf s2/in
PRINTED = ["1.69880", "1.76749", "1.85772", "3.41961", "7.02421", "7.02541", "10.72361"]


def _superelement(name: str, folder: Path = PAIR) -> ImportedBody:
    return ImportedBody(
        (("file", str(folder / f"{name}.asm")),), f"{folder}{name}", tuple(POINTS.items()), length=0.0254, mass=175.1268
    )  # fmt: skip


def test_the_pair_welded_swings_as_nastran_says():
    """24 shared coordinates; welds of 1e12 N/m move the first seven frequencies by less than a printed digit."""
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
    found = fanfold.modes(scene, as_posed=True)
    assert [f"{hertz:.5f}" for hertz in found.frequencies[:7]] == PRINTED


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
    assert data.stress is not None
    assert data.stress.labels[4] == "element 11 axial"
    stress = data.stress.rows @ data.rigid_motions()
    assert np.abs(stress).max() < 1e-5 * np.abs(data.stress.rows).max()


def test_damaged_files_are_sentences(tmp_path):
    for ending in (".asm", ".pch", ".op4"):
        copy(PAIR / f"outboard{ending}", tmp_path)
    whole = (tmp_path / "outboard.op4").read_bytes()
    (tmp_path / "outboard.op4").write_bytes(whole[: len(whole) // 3])
    with pytest.raises(ComponentError, match=r"outboard\.op4: "):
        _superelement("outboard", tmp_path).model()
    (tmp_path / "outboard.op4").unlink()
    with pytest.raises(ComponentError, match=r"outboard\.op4: is not there"):
        _superelement("outboard", tmp_path).data()
    write_op4(tmp_path / "outboard.op4", {"stiffness": np.eye(3)})
    with pytest.raises(ComponentError, match="no matrix kxx"):
        _superelement("outboard", tmp_path).data()


def test_inches_taken_for_metres_are_told():
    body = ImportedBody((("file", str(PAIR / "inboard.asm")),), "inches", tuple(POINTS.items()))
    with pytest.raises(ComponentError, match="hardly in m and kg"):
        body.model()
