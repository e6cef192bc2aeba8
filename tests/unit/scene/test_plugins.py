"""Components, bodies and figures from outside: loaded by scenes and commands, anew when changed, told when broken."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from components import REGISTRY
from components.contract.plugins import PluginError, load_plugin
from fmus import check_fmu
from orchestrator.cli.main import main
from orchestrator.scene import data_sheets
from orchestrator.scene.bodies import body_model
from orchestrator.scene.plugins import loading
from orchestrator.views import plots
from tests.references import synthetic_result
from tests.references.relative_motion import inputs, port_motion

TAPE = Path(__file__).parents[3] / "examples" / "plugins" / "tape_spring.py"
SMALL = """
from components.numerics.axial import AxialConnection


class Small(AxialConnection):
    kind = "small"
"""
BODY = """
[{name}]
like = ["workbench_panel"]

[{name}.panel]
length = {{ value = {length}, unit = "m", source = "assumed" }}
"""


pytestmark = pytest.mark.usefixtures("kept_registry", "nothing_trusted")


def driven(component, angles, h=0.01):
    """Heat (J) and torque (N.m) of the tape spring where its outboard port turns through angles (rad) about y."""
    c = component.prepare(component.parameter_layout.start_values())

    def at(angle):
        return inputs(component, port_motion(), port_motion(turn=(0.0, angle, 0.0)))

    x, found = component.initial(c, at(angles[0])), []
    for angle in angles[1:]:
        x = component.step(c, x, at(angle), h)
        found.append(component.observe(c, x, at(angle)))
    place = component.observation_layout
    rows = np.array(found)
    return {
        name: rows[:, place[name]][:, 0] for name in ("tape_torque", "potential_energy", "dissipated_energy")
    }


def test_the_tape_spring_takes_the_area_between_its_tables():
    """Closed form: -0.5 and -0.4 N.m, 0.05 N.m of friction on 20 N.m/rad: 1 to 2 rad and back, but for settling."""
    load_plugin(TAPE)
    component = REGISTRY["tape_spring"]()
    out, back = np.linspace(1.0, 2.0, 301), np.linspace(2.0, 1.0, 301)
    found = driven(component, [*out, *back[1:]])
    assert found["tape_torque"][299] == pytest.approx(-0.5, rel=1e-12)
    assert found["tape_torque"][-1] == pytest.approx(-0.4, rel=1e-12)
    slid = (1.0 - 0.05 / 20.0) + (1.0 - 2.0 * 0.05 / 20.0)
    assert found["dissipated_energy"][-1] == pytest.approx(0.05 * slid, rel=1e-9)


def test_scenes_load_plugins_beside_them(tmp_path):
    """A path from the scene's folder; a variant and another scene that extends it keep it."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "small.py").write_text(SMALL)
    path = tmp_path / "wing.toml"
    path.write_text('extends = "workbench"\n[scene]\nname = "wing"\nplugins = ["parts/small.py"]\n')
    fanfold.load(path, trust=True)
    assert "small" in REGISTRY
    assert fanfold.load(path).tree["scene"]["plugins"] == [str(tmp_path / "parts" / "small.py")]


def test_a_changed_file_is_loaded_again(tmp_path):
    path = tmp_path / "small.py"
    path.write_text(SMALL)
    assert load_plugin(path) == {"small"}
    first = REGISTRY["small"]
    assert load_plugin(path) == {"small"}
    assert REGISTRY["small"] is first
    path.write_text(SMALL.replace('"small"', '"smaller"'))
    assert load_plugin(path) == {"smaller"}
    assert "small" not in REGISTRY


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.py", "x = (", "a.py:1: SyntaxError"),
        ("a.py", "\n\nimport nowhere_at_all", "a.py:3: ModuleNotFoundError"),
        ("a.py", "raise SystemExit(3)", "a.py:1: SystemExit: 3"),
        ("a.py", SMALL.replace('"small"', '"hinge"'), "kind 'hinge'"),
        ("a.txt", "", ".toml"),
        ("a.toml", "x = [", "a.toml: "),
        (
            "a.toml",
            BODY.format(name="workbench_panel", length=1.0),
            "workbench_panel: ",
        ),
    ],
)
def test_what_cannot_be_loaded_is_a_sentence(tmp_path, name, content, said):
    """Bad input: file, line and what is wrong; the registry stays as it was."""
    known = dict(REGISTRY)
    (tmp_path / name).write_text(content)
    with pytest.raises(fanfold.FanfoldError) as refused:
        fanfold.load_plugin(tmp_path / name)
    assert said in str(refused.value)
    assert known == REGISTRY
    wing = tmp_path / "wing.toml"
    wing.write_text(f'extends = "workbench"\n[scene]\nname = "wing"\nplugins = ["{name}"]\n')
    (problem,) = fanfold.check_scene(wing, trust=True).problems
    assert "scene.plugins: " in problem
    assert said in problem


