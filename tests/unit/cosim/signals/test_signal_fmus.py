"""FMUs of other tools in a scene: sampled control against its recurrence, units, FMI 3.0, and what fails, by name."""

import re
import zipfile

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import orchestrator as fanfold
from components import REGISTRY
from components.drive import MotionLaw
from fmus import build_fmu
from orchestrator.assembly import SignalFmu
from orchestrator.cosim.participant import ParticipantError
from orchestrator.cosim.signals.process import SignalProcess
from orchestrator.validity.before_run import scene_warnings
from tests.references.native_fmus import needs_native
from tests.unit.cosim.signals.signal_cases import INERTIA, STEP, controlled, slave, spacecraft

pytestmark = pytest.mark.filterwarnings("ignore:fmu.controller.*W-fmu-unit")


@pytest.fixture(scope="module")
def controller(tmp_path_factory):
    return slave(tmp_path_factory.mktemp("fmu"))


def sampled(until, gain=10.0, damping=40.0):
    """Angle and rate (rad, rad/s) at the end: the same recurrence, one axis, by SciPy between samples."""
    push = MotionLaw(True, 0.0, 1.0, 0.0, 0.5)
    state, torque = [0.0, 0.0], 0.0
    for k in range(round(until / STEP)):
        span = (k * STEP, (k + 1) * STEP)
        state = solve_ivp(
            lambda t, y, held=torque: [y[1], (held + push.angle(t)) / INERTIA],
            span,
            state,
            rtol=1e-12,
            atol=1e-15,
        ).y[:, -1]
        torque = -(gain * state[0] + damping * state[1])
    return state


def test_sampled_control_follows_its_recurrence(controller):
    """Independent path: held torques and SciPy between samples; the quaternion's angle is the integral of the rate."""
    run = fanfold.simulate(controlled(controller), tolerance=1e-6, estimate=False)
    angle, rate = sampled(1.0)
    assert run["craft", "attitude"][-1, 1] == pytest.approx(angle, rel=1e-8)
    assert run["craft", "attitude_rate"][-1, 1] == pytest.approx(rate, rel=1e-8)
    assert run.headline.energy_residual < 1e-8


def test_signals_are_recorded_as_they_are_held(controller):
    """Definition: rows after a sample hold what was given and taken there; loads jump in two rows at one instant."""
    run = fanfold.simulate(controlled(controller), tolerance=1e-4, estimate=False)
    time, angle = np.asarray(run.time), run["controller", "angle"][:]
    after = np.searchsorted(time, np.arange(1, 20) * STEP + 1e-7)
    assert angle[after] == pytest.approx(run["craft", "attitude"][after, 1], rel=1e-5)  # 1e-7 s later
    held = run["wheel", "applied_torque"][:]
    assert held[after + 1] == pytest.approx(run["controller", "torque"][after + 1], rel=1e-12)
    assert np.ptp(held[after[3] + 1 : after[4] - 1]) == 0.0
    assert run["controller", "torque"].unit == "N.m"
    # peaks are those of rows: no cubic is laid across a jump
    assert run.headline.interface_torque_peaks[1] == pytest.approx(
        np.max(run["craft", "interface_torque"][:, 1]), rel=1e-3
    )


def test_an_explicit_master_takes_signals_as_well(controller):
    """The same recurrence, to the first order of its step."""
    run = fanfold.simulate(controlled(controller), master="gauss-seidel", step=1e-3, estimate=False)
    assert run["craft", "attitude"][-1, 1] == pytest.approx(sampled(1.0)[0], rel=1e-2)


def test_parameters_are_set(controller):
    """Definition: other gains give the recurrence of these; one that is off gives nothing."""
    other = controlled(
        controller, parameters={"gain": 4.0, "damping": 9, "mode": 2, "label": "sun", "on": True}
    )
    run = fanfold.simulate(other, tolerance=1e-6, estimate=False)
    assert run["craft", "attitude"][-1, 1] == pytest.approx(sampled(1.0, 4.0, 9.0)[0], rel=1e-8)
    off = fanfold.simulate(controlled(controller, parameters={"on": False}), estimate=False)
    assert np.all(off["wheel", "applied_torque"][:] == 0.0)


