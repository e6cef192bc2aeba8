"""The command line as a user meets it: what it prints where, exit codes, and sentences for whatever goes wrong."""

from __future__ import annotations

import json
import os
import platform
import signal
import subprocess
import sys
import time
import tomllib
from inspect import signature
from pathlib import Path

import pytest
from click.testing import CliRunner

from components import LAGGED, REGISTRY
from fmus import native_library
from orchestrator.analysis.sampling.distributions import FORMS
from orchestrator.cli import listing
from orchestrator.cli.main import main
from orchestrator.results.result import Result
from orchestrator.scene import list_scenes
from orchestrator.scene.builder import Scene
from orchestrator.scene.keys.listing import tables_called
from orchestrator.views.style import empty_figure, save_figure
from tests.references.edits import edited

ROOT = Path(__file__).parents[3]
SCENE = ROOT / "tests" / "scenes" / "two_panels.toml"
TWO_PANELS = SCENE.read_text(encoding="utf-8")
LATCH = 'latch = { stiffness = 200, outboard_stiffness = 200, effective_inertia = "1.5 kg.m2" }\n'
KEYS = {
    "latch_times",
    "latch_torque_peaks",
    "energy_residual",
    "steps",
    "iterations",
    "wall_time_s",
    "real_time_factor",
}
LONG_RUN = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # whatever runs the tests may ignore both
from orchestrator.cli.main import main
main()
"""


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def fanfold(*arguments):
    """Run a command; whatever happens, no traceback and no exception that is not click's own."""
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    assert "Traceback" not in result.output
    return result


def refused(*arguments):
    """What a command says on standard error before it ends with an exit code that is not 0, and says nothing else."""
    result = fanfold(*arguments)
    assert result.exit_code != 0
    assert result.stdout == ""
    return result.stderr


def scene_file(text, name="scene.toml"):
    Path(name).write_text(text, encoding="utf-8")
    return name


def test_list_names_scenes_and_components():
    """Completeness: every scene file and every registered component is listed."""
    output = fanfold("list").output
    assert "amos3" in output
    assert all(kind in output for kind in REGISTRY)


@pytest.mark.parametrize("kind", sorted(REGISTRY))
def test_list_tells_all_of_a_component(kind):
    """Completeness: every key of structure and parameters, every port and every recorded signal, with its meaning."""
    told, component = fanfold("list", kind).output, REGISTRY[kind].example()
    words = " ".join(told.split())
    recorded = [q for q in component.observation_layout.quantities if not q.name.endswith(LAGGED)]
    for quantity in (*component.parameter_layout.quantities, *component.own_inputs, *recorded):
        assert quantity.name in told
        assert quantity.description.split()[0] in words
    assert all(port.name in words for port in component.ports)
    assert all(key in told for key in signature(REGISTRY[kind]).parameters)


def test_list_of_what_is_no_component():
    assert "latch" in " ".join(refused("list", "latsh").split())
    assert "NAME" in refused("list", "ccl", "--names")


@pytest.mark.parametrize(
    "name", ["hinge_line", "hinge_line.latch", "latch", "panel", "ccl", "frame", "damper"]
)
def test_list_shows_the_keys_of_a_table(name):
    """Completeness: every key of every table of that name, and its example; of a component as well its keys."""
    told, tables = fanfold("list", name).output, tables_called(name)
    assert tables
    for table in tables:
        assert {key.name for key in table.keys} <= set(told.split())
        assert " ".join(table.example.split()) in " ".join(told.split())
    assert ("recorded signals" in told) == (name in REGISTRY)


def test_list_names_are_arguments_of_run():
    """Every scene and each of its variants once; each line loads."""
    lines = fanfold("list", "--names").output.splitlines()
    assert len(lines) == len(set(lines)) > len(list_scenes())
    assert {line.split()[0] for line in lines} == set(list_scenes())
    for name, *option in map(str.split, lines):
        assert option[:1] in ([], ["--variant"])
        Scene.load(name, option[1:])


def test_list_distributions_has_every_form():
    """Completeness: every distribution that `study` accepts."""
    told = fanfold("list", "distributions").output
    assert all(form in told for form, _ in FORMS.values())


