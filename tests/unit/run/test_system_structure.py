"""SSP files: against the schema of the standard and FMPy's own reader, and what the FMUs in them have."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from lxml import etree

import orchestrator as fanfold
from fmus import native_library
from tests.unit.run.as_one.host import Host

pytestmark = pytest.mark.skipif(native_library() is None, reason="there is no native library here")

PER_PORT = 13 + 6


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """The SSP file of the workbench with a rigid panel."""
    folder = tmp_path_factory.mktemp("ssp")
    return fanfold.export("workbench", folder, rigid="all", ssp=folder / "workbench.ssp")[-1]


def test_keeps_to_the_schema(written):
    """Against the schema of SSP 1.0, as the format's library holds it, and its rules for connections."""
    from pyssp_standard.ssp import SSP

    with SSP(written, mode="r") as archive, archive.system_structure as structure:
        structure.__check_compliance__()
        assert structure.check_connections(connector_not_in_system=True, unconnected_inputs=True) == []


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


def test_fmpy_reads_it(written, tmp_path):
    """Against another reader: four components, every link of every port."""
    from fmpy.ssp.ssd import read_ssd

    found = read_ssd(str(written))
    assert {c.name: Path(c.source).name for c in found.system.elements} == {
        name: f"{name}.fmu" for name in ("workbench_table", "panel", "hinge_left", "hinge_right")
    }
    assert len(found.system.connections) == 4 * PER_PORT


def test_connectors_are_variables_of_the_fmus(written, tmp_path):
    """Rule: name, causality and unit of a connector are those of the FMU in the archive; the step is the FMUs' own."""
    from fmpy.ssp.ssd import read_ssd

    with zipfile.ZipFile(written) as archive:
        archive.extractall(tmp_path)
        structure = re.sub(r">\s+<", "><", archive.read("SystemStructure.ssd").decode())
    for component in read_ssd(str(written)).system.elements:
        description = read_model_description(str(tmp_path / component.source))
        variables = {v.name: v for v in description.modelVariables}
        assert component.connectors
        for connector in component.connectors:
            variable = variables[connector.name]
            assert connector.kind == variable.causality
            assert (
                f'name="{connector.name}" kind="{connector.kind}"><ssc:Real unit="{variable.unit}"/>'
                in structure
            )
        assert f'stepSize="{float(description.defaultExperiment.stepSize):g}"' in structure
    assert 'DefaultExperiment startTime="0.0" stopTime="5.3"' in structure


@pytest.mark.parametrize(
    ("name", "options"),
    [("wing.zip", {}), ("wing.ssp", {"fmi": "3.0"}), ("wing.ssp", {"wrench_mode": "mean"})],
)
def test_what_cannot_be_one_is_refused_before_anything_is_written(name, options, tmp_path):
    with pytest.raises(fanfold.FanfoldError, match="SSP file"):
        fanfold.export("workbench", tmp_path, rigid="all", ssp=tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_a_scene_as_one_fmu_is_one_element(tmp_path):
    """Against the schema, with all its inputs and outputs as connectors; a run of the file is that of the scene."""
    from fmpy.ssp.ssd import read_ssd
    from pyssp_standard.ssp import SSP

    fmu, written = fanfold.export("workbench", tmp_path, rigid="all", as_one=True, ssp=tmp_path / "one.ssp")
    with SSP(written, mode="r") as archive, archive.system_structure as structure:
        structure.__check_compliance__()
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
