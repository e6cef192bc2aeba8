"""What an importer shows of an exported FMU: page, picture, icon, author, degrees, angles of lines, terminals."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu

import orchestrator as fanfold
from fmus import check_fmu
from tests.references.native_fmus import needs_native

pytestmark = needs_native
TOLD = {"author": "A. Engineer", "version": "1.2", "license": "internal"}


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """A component of FMI 2.0, and the wing as one FMU of 3.0 on a driven base."""
    folder = tmp_path_factory.mktemp("exported")
    scene = fanfold.load("workbench").with_settings({f"scene.{name}": text for name, text in TOLD.items()})
    (one,) = fanfold.export(scene, folder, rigid="all", as_one=True, driven_base=True, fmi="3.0")
    return {"2.0": fanfold.export(scene, folder / "parts", rigid="all")[-1], "3.0": one}


@pytest.mark.parametrize(
    ("fmi", "pictures"),
    [("2.0", ["model.png"]), ("3.0", ["terminalsAndIcons/icon.png", "documentation/picture.png"])],
)
def test_an_importer_finds_words_and_pictures(exported, fmi, pictures):
    """FMI 2.0, 2.2.1, and 3.0, 2.5: attributes, documentation/index.html and icons; valid by the official schemas."""
    assert check_fmu(exported[fmi], run=False) == []
    with zipfile.ZipFile(exported[fmi]) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        page = archive.read("documentation/index.html").decode()
        assert all(archive.read(picture).startswith(b"\x89PNG") for picture in pictures)
    assert {name: root.get(name) for name in TOLD} == TOLD
    assert all(text in page for text in (*TOLD.values(), "latch_command", "Boolean", root.get("modelName")))


def test_angles_are_shown_in_degrees(exported):
    """FMI 2.0, 2.2.2, and 3.0, 2.4.3: a value times the factor of its display unit."""
    for path, angle in ((exported["2.0"], "angle"), (exported["3.0"], "HL.angle")):
        description = read_model_description(str(path), validate=True)
        assert {v.name: v for v in description.modelVariables}[angle].displayUnit == "deg"
        (shown,) = {u.name: u for u in description.unitDefinitions}["rad"].displayUnits
        assert shown.factor == pytest.approx(180.0 / np.pi, rel=1e-15)


def test_the_angle_of_a_line_is_that_of_its_sensor(exported):
    """Definition, at communication points that no inner step meets."""
    names = ["HL.angle", "hinge_left.angle"]
    rows = simulate_fmu(str(exported["3.0"]), stop_time=1.0, output_interval=0.07, output=names)
    assert np.array_equal(rows["HL.angle"], rows["hinge_left.angle"])
    assert rows["HL.angle"][-1] > rows["HL.angle"][1] > 0.0


def test_terminals_of_the_wing(exported):
    """FMI 3.0, 2.4.9: every member is a variable; the base and the line are there; what jumps is discrete."""
    known = read_model_description(str(exported["3.0"]), validate=False).modelVariables
    with zipfile.ZipFile(exported["3.0"]) as archive:
        root = ElementTree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
    assert {terminal.get("name") for terminal in root.iter("Terminal")} == {"workbench_table", "HL"}
    members = {member.get("variableName") for member in root.iter("TerminalMemberVariable")}
    assert members <= {v.name for v in known}
    assert {"HL.angle", "workbench_table.acceleration", "workbench_table.interface_impulse"} <= members
    discrete = {v.name for v in known if v.variability == "discrete"}
    assert {"HL.latched", "HL.latch_time", "HL.latch_command", "steps"} <= discrete