def test_run_shows_numbers_and_writes_the_result():
    """End to end: a table for people, exit code 0, a complete result named after the scene."""
    result = fanfold("run", SCENE, "--until", 0.05)
    assert result.exit_code == 3
    assert "motor work" in result.stdout
    assert "energy residual" in result.stdout
    assert "steps" in result.stdout
    assert "two_panels.h5" in result.stdout.replace("\n", " ")
    assert "real-time factor" in result.stderr
    found = Result.open("two_panels.h5")
    assert found.complete
    assert found.time[-1] == pytest.approx(0.05)
    assert json.loads(found.provenance["scene_tree"]) == tomllib.loads(TWO_PANELS)
    assert len(found.provenance["fmu.root"]) == 64
    asked = {name: found.provenance[name] for name in ("master", "until", "tolerance")}
    assert asked == {"master": "implicit", "until": "0.05 s", "tolerance": "0.0001"}


def test_a_run_shows_few_numbers_or_all(tmp_path):
    """Layout: at most fifteen rows, costs and what comes next in a line each; with --all every headline number."""
    short = fanfold("run", SCENE, "--rigid", "all", "--until", 0.05, "--output", "a.h5").stdout
    every = fanfold("run", SCENE, "--rigid", "all", "--until", 0.05, "--output", "a.h5", "--all").stdout
    assert short.splitlines()[-1] == "next: fanfold report a.h5"
    assert "real time" in short.splitlines()[-2]
    assert "numerical" not in short
    assert "numerical" in every
    assert len(short.splitlines()) < 20 < len(every.splitlines())


def test_json_of_a_run_that_latches():
    """End to end: one JSON object and nothing else on standard output, hinge lines by name."""
    latch = ("hinges = [\n", LATCH + "hinges = [\n")
    motor = (('"2.0 N.m"', '"200 N.m"'), ('"1.2 N.m"', '"120 N.m"'))
    text = edited(TWO_PANELS, ('name = "middle_line"', 'name = "HL1"'), latch, *motor)
    result = fanfold(
        "run", scene_file(text), "--json", "--until", 0.5, "--tolerance", 1e-3, "--output", "a.h5"
    )
    assert result.exit_code == 3
    content = json.loads(result.stdout)
    assert set(content) >= KEYS
    assert set(content["latch_times"]) == set(content["latch_torque_peaks"]) == {"HL1"}
    assert 0.1 < content["latch_times"]["HL1"] < 0.5
    assert content["latch_torque_peaks"]["HL1"] > 10.0
    assert 0.0 <= content["energy_residual"] < 1e-3
    assert content["iterations"] > content["steps"] > 10
    assert content["real_time_factor"] == pytest.approx(0.5 / content["wall_time_s"])
    assert [text for _, _, text in Result.open("a.h5").events] == ["HL1 latch-up"]
    assert Result.open("a.h5").statistics["steps"] == content["steps"]


def test_verify_reports_errors():
    """End to end: value, extrapolation, error and order of every headline number, in the same JSON object."""
    result = fanfold("run", SCENE, "--json", "--verify", "--until", 0.1, "--output", "a.h5")
    assert result.exit_code == 3
    rows = {row["quantity"]: row for row in json.loads(result.stdout)["verification"]}
    row = rows["motor work"]
    assert row["id"] == "motor_energy"
    assert set(row) == {
        "id",
        "quantity",
        "of",
        "unit",
        "value",
        "extrapolated",
        "estimated_error",
        "observed_order",
    }
    assert row["unit"] == "J"
    assert row["estimated_error"] == pytest.approx(abs(row["value"] - row["extrapolated"]))
    assert row["estimated_error"] < 1e-2 * row["value"]
    assert Path("a.halved.h5").exists()


def test_verify_shows_whole_numbers_in_a_narrow_terminal():
    """Layout: no number of the verification table is cut off."""
    result = fanfold("run", SCENE, "--verify", "--until", 0.02)
    assert "extrapolated" in result.stdout
    assert "…" not in result.stdout


def test_verify_with_an_explicit_master():
    """Bad input: refused before anything runs."""
    assert "leave --master out" in refused("run", SCENE, "--verify", "--master", "jacobi")


def test_unknown_scene():
    """Bad input: the sentence names the scenes there are."""
    known = ", ".join(list_scenes())
    sentence = refused("run", "amos4")
    assert "'amos4'" in sentence
    assert known in sentence


def test_folder_as_a_scene(tmp_path):
    """Bad input: a folder is no scene file."""
    assert f"'{tmp_path}'" in refused("run", tmp_path)