UNFINISHED = """
from typing import Annotated, NamedTuple

from components.contract.connection import HEAT, Impulse
from components.contract.record import Record, tunable
from components.numerics.axial import AxialConnection


class Parameters(NamedTuple):
    braking: Annotated[float, tunable("N.m.s/rad", "Braking", {start}, 0.0)]


class States(NamedTuple):
    heat: Annotated[float, HEAT]


class Brake(AxialConnection):
    kind, order, axis_of = "unfinished", 2, "the axis"
    parameters, states, commands = Record(Parameters), Record(States), Record(Impulse)
"""


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ("1.0", "observations"),
        ("'x'", "'x'"),
    ],
)
def test_components_that_lack_something_are_sentences(tmp_path, start, said):
    """Regression: tracebacks, of an attribute that was not there and of a text that was no float."""
    (tmp_path / "brake.py").write_text(UNFINISHED.format(start=start))
    wing = tmp_path / "wing.toml"
    wing.write_text(
        'extends = "workbench"\n[scene]\nname = "wing"\nplugins = ["brake.py"]\n[[connection]]\nname = "b"\n'
        'kind = "unfinished"\nports = { inboard = { body = "base", point = "hl_left" }, '
        'outboard = { body = "panel", point = "hl_left" } }\n'
    )
    assert any(said in problem for problem in fanfold.check_scene(wing, trust=True).problems)


TRIED = (
    UNFINISHED.replace("{start}", "1.0")
    .replace("N.m.s/rad", "{unit}")
    .replace("class States(NamedTuple):", "class States(NamedTuple):\n    turn: Turn")
    .replace("import AxialConnection", "import AxialConnection, Turn")
    .replace("tunable\n", "observed, tunable\n")
    + """
    observations = Record(NamedTuple("Angle", [("angle", Annotated[float, observed("rad", "Angle")])]))

    def start(self, c, u):
        return States(self._turn(u, 0.0)[0], 0.0)

    def advance(self, c, s, u, h):
        return s._replace(heat={heat})
"""
)
RECORD = """
    def record(self, c, s, u):
        return (s.turn.angle / {by},)
"""


@pytest.mark.parametrize(
    ("unit", "heat", "record", "said"),
    [
        (
            "furlong",
            "0.0",
            RECORD.format(by="1.0"),
            "unit 'furlong'",
        ),
        ("N.m.s/rad", "0.0", "", "'record'"),
        (
            "N.m.s/rad",
            "0.0",
            RECORD.format(by="0.0"),
            "ZeroDivisionError",
        ),
        (
            "N.m.s/rad",
            "0.0",
            RECORD.format(by="float('nan')"),
            "0.001 s",
        ),
        ("N.m.s/rad", "(0.0, 0.0)", RECORD.format(by="1.0"), "States has "),
    ],
)
def test_what_only_a_step_shows_is_told_before_a_run(tmp_path, unit, heat, record, said):
    """Regression: `check` found no problem in what runs and analyses of it ended at, some with a traceback."""
    (tmp_path / "brake.py").write_text(TRIED.format(unit=unit, heat=heat) + record)
    wing = tmp_path / "wing.toml"
    wing.write_text(
        'extends = "workbench"\n[scene]\nname = "wing"\nplugins = ["brake.py"]\n[[connection]]\nname = "b"\n'
        'kind = "unfinished"\nports = { inboard = { body = "workbench_table", point = "hl_left" }, '
        'outboard = { body = "panel", point = "hl_left" } }\n'
    )
    (problem,) = fanfold.check_scene(wing, trust=True).problems
    assert said in problem


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(PluginError, match=r"none.py: "):
        load_plugin(tmp_path / "none.py")


