"""The reference result inside the FMU of a scene (layered standard fmi-ls-ref), read and run by FMPy."""

from __future__ import annotations

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.util import read_csv

import orchestrator as fanfold
from fmus import Experiment, native_library
from orchestrator.api.simulate import as_scene
from orchestrator.assembly.assemble import assemble
from orchestrator.run.as_one.export import export_as_one
from tests.unit.run.as_one.host import latching

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
FOLDER, NAMESPACE = "extra/org.fmi-standard.fmi-ls-ref", "{http://fmi-standard.org/fmi-ls-manifest}"
EXPERIMENT = Experiment(1.5, 0.02, 1e-4)


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_an_importer_finds_the_result_of_the_default_experiment(tmp_path, fmi):
    """The layered standard for where it is; the run of the scene for latch-up; FMPy at a third of the step.

    Of FMPy's rows those at the times of the reference differ by less than the tolerance of the experiment.
    """
    assembly = assemble(as_scene(latching()).check_one_run(), (), (), "mean")
    path = export_as_one(assembly, tmp_path, EXPERIMENT, fmi=fmi, with_reference=True)
    with zipfile.ZipFile(path) as archive:
        manifest = ElementTree.fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
        (related,) = manifest
        assert related.attrib | {"description": ""} == {
            "type": "text/csv", "source": "latching_out.csv", "role": "result", "description": ""
        }  # fmt: skip
        table = archive.extract(f"{FOLDER}/{related.attrib['source']}", tmp_path)
    assert manifest.get(f"{NAMESPACE}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    reference = read_csv(table)
    names = reference.dtype.names[1:]
    assert np.allclose(reference["time"], 0.02 * np.arange(76), rtol=1e-12)
    result = fanfold.simulate(latching(), until=1.5, estimate=False)
    assert reference["HL.latch_time"][-1] == pytest.approx(result.latch_times["HL"], rel=1e-9)
    rows = simulate_fmu(str(path), stop_time=1.5, output_interval=0.02 / 3.0, output=list(names))[::3]
    for name in names:
        expected = reference[name]
        bound = EXPERIMENT.tolerance * np.abs(expected).max()
        np.testing.assert_allclose(rows[name].astype(float), expected, rtol=0.0, atol=bound, err_msg=name)


def test_a_reference_result_is_one_of_a_scene_as_one_fmu(tmp_path):
    """Components have no experiment of their own; the sentence names the option."""
    with pytest.raises(fanfold.FanfoldError, match="as_one"):
        fanfold.export(latching(), tmp_path, reference=True)