@pytest.mark.parametrize(
    ("content", "sentences"),
    [
        (b"", ["scene.toml: scene: is missing", "scene.toml: base: is missing"]),
        (b"\x89\xff\x00\x01", ["scene.toml: "]),
        (b"[scene\n", ["scene.toml: Expected"]),
        (b"scene = 3\nbase = 4\n", ["scene.toml: scene: ", "scene.toml: base: "]),
    ],
    ids=["empty", "binary", "no TOML", "numbers for tables"],
)
def test_file_that_is_no_scene(content, sentences):
    """Bad input: sentences with the file's name, no result file."""
    Path("scene.toml").write_bytes(content)
    told = refused("run", "scene.toml")
    assert all(f"fanfold: {sentence}" in told for sentence in sentences)
    assert list(Path().glob("*.h5")) == []


def test_scene_with_many_problems():
    """Bad input: all problems at once, each a line with file and key."""
    text = edited(
        TWO_PANELS,
        ('"8 kg"', '"-8 kg"'),
        ("[0.9, 1.8, 2.7]", "[0.9, 1.8, 3.7]"),
        ('"90 deg"', '"90 m"'),
        ('outboard = "left"', 'outboard = "top"'),
        ('motor = { stowed = "2.0 N.m"', 'colour = "red"\nmotor = { stowed = "2.0 N.m"'),
    )
    lines = refused("run", scene_file(text)).splitlines()
    keys = ["body.inner.rigid.mass", "body.inner.rigid.inertia", "hinge_line.root_line.aligned_angle",
            "hinge_line.middle_line.colour"]  # fmt: skip
    assert len(lines) >= len(keys)
    assert all(line.startswith("fanfold: scene.toml: ") for line in lines)
    for key in keys:
        assert sum(f"scene.toml: {key}: " in line for line in lines) == 1


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--rigid", "door"], "'door'"),
        (
            ["--rigid", "yoke", "--flexible", "yoke"],
            "body.yoke: ",
        ),
        (["--until", "0"], "x>0"),
        (["--until", "nan"], "'--until': nan"),
        (["--until", "inf"], "'--until': inf"),
        (["--until", "soon"], "'soon' is not a valid number"),
        (["--tolerance", "1e-20"], "'--tolerance': 1e-20"),
        (["--tolerance", "nan"], "'--tolerance': nan"),
        (["--step", "-1"], "'--step': -1"),
        (["--step", "inf"], "'--step': inf"),
        (["--master", "newton"], "'newton'"),
        (["--output", "."], "is a directory"),
    ],
)
def test_impossible_options(options, sentence):
    """Bad input: an option that cannot be is told before anything runs."""
    assert sentence in refused("run", "amos3", *options)
    assert list(Path().glob("*.h5")) == []


def test_output_that_cannot_be_written():
    """Bad input: the file and the system's reason."""
    Path("file").write_text("x")
    assert "none/run.h5: " in refused("run", SCENE, "--until", 0.01, "--output", "none/run.h5")
    assert "file/run.h5: " in refused("run", SCENE, "--until", 0.01, "--output", "file/run.h5")


def test_output_does_not_replace_other_files():
    """Nothing lost: neither a scene that is given as output by mistake, nor a result of another run without leave."""
    scene = scene_file(TWO_PANELS)
    assert "scene.toml: " in refused("run", scene, "--until", 0.01, "--output", scene)
    assert Path(scene).read_text(encoding="utf-8") == TWO_PANELS
    run = ("run", scene, "--rigid", "all", "--no-estimate", "--output", "a.h5", "--until")
    assert fanfold(*run, 0.01).exit_code == fanfold(*run, 0.01).exit_code == 3
    assert "until 0.01 instead of 0.02" in refused(*run, 0.02)
    assert Result.open("a.h5").time[-1] == pytest.approx(0.01)
    assert fanfold(*run, 0.02, "--replace").exit_code == 3
    assert Result.open("a.h5").time[-1] == pytest.approx(0.02)


def test_results_of_other_fidelities_stand_side_by_side():
    """Regression: a rigid run replaced a flexible one of an hour, as both had one name."""
    run = ("run", SCENE, "--until", 0.005, "--no-estimate")
    for options in ((), ("--rigid", "all"), ("--rigid", "inner")):
        assert fanfold(*run, *options).exit_code == 3
    assert sorted(found.name for found in Path().glob("*.h5")) == [
        "two_panels.h5",
        "two_panels.mixed.h5",
        "two_panels.rigid.h5",
    ]
    before = Path("two_panels.mixed.h5").read_bytes()
    assert "rigid" in refused(*run, "--rigid", "outer")
    assert Path("two_panels.mixed.h5").read_bytes() == before