def test_whole_numbers_and_truth_values_are_signals(controller):
    """Definition: 20 steps up to the end, and an angle beyond 0.01 rad; both without unit, one sets a torque."""
    joined = {"count": "wheel.added_torque", "is_large": "thruster.added_force"}
    run = fanfold.simulate(controlled(controller, outputs=joined), estimate=False)
    assert run["wheel", "applied_torque"][-1] == 20.0
    assert set(np.unique(run["thruster", "applied_force"][:])) == {0.0, 1.0}


@needs_native
@pytest.mark.filterwarnings("ignore:connection.wheel.*W-idle-load")  # the FMU turns another one
def test_fmi_3_and_units(tmp_path):
    """Closed form: the profile of an FMI 3.0 FMU at its communication points; degrees that it is given in radians."""
    structure = {"profile": "step5"}
    start = {"end_angle": 0.5, "duration": 0.8}
    file = build_fmu(REGISTRY["drive"](**structure), "generator", tmp_path, start, None, "3.0")
    scene = spacecraft()
    rotor = {"mass": 1.0, "center_of_mass": (0, 0, 0), "inertia": (1, 1, 1), "points": {"root": (0, 0, 0)}}
    body = scene.body("rotor", rigid=rotor)
    scene.hinge_line(
        "HL", "craft", body, axis="+y", aligned_angle="90 deg", hinges={"pin": ("wheel", "root")}
    )
    ports = {"inboard": {"body": "craft", "point": "wheel"}, "outboard": {"body": body, "point": "root"}}
    scene.connection(
        "drive",
        "drive",
        ports=ports,
        structure={"profile": "commanded"},
        parameters={"aligned_angle": "90 deg", "duration": 0.02},
    )
    scene.fmu("generator", file, step=STEP, outputs={"commanded_angle": ["drive.end_angle"]})
    run = fanfold.simulate(scene, estimate=False)
    law = MotionLaw(True, 0.0, 0.5, 0.0, 0.8)
    rows = np.searchsorted(run.time, np.arange(1, 20) * STEP + 1e-7)
    expected = [law.angle(k * STEP) for k in range(1, 20)]
    assert run["generator", "commanded_angle"][rows] == pytest.approx(expected, abs=1e-12)
    assert run["drive", "commanded_angle"][-1] == pytest.approx(0.5, abs=1e-5)


WRONG = {
    "no such input": (
        {"inputs": {"angel": "craft.attitude[2]"}},
        "inputs.angel: .*angle",
    ),
    "an output": ({"inputs": {"torque": "craft.attitude[2]"}}, "inputs.torque: .*input"),
    "no such component": (
        {"inputs": {"angle": "graft.attitude[2]"}},
        "inputs.angle: .*craft",
    ),
    "no such variable": ({"inputs": {"angle": "craft.altitude"}}, "inputs.angle: 'altitude' .*attitude"),
    "which of three": (
        {"inputs": {"angle": "craft.attitude"}},
        r"inputs.angle: .*3 components; write attitude\[1\]",
    ),
    "no variable": ({"inputs": {"angle": "craft"}}, "inputs.angle: .*component.variable"),
    "not tunable": (
        {"outputs": {"torque": "wheel.order"}},
        "outputs.torque: .*added_force, added_torque",
    ),
    "no parameter": ({"outputs": {"torque": "wheel.applied_torque"}}, "outputs.torque: "),
    "text": ({"outputs": {"said": "wheel.added_torque"}}, "outputs.said: is a String"),
    "no such parameter": ({"parameters": {"gian": 1.0}}, "parameters.gian: .*gain"),
    "text for a number": (
        {"parameters": {"gain": "much"}},
        "parameters.gain: .*'much'",
    ),
    "no number": (
        {"parameters": {"gain": float("nan")}},
        "parameters.gain: .*nan",
    ),
    "part of a whole": ({"parameters": {"mode": 1.5}}, "parameters.mode: .*1.5"),
    "number for a switch": ({"parameters": {"on": 1}}, "parameters.on: .*1"),
    "no step": ({"step": None}, "step: is missing"),
}


