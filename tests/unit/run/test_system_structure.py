"""SSP files: against the schemas of the standard and FMPy's own reader and runs, and what the FMUs in them have."""

from __future__ import annotations

import re
import zipfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from lxml import etree

import orchestrator as fanfold
from fmus import native_library
from tests.unit.run.as_one.host import Host

pytestmark = pytest.mark.skipif(native_library() is None, reason="there is no native library here")

PER_PORT = {"2.0": 13 + 6, "3.0": 4 + 2}
COMMANDS = [
    "HL_latch_command",
    "HL_unlatch_command",
    "hinge_left_failure_command",
    "hinge_right_failure_command",
]
LOADS = ["workbench_table_interface_force", "workbench_table_interface_torque"]
PARAMETERS = "resources/parameters.ssv"


@pytest.fixture(scope="module")
def export(tmp_path_factory):
    """The SSP file of the workbench with a rigid panel by version of FMI."""
    made = {}

    def file_of(fmi):
        if fmi not in made:
            folder = tmp_path_factory.mktemp("ssp")
            path = folder / "workbench.ssp"
            made[fmi] = fanfold.export("workbench", folder, rigid="all", fmi=fmi, ssp=path)[-1]
        return made[fmi]

    return file_of


@pytest.fixture(scope="module")
def written(export):
    """That of FMI 2.0."""
    return export("2.0")


@pytest.mark.parametrize(("fmi", "version", "folder"), [("2.0", "1.0", "."), ("3.0", "2.0", "ssp2")])
def test_keeps_to_the_schema(export, fmi, version, folder):
    """Against the schemas of SSP 1.0 and 2.0, as a library for the format holds them."""
    library = find_spec("pyssp_standard")
    assert library is not None
    schemas = Path(library.origin).parent / "resources" / folder
    kinds = {
        "SystemStructure.ssd": "Description",
        "elements.ssd": "Description",
        PARAMETERS: "ParameterValues",
    }
    with zipfile.ZipFile(export(fmi)) as archive:
        for member, kind in kinds.items():
            root = etree.fromstring(archive.read(member))
            etree.XMLSchema(file=str(schemas / f"SystemStructure{kind}.xsd")).assertValid(root)
            assert root.get("version") == version


def test_omsimulator_has_a_step_and_tolerances(written):
    """Its schema `oms.xsd`: tolerances of a FixedStepMaster are optional, and 0 where they are left out."""
    with zipfile.ZipFile(written) as archive:
        (master,) = etree.fromstring(archive.read("SystemStructure.ssd")).iterfind(".//{*}FixedStepMaster")
    assert [float(master.get(f"{kind}Tolerance")) for kind in ("absolute", "relative")] == [1e-4, 1e-4]


def test_no_orientation_starts_at_minus_1(written, tmp_path):
    """PyFMI couples FMUs by a factor of 1 + y. A panel folded by half a turn: 0, 0, 1, 0, not 0, 0, -1, 0."""
    with zipfile.ZipFile(written) as archive:
        path = Path(archive.extract("resources/panel.fmu", tmp_path))
    host = Host(path).start()
    outputs = [host[name] for name in host.outputs if ".orientation" in name]
    assert max(outputs) == 1.0
    assert min(outputs) > -1e-9


def structure_of(path, name="SystemStructure.ssd"):
    """The root of a system structure description, without namespaces."""
    with zipfile.ZipFile(path) as archive:
        root = etree.fromstring(archive.read(name))
    for element in root.iter("{*}*"):
        element.tag = etree.QName(element).localname
    return root


def test_fmpy_reads_it(written):
    """Against another reader: four components, every link of every port, and ports of the system with theirs."""
    from fmpy.ssp.ssd import read_ssd

    system = read_ssd(str(written)).system
    assert {c.name: Path(c.source).name for c in system.elements} == {
        name: f"{name}.fmu" for name in ("workbench_table", "panel", "hinge_left", "hinge_right")
    }
    inner = [c for c in system.connections if c.startElement and c.endElement]
    assert len(inner) == 4 * PER_PORT["2.0"]
    outputs = ["HL_latched", "HL_angle", *(f"{load}_{axis}" for load in LOADS for axis in (1, 2, 3))]
    assert {(c.name, c.kind) for c in system.connectors} == {
        *((name, "input") for name in COMMANDS),
        *((name, "output") for name in outputs),
    }
    commanded = [
        (c.endElement, c.endConnector) for c in system.connections if c.startConnector == COMMANDS[0]
    ]
    assert commanded == [("hinge_left", "latch_command"), ("hinge_right", "latch_command")]


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_connectors_and_parameters_are_variables_of_the_fmus(export, tmp_path, fmi):
    """Rule: what the file says of a variable is what the FMU in the archive says; the step is the FMUs' own.

    Connectors of the system have type, unit and size of what they are connected to. Every input has one connection.
    """
    with zipfile.ZipFile(export(fmi)) as archive:
        archive.extractall(tmp_path)
    root = structure_of(export(fmi))
    (binding,) = root.iterfind(".//ParameterBinding")
    values = {p.get("name"): p for p in structure_of(export(fmi), binding.get("source")).iter("Parameter")}
    of_connector = {}
    for component in root.iter("Component"):
        description = read_model_description(str(tmp_path / component.get("source")))
        for variable in description.modelVariables:
            place = (component.get("name"), variable.name)
            words = (variable.type, variable.unit, [str(d.start) for d in variable.dimensions or ()])
            of_connector[place] = (*words, variable.causality)
            if variable.causality == "parameter":
                parameter = values.pop(".".join(place))
                assert (*told(parameter), parameter[0].get("value")) == (*words, variable.start)
        for connector in component.iter("Connector"):
            place = (component.get("name"), connector.get("name"))
            assert (*told(connector), connector.get("kind")) == of_connector[place]
        assert (
            f'stepSize="{float(description.defaultExperiment.stepSize):g}"' in etree.tostring(root).decode()
        )
    assert values == {}
    ports = {c.get("name"): (*told(c), c.get("kind")) for c in root.iterfind("./System/Connectors/Connector")}
    targets = []
    for connection in root.iter("Connection"):
        ends = [(connection.get(f"{e}Element"), connection.get(f"{e}Connector")) for e in ("start", "end")]
        kinds = [of_connector[place] if place[0] else ports[place[1]] for place in ends]
        assert kinds[0][:3] == kinds[1][:3]
        targets.append(ends[1])
    inputs = [
        (component.get("name"), connector.get("name"))
        for component in root.iter("Component")
        for connector in component.iter("Connector")
        if connector.get("kind") == "input"
    ]
    inputs += [(None, name) for name, words in ports.items() if words[3] == "output"]
    assert sorted(targets, key=str) == sorted(inputs, key=str)
    assert root.find("DefaultExperiment").attrib == {"startTime": "0", "stopTime": "5.3"}