def test_no_phase_begins_where_a_later_one_is_refused(tmp_path):
    """Rule: before it starts; the first phase would have been for nothing."""
    path = phased(tmp_path)
    assert fanfold("run", path, "--variant", "second", "--set", "scene.until=0.02").exit_code in (0, 3)
    assert "two_panels.second.h5" in refused("run", path)
    assert not Path("two_panels.first.h5").exists()


def test_run_that_diverges():
    """Exit code: an explicit master at too long a step fails with a sentence; what it did is in the file."""
    told = refused(
        "run", SCENE, "--master", "jacobi", "--step", 5e-3, "--until", 2, "--output", "a.h5", "--json"
    )
    assert "diverges" in told
    assert "a.h5" in told
    assert not Result.open("a.h5").complete


@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
@pytest.mark.parametrize(
    "name", ["SIGTERM", *(pytest.param(name, marks=pytest.mark.thorough) for name in ("SIGINT", "SIGHUP"))]
)
def test_interrupted_run_is_readable(tmp_path, name):
    """Nothing lost: Ctrl-C, and what ends jobs, ends a run between steps: a sentence, exit code 1, a readable file."""
    path, temporary = tmp_path / "a.h5", tmp_path / "temporary"
    temporary.mkdir()
    command = [
        sys.executable,
        "-c",
        LONG_RUN,
        "run",
        str(SCENE),
        "--until",
        "1000",
        "--output",
        str(path),
        "--json",
    ]
    with subprocess.Popen(
        command,
        cwd=ROOT,
        env={**os.environ, "TMPDIR": str(temporary)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
    ) as run:
        deadline = time.monotonic() + 60.0
        while not path.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.5)
        run.send_signal(getattr(signal, name))
        stdout, stderr = run.communicate(timeout=60)
    assert run.returncode == 1
    assert stdout == ""
    assert "two_panels: interrupted at t = " in stderr
    assert "Traceback" not in stderr
    result = Result.open(path)
    assert not result.complete
    assert result.time.size > 1
    assert [found for found in temporary.rglob("*") if found.is_file()] == []


def test_resume_without_a_checkpoint():
    """Bad input: nothing to go on from is told with what would have kept it."""
    assert "--checkpoint" in refused("resume", "a.h5")
    assert fanfold("run", SCENE, "--until", 0.05, "--checkpoint", 0.02, "--output", "a.h5").exit_code == 3
    assert "a.h5.checkpoint" in refused("resume", "a.h5")


def test_plot_draws_pictures():
    """End to end: the pictures of a short run exist where the command says."""
    assert fanfold("run", SCENE, "--until", 0.05, "--output", "a.h5").exit_code == 3
    result = fanfold("plot", "a.h5", "--output", "pictures")
    assert result.exit_code == 0
    paths = [Path(line) for line in result.stdout.splitlines()]
    assert len(paths) >= 3
    assert all(path.parent == Path("pictures") and path.stat().st_size > 1000 for path in paths)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (None, "not exist"),
        (b"", "a.h5: "),
        (b"time,angle\n0,1\n", "a.h5: "),
        (b"\x89HDF\r\n\x1a\n" + bytes(200), "fanfold: a.h5: "),
    ],
    ids=["none", "empty", "text", "damaged"],
)
def test_plot_of_what_is_no_result(content, sentence):
    """Bad input: a file that is no result is told, no picture is made."""
    if content is not None:
        Path("a.h5").write_bytes(content)
    assert sentence in refused("plot", "a.h5")
    assert list(Path().glob("**/*.png")) == []


def test_exported_fmus_pass_the_check():
    """End to end: one FMU per component of the scene, none with a problem."""
    result = fanfold("export", SCENE, "-o", "fmus")
    assert result.exit_code == 0
    assert ("glibc 2." in result.stderr) == (
        platform.libc_ver()[0] == "glibc" and native_library() is not None
    )
    paths = result.stdout.split()
    names = {"base", "inner", "outer", "root", "middle_left", "middle_right"}
    assert {Path(path).stem for path in paths} == names
    result = fanfold("check", *paths)
    assert result.exit_code == 0
    assert result.stdout.count(": OK") == len(names)


