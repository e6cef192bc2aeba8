"""An earlier result gives way to a run of the same settings, and to no other without leave."""

from dataclasses import fields

import h5py
import pytest

import orchestrator as fanfold
from orchestrator.run.checkpoint import checkpoint_file
from orchestrator.run.simulation import Options, fidelity_word, result_file
from tests.unit.run.test_resume import TWO_PANELS

pytestmark = pytest.mark.filterwarnings("ignore::orchestrator.FanfoldWarning")
ASKED = {"rigid": "all", "until": 0.01, "estimate": False}


@pytest.fixture(scope="module")
def content(tmp_path_factory):
    """The bytes of a result."""
    path = tmp_path_factory.mktemp("earlier") / "run.h5"
    fanfold.simulate(TWO_PANELS, **ASKED, save=path)
    return path.read_bytes()


@pytest.fixture
def path(content, tmp_path):
    """A result that is there already."""
    found = tmp_path / "run.h5"
    found.write_bytes(content)
    return found


def refused(path, scene=TWO_PANELS, **others):
    """What is said of a run that is refused; the file stays in every byte."""
    before = path.read_bytes()
    with pytest.raises(fanfold.FanfoldError) as caught:
        fanfold.simulate(scene, **{**ASKED, **others}, save=path, replace=False)
    assert path.read_bytes() == before
    assert "--output" in str(caught.value)
    return str(caught.value)


OTHERS = {
    "rigid": (),
    "flexible": "all",
    "large_deformation": "inner",
    "until": 0.011,
    "tolerance": 1e-3,
    "step": 1e-4,
    "order": 2,
    "master": "jacobi",
    "backend": "python",
    "checkpoint": 0.005,
    "refine": False,
    "record": 0.1,
    "signals": "root*",
    "estimate": True,
}


def test_every_setting_of_a_run_is_compared():
    """Completeness: of options only processes change nothing in a result."""
    assert OTHERS.keys() == {one.name for one in fields(Options)} - {"isolate"} | {"estimate"}


@pytest.mark.parametrize("name", OTHERS)
def test_a_run_of_other_settings_is_refused(path, name):
    """Rule: each setting alone keeps the earlier result, and is named."""
    needed = {"step": 2e-5} if name == "master" else {}
    assert name in refused(path, **{name: OTHERS[name], **needed})


def test_a_run_of_another_scene_is_refused(path):
    """Rule: the key that differs is named; --set and variants are part of the scene."""
    sentence = refused(path, fanfold.load(TWO_PANELS, settings={"body.inner.rigid.mass": "9 kg"}))
    assert all(part in sentence for part in ("body.inner.rigid.mass", "8 kg", "9 kg"))


def test_a_run_of_the_same_settings_replaces(path):
    """Rule: what defaults say is the same as what is written; the content is that of a new run."""
    before = path.stat().st_mtime_ns
    tolerance = fanfold.load(TWO_PANELS).check().header.tolerance
    fanfold.simulate(TWO_PANELS, **ASKED, tolerance=tolerance, isolate=True, save=path, replace=False)
    assert path.stat().st_mtime_ns != before
    fanfold.simulate(TWO_PANELS, **{**ASKED, "until": 0.012}, save=path)
    assert fanfold.Result.open(path).time[-1] == 0.012


def test_what_cannot_be_compared_stays(path):
    """Bad input: a damaged result, one that does not say what it was made with; without rows none is lost."""
    with h5py.File(path, "r+") as file:
        del file["provenance/settings"]
    assert "does not say what it was made with" in refused(path)
    path.write_bytes(path.read_bytes()[:-3000])
    assert "damaged" in refused(path)
    fanfold.simulate(TWO_PANELS, **ASKED, save=path)
    with h5py.File(path, "r+") as file:
        file["time"].resize(0, 0)
    fanfold.simulate(TWO_PANELS, **{**ASKED, "until": 0.012}, save=path, replace=False)


@pytest.mark.parametrize("replace", [True, False])
def test_other_files_always_stay(tmp_path, replace):
    """Bad input: HDF5 of others, such as a study."""
    path = tmp_path / "other.h5"
    with h5py.File(path, "w") as file:
        file.attrs["format"] = "fanfold study"
    before = path.read_bytes()
    with pytest.raises(fanfold.FanfoldError, match="is not a result and would be lost"):
        fanfold.simulate(TWO_PANELS, **ASKED, save=path, replace=replace)
    assert path.read_bytes() == before


def test_a_run_that_can_be_resumed_stays(path):
    """Rule: as an interrupted study does; the same run anew would make hours of it once more."""
    checkpoint_file(path).write_bytes(b"state")
    assert f"fanfold resume {path}" in refused(path)


@pytest.mark.thorough
def test_a_repeated_run_says_what_it_was_made_with(tmp_path, monkeypatch):
    """Regression: the repetition of a run that misses its tolerance had lost it, and could not be replaced."""
    path, asked = tmp_path / "run.h5", {"rigid": "all", "until": 0.02}
    monkeypatch.setattr("orchestrator.run.error_estimate._LIKELY", 1e9)
    fanfold.simulate("workbench", **asked, save=path)
    assert "refined_tolerance" in fanfold.Result.open(path).provenance
    fanfold.simulate("workbench", **asked, save=path, replace=False)


def test_files_of_a_scene_are_compared(tmp_path, content):
    """Rule: a file that the scene reads has changed, though the scene is the same."""
    plugin, scene, path = tmp_path / "mine.py", tmp_path / "wing.toml", tmp_path / "run.h5"
    plugin.write_text("")
    text = TWO_PANELS.read_text(encoding="utf-8").replace("[scene]", '[scene]\nplugins = ["mine.py"]')
    scene.write_text(text, encoding="utf-8")
    fanfold.simulate(fanfold.load(scene, trust=True), **ASKED, save=path)
    plugin.write_text("# changed")
    assert "mine.py" in refused(path, fanfold.load(scene, trust=True))


@pytest.mark.parametrize(
    ("kinds", "name"),
    [
        ({}, "wing.cold.h5"),
        ({"rigid": {"all"}}, "wing.cold.rigid.h5"),
        ({"flexible": {"all"}}, "wing.cold.flexible.h5"),
        ({"large_deformation": {"all"}, "rigid": ()}, "wing.cold.large_deformation.h5"),
        ({"rigid": {"panel"}}, "wing.cold.mixed.h5"),
        ({"rigid": {"all"}, "flexible": {"panel"}}, "wing.cold.mixed.h5"),
    ],
)
def test_names_carry_the_fidelity(kinds, name):
    """Rule: one word where all bodies are alike, mixed otherwise, none where they are as the scene says."""
    assert str(result_file("wing", ["cold"], fidelity_word(**kinds))) == name