def test_a_parameter_has_one_setter(controller):
    """Regression: of two outputs on one parameter the last of the file won, without a word."""
    scene = controlled(controller)
    joined = {"inputs": {"angle": "craft.attitude[2]"}, "outputs": {"torque": "wheel.added_torque"}}
    scene.fmu("second", controller, step=STEP, **joined)
    with pytest.raises(fanfold.FanfoldError, match=r"second.outputs.torque: wheel.added_torque"):
        fanfold.simulate(scene)


@pytest.mark.parametrize("kind", WRONG)
def test_what_cannot_be_joined_is_told_before_the_run(controller, kind):
    keys, sentence = WRONG[kind]
    scene = spacecraft()
    given = {"step": STEP, "inputs": {"angle": "craft.attitude[2]"}} | keys
    scene.fmu("controller", controller, **{key: value for key, value in given.items() if value is not None})
    with pytest.raises(fanfold.FanfoldError, match=rf"fmu.controller.{sentence}"):
        fanfold.simulate(scene)
    assert any(re.search(sentence, problem) for problem in fanfold.check_scene(scene).problems)


def test_an_fmu_of_another_platform_is_refused_before_the_run(controller, tmp_path):
    """Regression: `check` saw nothing, and a run told of a temporary folder."""
    foreign = tmp_path / "Foreign.fmu"
    with zipfile.ZipFile(controller) as old, zipfile.ZipFile(foreign, "w") as new:
        for name in old.namelist():
            if not name.startswith("binaries/") or "win64" in name:
                new.writestr(name, old.read(name))
    scene = spacecraft()
    scene.fmu("controller", foreign, step=STEP, inputs={"angle": "craft.attitude[2]"})
    (problem,) = fanfold.check_scene(scene).problems
    assert re.search(r"\w+, only for win64", problem)


def test_files_that_are_no_such_fmus(tmp_path):
    """A file that is not there, one that is no FMU, nothing that joins it, and a key of former versions."""
    scene, text = spacecraft(), tmp_path / "text.fmu"
    text.write_text("no archive", encoding="utf-8")
    inputs = {"angle": "craft.attitude[2]"}
    with pytest.raises(fanfold.FanfoldError, match=r"gone.fmu"):
        scene.fmu("controller", tmp_path / "gone.fmu", step=STEP, inputs=inputs)
    with pytest.raises(fanfold.FanfoldError, match="joins"):
        scene.fmu("controller", text, step=STEP)
    with pytest.raises(fanfold.FanfoldError, match=r"fmu\.controller\.iterated: .*remove"):
        scene.fmu("controller", text, step=STEP, inputs=inputs, iterated=True)
    scene.fmu("controller", text, step=STEP, inputs=inputs)
    with pytest.raises(fanfold.FanfoldError, match=r"fmu.controller.file: "):
        fanfold.simulate(scene)


FAULTS = {
    "raise ValueError('the gyroscope is blind')": "ValueError('the gyroscope is blind')",
    "os.abort()": "SIGABRT",
    "os._exit(3)": "exit code 3",
    "self.torque = float('nan')": "its output torque is nan",
}


@pytest.mark.parametrize("fault", FAULTS)
def test_an_fmu_that_fails_is_named_and_rows_are_kept(tmp_path, fault):
    """Which FMU, when, what: the third step begins at 0.1 s and ends at 0.15 s."""
    broken = slave(tmp_path, fault=f"if self.count == 3: {fault}")
    path = tmp_path / "run.h5"
    with pytest.raises(fanfold.FanfoldError, match=r"controller.* 0\.15? s") as caught:
        fanfold.simulate(controlled(broken), save=path, estimate=False)
    assert FAULTS[fault] in str(caught.value)
    assert 0.1 < fanfold.Result.open(path).time[-1] < 0.15 + 1e-9


