"""SSP files: against the schema of the standard and FMPy's own reader, and what the FMUs in them have."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest
from fmpy import read_model_description

import orchestrator as fanfold
from fmus import native_library

pytest.importorskip("pyssp_standard")
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
