"""Runs from Python: the same numbers as from the terminal, in memory and in files; how results are read."""

from __future__ import annotations

import json
import sys
import warnings
from types import ModuleType, SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.api.progress import chosen, notebook_bar
from orchestrator.cli.main import main
from orchestrator.results.result import ResultError
from tests.references import synthetic_result
from tests.unit.scene.scene_cases import SCENES

pytestmark = pytest.mark.filterwarnings("ignore:.*W-no-end")  # nothing stops it

WING = SCENES / "two_panels.toml"


@pytest.fixture(scope="module")
def result():
    return fanfold.simulate(WING, until=0.2)


@pytest.fixture(scope="module")
def latched(tmp_path_factory):
    return fanfold.Result.open(synthetic_result.write(tmp_path_factory.mktemp("r") / "synthetic.h5"))


@pytest.mark.filterwarnings("ignore:two_panels.*W-")  # both tell it
def test_terminal_and_face_are_one(result, tmp_path):
    """Same numbers: the command line and `simulate` give the same headline, bit for bit."""
    arguments = ["run", str(WING), "--until", "0.2", "--output", str(tmp_path / "a.h5"), "--json"]
    told = json.loads(CliRunner().invoke(main, arguments).stdout)
    here = json.loads(json.dumps(result.headline.as_dict()))
    here["warnings"] = list(result.warnings)  # what the scene and the run told is among them
    assert {name: told[name] for name in here} == here
    assert told["steps"] == result.costs["steps"]
    np.testing.assert_array_equal(fanfold.Result.open(tmp_path / "a.h5").time, result.time)


def test_memory_and_file_are_one(result, tmp_path):
    """Nothing lost: a result in memory, saved and read, has every signal, event and text."""
    saved = result.save(tmp_path / "a.h5")
    assert result.path is None
    assert saved.path == tmp_path / "a.h5"
    again = fanfold.load(tmp_path / "a.h5")
    assert isinstance(again, fanfold.Result)
    with pytest.raises(fanfold.FanfoldError, match="settings"):
        fanfold.load(tmp_path / "a.h5", settings={"scene.until": 1.0})
    assert again.complete
    assert again.components == result.components
    for component in result.components:
        assert again.variables(component) == result.variables(component)
        for variable in result.variables(component):
            np.testing.assert_array_equal(
                again.signal(component, variable), result.signal(component, variable)
            )
            assert again.unit(component, variable) == result.unit(component, variable)
    assert (again.events, again.statistics) == (result.events, result.statistics)
    assert dict(again.provenance) == dict(result.provenance)
    assert again.headline == result.headline


def test_a_signal_is_an_array_with_unit_and_time(result):
    angle = result["root", "angle"]
    assert (angle.unit, angle.name, angle.shape) == ("rad", "root.angle", result.time.shape)
    assert angle.description
    np.testing.assert_array_equal(angle.time, result.time)
    assert isinstance(np.rad2deg(angle), np.ndarray)
    assert isinstance(2.0 * angle + angle, np.ndarray)
    assert np.max(angle) == angle[-1] == list(angle)[-1]
    (line,) = plt.plot(angle.time, angle)
    plt.close()
    np.testing.assert_array_equal(line.get_ydata(), result.signal("root", "angle"))


def test_wrong_signals_are_told(result):
    with pytest.raises(ResultError, match="'door'"):
        result["door", "angle"]
    with pytest.raises(ResultError, match="'colour'"):
        result["root", "colour"]
    with pytest.raises(ResultError, match="'root'"):
        result["root"]
    with pytest.raises(ResultError, match="'HL9'"):
        result.latch_torque("HL9")
    with pytest.raises(ResultError, match=r"'torques'.*deployment_angles"):
        result.plot("torques")
    with pytest.raises(ResultError, match="'damper_loads'"):
        result.plot("damper_loads")


def test_an_instant_is_read_before_or_after_what_happens_there(latched):
    """Closed form: the rate of a line at its latch angle; the latch torque is zero before, and k w/w at once after."""
    line = synthetic_result.LINES[0]
    before, after = (latched.at(line.latch_time, side) for side in ("before", "after"))
    assert before["hl1_left", "angular_rate"] == pytest.approx(line.latch_rate)
    doubled = np.flatnonzero(latched.time == line.latch_time)
    assert doubled.size == 2
    for variable in ("angle", "latch_torque", "angular_rate"):
        values = latched.signal("hl1_left", variable)[doubled]
        assert [before["hl1_left", variable], after["hl1_left", variable]] == list(values)
    assert after["hl1_left", "latch_torque"] != before["hl1_left", "latch_torque"] == 0.0


def test_times_and_tolerances_may_be_texts(latched):
    """As all quantities may."""
    assert latched.at("1000 ms").time == latched.at(1.0).time
    with pytest.raises(fanfold.FanfoldError, match="'soon'"):
        latched.at("soon")
    with pytest.raises(fanfold.FanfoldError, match="tolerance is 'tight'"):
        fanfold.simulate(WING, tolerance="tight")
    with pytest.raises(fanfold.FanfoldError, match="3 is no"):
        fanfold.simulate(WING, rigid=3)