def test_good_news_is_no_reason_of_a_failure(tmp_path):
    """Message. Regression: what was said last stood for why, also where all was well then."""
    file = slave(tmp_path, fault="self.log('all is well'); return self.count < 3")
    with pytest.raises(fanfold.FanfoldError, match=r"step of 0\.05 s .* 0\.1 s: .*\bend\b"):
        fanfold.simulate(controlled(file), estimate=False)


def test_an_fmu_may_ask_for_the_end(tmp_path):
    """FMI 2.0, 4.2.1: a step is discarded and fmi2Terminated is true, which PythonFMU answers of do_step's False."""
    file = slave(tmp_path, fault="return self.count < 3")
    with SignalProcess(SignalFmu("controller", file, STEP, {}, (), ()), 1e-4, 1.0) as one:
        one.open([])
        one.sample(0.0, STEP, [])
        one.sample(STEP, STEP, [])
        with pytest.raises(ParticipantError, match=r"0\.1 s: .*\bend\b"):
            one.sample(2.0 * STEP, STEP, [])


def test_what_an_fmu_warns_of_is_told_once(tmp_path):
    """Message of every step from the third on. Regression: FMUs were not logged, and warnings went nowhere."""
    file = slave(tmp_path, fault="if self.count > 2: self.log('near its limit', Fmi2Status.warning)")
    with pytest.warns(fanfold.FanfoldWarning) as heard:
        fanfold.simulate(controlled(file), estimate=False)
    told = [str(one.message) for one in heard if "warned" in str(one.message)]
    assert told == ["craft: controller: at t = 0.15 s it warned: near its limit [W-fmu]"]


def test_an_fmu_that_hangs_is_ended(tmp_path):
    """A call that does not come to its end in the time that it is given."""
    file = slave(tmp_path, fault="time.sleep(60)")
    with SignalProcess(SignalFmu("controller", file, STEP, {}, (), ()), 1e-4, 1.0, longest_call=3.0) as one:
        one.open([])
        with pytest.raises(ParticipantError, match=r"controller: .* 0\.05 s .* 3 s"):
            one.sample(0.0, STEP, [])


def test_a_step_that_the_run_does_not_reach_is_told(controller):
    (sentence,) = scene_warnings(controlled(controller, until=1.0, step=2.0).check_one_run())
    assert sentence.startswith("fmu.controller.step: ")
    assert scene_warnings(controlled(controller, until=1.0, step=1.0).check_one_run()) == []


def test_a_step_that_is_made_millions_of_times_is_told(controller):
    """Regression: a step of 1 us was started without a word, and would have taken an hour."""
    for step, count in (("0.1 us", 1), ("1 ms", 0)):
        found = fanfold.check_scene(controlled(controller, until=1.0, step=step))
        assert len([one for one in found.warnings if "W-fmu-step" in one]) == count


def test_checkpoints_are_refused(controller, tmp_path):
    with pytest.raises(fanfold.FanfoldError, match="checkpoints"):
        fanfold.simulate(controlled(controller), save=tmp_path / "run.h5", checkpoint=0.2)


def test_the_scene_is_written_and_read_back(controller, tmp_path):
    """Round trip: the file of the FMU is found from wherever the scene is read."""
    scene = controlled(controller)
    (tmp_path / "craft.toml").write_text(scene.to_toml(), encoding="utf-8")
    again = fanfold.simulate(tmp_path / "craft.toml", estimate=False)
    assert (
        again["craft", "attitude"][-1, 1]
        == fanfold.simulate(scene, estimate=False)["craft", "attitude"][-1, 1]
    )