def test_bodies_from_outside(tmp_path, monkeypatch):
    """A file of bodies: used by its name, and built anew where it has changed."""
    monkeypatch.setattr(data_sheets, "_added", {})
    sheet, wing = tmp_path / "mine.toml", tmp_path / "wing.toml"
    wing.write_text(
        'extends = "workbench"\n[scene]\nname = "wing"\nplugins = ["mine.toml"]\n'
        '[[body]]\nname = "panel"\ncatalogue = "my_panel"\n'
    )
    lengths = []
    for length in ("1.5", "1.7"):
        sheet.write_text(BODY.format(name="my_panel", length=length))
        body = fanfold.load(wing).check().bodies[0]
        lengths.append(body_model(body, flexible=False).center_of_mass[0])
    assert lengths[1] - lengths[0] == pytest.approx(0.1, abs=0.02)


def test_a_figure_that_fails_is_left_out_with_its_line(tmp_path, monkeypatch):
    """Regression: `plot` and `report` ended with its traceback, and without a picture or a page."""
    monkeypatch.setattr(plots, "_added", {})
    (tmp_path / "views.py").write_text(
        "import orchestrator as fanfold\n\n\n@fanfold.figure('mine')\ndef draw(result):\n    return 1 / 0\n"
    )
    fanfold.load_plugin(tmp_path / "views.py")
    result = fanfold.Result.open(synthetic_result.write(tmp_path / "a.h5"))
    with pytest.warns(fanfold.FanfoldWarning, match=r"'mine' .*views\.py:6.*ZeroDivisionError"):
        drawn = [drawing.name for drawing in plots.draw_all(result)]
    assert drawn
    assert "mine" not in drawn


def test_installed_plugins_are_loaded_and_told_of_where_they_fail(monkeypatch):
    """Entry points: one that registers, and one that cannot be imported."""

    class Point:
        name, value = "mine", "my_parts"

        def __init__(self, act):
            self.load = act

    loaded = []
    monkeypatch.setattr(
        loading, "entry_points", lambda group: [Point(lambda: loaded.append(group)), Point(lambda: 1 / 0)]
    )
    loading._installed.cache_clear()
    try:
        told = list(loading.problems([]))
    finally:
        loading._installed.cache_clear()
    assert loaded == ["fanfold.plugins"]
    (sentence,) = told
    assert "mine (my_parts): ZeroDivisionError" in sentence


def test_commands_take_plugins(tmp_path, monkeypatch):
    """`list` tells the keys of a component from outside, `plot` draws a figure from outside."""
    monkeypatch.setattr(plots, "_added", {})  # other tests have no such figure
    told = CliRunner().invoke(main, ["list", "tape_spring", "--plugin", str(TAPE)])
    assert "settling_stiffness" in told.output
    views = tmp_path / "views.py"
    views.write_text(
        "import orchestrator as fanfold\nfrom matplotlib.figure import Figure\n\n\n"
        '@fanfold.figure("nothing_but_axes")\ndef draw(result):\n    """Axes."""\n'
        "    figure = Figure()\n    figure.subplots()\n    return figure\n"
    )
    others = tuple(
        name for name in synthetic_result.signals()[1] if name != "damper"
    )  # one figure of its own
    path = synthetic_result.write(tmp_path / "a.h5", leave_out=others)
    drawn = CliRunner().invoke(main, ["plot", str(path), "--plugin", str(views)])
    assert drawn.exit_code == 0, drawn.output
    assert (tmp_path / "a" / "nothing_but_axes.png").is_file()


def test_a_component_from_outside_is_exported_as_a_python_fmu(tmp_path):
    """In a native installation as well: the rest is native, this one is a PythonFMU without a problem."""
    load_plugin(TAPE)
    from fmus import build_fmu

    path = build_fmu(REGISTRY["tape_spring"](wrench_mode="endpoint"), "tape", tmp_path)
    assert check_fmu(path) == []
    with pytest.raises(fanfold.FanfoldError, match=r"tape_spring .*kernel"):
        build_fmu(REGISTRY["tape_spring"](), "tape", tmp_path, backend="native")