def test_between_samples_values_are_on_the_line(latched):
    time, angle = latched.time, latched["hl2_left", "angle"]
    middle = 0.5 * (time[40] + time[41])
    assert latched.at(middle)["hl2_left", "angle"] == pytest.approx(0.5 * (angle[40] + angle[41]))
    position = latched.at(middle)["panel1", "frame_position"]
    np.testing.assert_allclose(
        position, latched.signal("panel1", "frame_position")[40:42].mean(axis=0), atol=1e-12
    )
    np.testing.assert_array_equal(angle.at([time[3], time[5]]), angle[[3, 5]])
    assert latched["panel1", "frame_position"].at([1.0, 2.0]).shape == (2, 3)
    assert latched.at(time[-1])["hl2_left", "angle"] == angle[-1]
    with pytest.raises(ResultError, match="99 s"):
        latched.at(99.0)
    with pytest.raises(ResultError, match="must be 'before' or 'after'"):
        latched.at(1.0, "left")


def test_latch_times_and_torque_of_a_line(latched):
    assert latched.latch_times == pytest.approx(
        {line.name: line.latch_time for line in synthetic_result.LINES}
    )
    whole = sum(latched.signal(f"hl1_{side}", "latch_torque") for side in synthetic_result.SHARES)
    np.testing.assert_allclose(latched.latch_torque("hl1"), whole)
    assert "the last (hl3) at 9.7 s" in repr(latched)


def test_figures_are_matplotlibs(tmp_path):
    """One, and all that there are of a result that has two."""
    others = tuple(name for name in synthetic_result.signals()[1] if not name.startswith("hl1"))
    hinges = fanfold.Result.open(synthetic_result.write(tmp_path / "run.h5", leave_out=others))
    figure = hinges.plot("latch_torques")
    assert "hinges of" in figure.get_suptitle()
    written = hinges.plot_all(tmp_path / "pictures")
    assert [path.stem for path in written] == ["deployment_angles", "latch_torques"]
    assert all(path.is_file() for path in written)


def test_a_data_frame_has_every_signal(latched, monkeypatch):
    class Frame(dict):
        def __init__(self, columns, index):
            super().__init__(columns)
            self.index = index

    pandas = ModuleType("pandas")
    pandas.DataFrame, pandas.Index = Frame, lambda values, name: SimpleNamespace(values=values, name=name)
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    frame = latched.to_dataframe(["hl1_left", "base"])
    assert frame.index.name == "time, s"
    np.testing.assert_array_equal(frame["hl1_left.angle"], latched.signal("hl1_left", "angle"))
    np.testing.assert_array_equal(
        frame["base.interface_force[3]"], latched.signal("base", "interface_force")[:, 2]
    )
    assert set(latched.to_dataframe("base")) == {name for name in frame if name.startswith("base.")}
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ResultError, match="pip install"):
        latched.to_dataframe()


@pytest.mark.filterwarnings("ignore:.*W-motor-short")  # the check before the run warns, too
def test_what_is_not_as_it_should_be_is_a_warning():
    """Here friction exceeds the motor's torque; the warning points at the line that ran the scene."""
    stuck = fanfold.load(WING).with_settings(
        {
            "hinge_line.root_line.friction_preload": 5.0,
            "hinge_line.root_line.latch": {"stiffness": 2000, "effective_inertia": 5},
            "hinge_line.middle_line.end_stop": {"stiffness": 2000},
        }
    )
    with pytest.warns(fanfold.FanfoldWarning, match=r"root_line .*0\.1 s .*W-not-opened") as told:
        found = fanfold.simulate(stuck, until=0.1, estimate=False)
    assert told[0].filename == __file__
    said = [str(one.message) for one in told]
    assert " 5 N.m" in said[0]  # of the scene, before the run
    assert list(found.warnings) == said


def test_an_interrupted_run_gives_what_it_has():
    """Nothing lost: Ctrl-C between two steps, as in a notebook."""

    def interrupting(name, end):
        class Bar:
            def __enter__(self):
                return self.watch

            def __exit__(self, *_):
                return None

            def watch(self, time, h):
                if time > 0.1:
                    raise KeyboardInterrupt

        return Bar()

    with pytest.raises(fanfold.FanfoldError, match="interrupted at t = ") as caught:
        fanfold.simulate(WING, until=6.0, progress=interrupting)
    kept = caught.value.result
    assert not kept.complete
    # blocks of steps are told of, none longer than all that were made before it
    assert 0.1 < kept.time[-1] < 6.0


def test_progress_in_a_notebook(monkeypatch):
    """A bar under the cell where the code runs in the kernel of a notebook, nothing elsewhere."""
    shown = []
    ipython, display = ModuleType("IPython"), ModuleType("IPython.display")
    shell = SimpleNamespace(kernel=object())
    ipython.get_ipython, ipython.display = (lambda: shell), display
    display.HTML = str
    display.display = lambda text, display_id: shown.append(text) or SimpleNamespace(update=shown.append)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    fanfold.simulate(WING, until=0.05, estimate=False)
    assert 'value="0"' in shown[0]
    assert 'value="0.05" max="0.05"' in shown[-1]
    assert "two_panels: t = 0.050 of 0.05 s" in shown[-1]
    assert chosen(None) is notebook_bar
    count = len(shown)
    fanfold.simulate(WING, until=0.05, estimate=False, progress=False)
    assert len(shown) == count
    shell.kernel = None
    assert chosen(None) is not notebook_bar


def test_verification_of_a_run(result):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rows = {row.number.quantity: row for row in result.verify()}
    assert rows["motor work"].error < 1e-2 * rows["motor work"].number.value
    with pytest.raises(fanfold.FanfoldError, match="verified"):
        fanfold.Result.of(result).verify()


def test_phases_are_scenes():
    runs = fanfold.load("arabsat").runs
    assert list(runs) == ["phase1", "phase2"]
    assert runs["phase1"].chosen == ("phase1",)
    assert list(runs["phase2"].runs) == [""]
    assert fanfold.load("amos3").runs == {"": fanfold.load("amos3")}