def test_check_of_what_is_no_fmu():
    """Exit code: one bad file among good ones is enough."""
    Path("a.fmu").write_bytes(b"not a zip archive")
    result = fanfold("check", "a.fmu")
    assert result.exit_code == 1
    assert "a.fmu: " in result.stdout
    assert "not exist" in refused("check", "none.fmu")


def test_export_to_an_impossible_folder():
    """Bad input: a folder that cannot be made is told by name with the system's reason."""
    Path("file").write_text("x")
    assert "fanfold: file/fmus: Not a directory" in refused("export", SCENE, "-o", "file/fmus")
    assert "is a file" in refused("export", SCENE, "-o", "file")


def test_help_of_every_command():
    """Completeness: every command explains itself."""
    for name in main.commands:
        assert "Usage:" in fanfold(name, "--help").stdout


PHASES = """
[variant.first]
scene.until = 0.02
[variant.second]
scene.until = 0.03
hinge_line = [{ name = "root_line", held = true }]
"""


def phased(folder):
    path = folder / "phased.toml"
    text = edited(TWO_PANELS, ("until = 2.0", 'until = 2.0\nphases = ["first", "second"]'))
    path.write_text(text + PHASES, encoding="utf-8")
    return path


def test_phases_run_one_after_the_other_and_are_one_json_object(tmp_path):
    found = json.loads(fanfold("run", phased(tmp_path), "--json").stdout)["phases"]
    assert [found[name]["end_time"] for name in ("first", "second")] == pytest.approx([0.02, 0.03])
    for name in ("first", "second"):
        assert Result.open(f"two_panels.{name}.h5").complete
    single = json.loads(fanfold("run", phased(tmp_path), "--variant", "second", "--json").stdout)
    assert single["end_time"] == pytest.approx(0.03)


def test_what_takes_one_run_asks_for_a_phase(tmp_path):
    path = phased(tmp_path)
    assert "first, second" in refused("export", path, "-o", tmp_path)
    assert "first, second" in refused("analyse", "modes", path)
    ended = fanfold("run", path, "--until", 0.01)
    assert ended.exit_code == 2
    assert "choose a phase with --variant: first, second" in ended.stderr


def test_lines_that_do_not_latch_are_told_of(tmp_path):
    """The first question: does it always open. Here friction exceeds the motor's torque."""
    path = tmp_path / "stuck.toml"
    latch = "friction_preload = 5.0\nlatch = { stiffness = 2000, effective_inertia = 5 }\nhinges ="
    text = edited(TWO_PANELS, ("hinges =", latch), count=1)
    path.write_text(text, encoding="utf-8")
    found = fanfold("run", path, "--until", 0.2)
    assert found.exit_code == 3
    assert "root_line" in found.stderr
    assert "not latched" in found.stdout
    angles = json.loads(fanfold("run", path, "--until", 0.2, "--json").stdout)["unlatched_angles"]
    assert abs(angles["root_line"]) < 0.05


def test_an_explicit_master_needs_a_step():
    refusal = fanfold("run", SCENE, "--master", "jacobi")
    assert refusal.exit_code == 2
    assert "needs a --step" in refusal.stderr


def test_an_interruption_while_libraries_load_is_a_sentence(monkeypatch):
    """Regression: pybind11 raises ImportError, "initialization failed", of Ctrl-C within an import: a traceback."""

    def interrupted(*_):
        raise ImportError("initialization failed") from KeyboardInterrupt()

    monkeypatch.setattr(listing.fanfold, "scenes", interrupted)
    assert "list: interrupted" in refused("list")


def test_an_interrupted_picture_leaves_no_file(tmp_path, monkeypatch):
    """Regression: Ctrl-C during `plot` left a PNG of 124 bytes, or cut an earlier one off."""
    path, figure = tmp_path / "a.png", empty_figure(1.0, 1.0)
    save_figure(figure, path)
    whole = path.read_bytes()

    def cut_off(stream, **_):
        stream.write(b"PNG")
        raise KeyboardInterrupt

    monkeypatch.setattr(figure, "savefig", cut_off)
    with pytest.raises(KeyboardInterrupt):
        save_figure(figure, path)
    assert [one.name for one in tmp_path.iterdir()] == ["a.png"]
    assert path.read_bytes() == whole
    assert path.stat().st_mode & 0o777 == 0o644