def told(element):
    """Type, unit and sizes of a connector or parameter."""
    sizes = [dimension.get("size") for dimension in element.iter("Dimension")]
    return element[0].tag, element[0].get("unit"), sizes


def test_a_second_description_has_no_ports(written):
    """Rule: that of tools which refuse connections to a system's own connectors differs in these alone."""
    whole, elements = structure_of(written), structure_of(written, "elements.ssd")
    system = whole.find("System")
    system.remove(system.find("Connectors"))
    for connection in list(whole.iter("Connection")):
        if not (connection.get("startElement") and connection.get("endElement")):
            connection.getparent().remove(connection)
    for root in (whole, elements):
        root.set("name", "")
        root.find("System").set("name", "")
    assert etree.tostring(whole, method="c14n").split() == etree.tostring(elements, method="c14n").split()


@pytest.mark.parametrize(
    ("name", "options"),
    [("wing.zip", {}), ("wing.ssp", {"wrench_mode": "mean"})],
)
def test_what_cannot_be_one_is_refused_before_anything_is_written(name, options, tmp_path):
    with pytest.raises(fanfold.FanfoldError, match="SSP file"):
        fanfold.export("workbench", tmp_path, rigid="all", ssp=tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_a_scene_as_one_fmu_is_one_element(tmp_path):
    """Against FMPy's reader, with all its inputs and outputs as connectors; a run of the file is that of the scene."""
    from fmpy.ssp.ssd import read_ssd

    fmu, written = fanfold.export("workbench", tmp_path, rigid="all", as_one=True, ssp=tmp_path / "one.ssp")
    (element,) = read_ssd(str(written)).system.elements
    variables = {v.name: v for v in read_model_description(str(fmu)).modelVariables}
    expected = {(n, v.causality) for n, v in variables.items() if v.causality in ("input", "output")}
    assert {(c.name, c.kind) for c in element.connectors} == expected
    own = fanfold.simulate("workbench", rigid="all", estimate=False)
    assert fanfold.simulate(written, estimate=False).latch_times == own.latch_times


def without(path, name, target, **others):
    """A copy of an archive without a member, and with others."""
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(target, "w") as new:
        for member in old.namelist():
            if member != name and member not in others:
                new.writestr(member, old.read(member))
        for member, content in others.items():
            new.writestr(member, content)
    return target


@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before
def test_it_runs_as_the_scene_that_it_was_exported_from(written):
    """Identity: numbers of the scene with its settings, at the fidelity of the export."""
    options = {"until": 0.2, "estimate": False}
    angles = [
        np.asarray(run["hinge_left", "angle"])
        for run in (
            fanfold.simulate(written, **options),
            fanfold.simulate("workbench", rigid="all", **options),
        )
    ]
    assert angles[0].tolist() == angles[1].tolist()
    assert angles[0][-1] != angles[0][0]
    assert (
        fanfold.simulate(written, flexible="all", until=0.001, estimate=False).provenance["flexible"] != "[]"
    )


def test_a_system_that_was_changed_is_no_longer_the_scene(written, tmp_path):
    """Bad input: another connection, another FMU, no scene, no archive at all; each is told of with its name."""
    with zipfile.ZipFile(written) as archive:
        structure, scene = archive.read("SystemStructure.ssd"), archive.read("resources/scene.json")
    heavier = {"resources/scene.json": scene.replace(b"until = ", b"until = 1", 1)}
    assert heavier["resources/scene.json"] != scene
    other = {"SystemStructure.ssd": structure.replace(b"panel", b"table", 1)}
    cases = {
        "in place of SystemStructure.ssd; lay changes": without(written, "", tmp_path / "a.ssp", **other),
        "resources/panel.fmu of the file that was exported is missing": without(
            written, "resources/panel.fmu", tmp_path / "b.ssp"
        ),
        "in place of resources/scene.json; lay": without(written, "", tmp_path / "g.ssp", **heavier),
        "in place of more.ssv; lay": without(written, "", tmp_path / "c.ssp", **{"more.ssv": b""}),
        "holds no scene": without(written, "resources/scene.json", tmp_path / "d.ssp"),
        "is damaged": without(written, "", tmp_path / "e.ssp", **{"resources/scene.json": b"[]"}),
        "cannot be read as an SSP file": tmp_path / "f.ssp",
    }
    (tmp_path / "f.ssp").write_bytes(b"PK nothing")
    for sentence, path in cases.items():
        with pytest.raises(fanfold.FanfoldError, match=re.escape(sentence)):
            fanfold.load(path)
