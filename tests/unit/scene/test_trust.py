"""Files from others run no code: plugins that a scene, an .ssp or a result names run where someone says so."""

import json
from shutil import copyfile
from zipfile import ZipFile

import h5py
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.analysis.stress.model import scene_of
from orchestrator.cli.main import main
from orchestrator.scene.table import SceneError
from orchestrator.views.report.scene3d.content import content

pytestmark = pytest.mark.usefixtures("kept_registry", "nothing_trusted")


@pytest.fixture
def trap(tmp_path, monkeypatch):
    """A plugin that counts how often it runs, in a file beside it; content as no other test has it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "trap.py").write_text(
        f"with open({str(tmp_path / 'ran')!r}, 'a') as file:\n    file.write('x')\n"
    )
    return tmp_path / "trap.py"


def ran(trap):
    marks = trap.with_name("ran")
    return len(marks.read_text()) if marks.exists() else 0


def scene_with(trap):
    path = trap.with_name("wing.toml")
    path.write_text(
        f'extends = "workbench"\n[scene]\nname = "wing"\nuntil = "0.01 s"\nplugins = [{str(trap)!r}]\n'
    )
    return path


def fanfold_says(*words):
    found = CliRunner().invoke(main, [str(word) for word in words])
    assert found.exception is None or isinstance(found.exception, SystemExit), found.exception
    return found


@pytest.mark.parametrize(
    "words",
    [
        ("check",),
        ("run", "--rigid", "all", "--no-estimate"),
        ("study", "--vary", "friction.coefficient=uniform(0.1, 0.2)"),
        ("analyse", "modes"),
        ("export", "-o", "fmus"),
    ],
)
def test_scenes_name_their_plugins_and_run_none(trap, words):
    """Reproduction: `check` ran the code of a scene before it said anything of it."""
    found = fanfold_says(*words, scene_with(trap))
    assert found.exit_code == 1
    assert f"--plugin {trap}" in found.output
    assert "--trust" in found.output
    assert ran(trap) == 0


def test_trust_is_remembered_until_the_plugin_changes(trap):
    """Asked for once; by content, so that what changed is asked for again. --plugin is for once."""
    scene = scene_with(trap)
    fanfold_says("check", scene, "--plugin", trap)
    assert ran(trap) == 1
    trap.write_text(trap.read_text() + "\n")
    for words in (("--trust",), ()):
        assert "--trust" not in fanfold_says("check", scene, *words).output
    trap.write_text(trap.read_text() + "# changed\n")
    before = ran(trap)
    assert "--trust" in fanfold_says("check", scene).output
    assert ran(trap) == before


def test_scenes_built_in_code_run_the_plugins_that_the_code_names(trap):
    fanfold.Scene("mine", until="1 s", plugins=[str(trap)]).copy()
    with pytest.raises(SceneError, match="trust=True"):
        fanfold.load(scene_with(trap))
    assert ran(trap) == 0
    wing = fanfold.load("workbench")
    built = fanfold.Scene("mine", until="1 s", plugins=[str(trap)])
    built._layers.tree.update({key: value for key, value in wing.tree.items() if key != "scene"})
    built.check()
    assert ran(trap) == 1


def test_a_cache_of_python_beside_a_plugin_is_not_run(trap):
    """A __pycache__ that needs no check (PEP 552) would run in place of the file whose digest is trusted."""
    from importlib.util import cache_from_source
    from py_compile import PycInvalidationMode, compile

    harmless = trap.with_name("harmless.py")
    harmless.write_text("x = 1\n")
    compile(
        str(trap),
        cache_from_source(str(harmless)),
        invalidation_mode=PycInvalidationMode.UNCHECKED_HASH,
    )
    fanfold.load_plugin(harmless)
    assert ran(trap) == 0


def test_a_system_structure_with_a_changed_scene_runs_nothing(trap):
    """Its digest is no signature: one without it is taken."""
    path = trap.with_name("wing.ssp")
    with ZipFile(path, "w") as archive:
        scene = scene_with(trap).read_text()
        archive.writestr("resources/scene.json", json.dumps({"scene": scene, "system": {}}))
    for words in (("check",), ("run", "--rigid", "all")):
        assert f"--plugin {trap}" in fanfold_says(*words, path).output
    assert ran(trap) == 0


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The file of a short run, to be copied."""
    path = tmp_path_factory.mktemp("whole") / "t.h5"
    with pytest.warns(fanfold.FanfoldWarning):
        fanfold.simulate("workbench", rigid="all", until=0.01, estimate=False, save=path)
    return path


@pytest.fixture
def result(whole, tmp_path):
    """A function that puts another scene into a result, and returns its file."""
    copyfile(whole, tmp_path / "t.h5")

    def tamper(change):
        with h5py.File(tmp_path / "t.h5", "r+") as file:
            tree = json.loads(file["provenance"]["scene_tree"][()])
            changed = change(tree)
            del file["provenance"]["scene_tree"]
            file["provenance"]["scene_tree"] = json.dumps(tree if changed is None else changed)
        return tmp_path / "t.h5"

    return tamper


def test_a_result_runs_no_plugin_that_it_names(trap, result):
    """Reproduction: `report` and `analyse stress` ran a file that a result named. --plugin loads one of its name."""
    path = result(lambda tree: tree["scene"].update(plugins=[str(trap)]))
    told = fanfold_says("analyse", "stress", path, "--body", "panel", "--trust")
    assert f"--plugin {trap}" in told.output
    assert fanfold_says("report", path, "--trust", "--frames", "0").exit_code == 0
    assert ran(trap) == 0
    fanfold_says("analyse", "stress", path, "--body", "panel", "--plugin", trap)
    assert ran(trap) == 1
    assert scene_of(fanfold.Result.open(path)).header.plugins == (str(trap),)


def test_a_result_opens_no_file_that_no_scene_has_opened(result, tmp_path):
    """An absolute or network path of [body.import]; `trust` lets it be opened, as does a scene that names it."""
    data = tmp_path / "data.npz"

    def named(tree):
        tree["body"] = [{"name": "panel", "import": {"file": str(data), "attachment_points": {"a": 1}}}]

    path = result(named)
    opened = fanfold.Result.open(path)
    with pytest.raises(SceneError, match="--trust"):
        scene_of(opened)
    fanfold.trust(path)
    with pytest.raises(SceneError, match=r"data\.npz") as told:
        scene_of(opened)
    assert "--trust" not in str(told.value)


@pytest.mark.parametrize(
    "tree",
    [{"scene": 5}, {"scene": {"name": 3}}, {"body": 5}, {"body": [5]}, [], 5, {"hinge_line": {"a": 1}}],
)
def test_a_damaged_scene_in_a_result_is_a_sentence(result, tree):
    """Reproduction: AttributeError where the scene was a number, in stresses and in the page."""
    opened = fanfold.Result.open(result(lambda _: tree))
    with pytest.raises(fanfold.FanfoldError):
        scene_of(opened)
    assert len(content([opened], ["A"], ["run"]).remarks) == 1


def test_a_damaged_scene_leaves_a_report(result, tmp_path):
    opened = fanfold.Result.open(result(lambda _: {"scene": 5}))
    assert fanfold.report(opened, tmp_path / "page.html", frames=0).exists()
