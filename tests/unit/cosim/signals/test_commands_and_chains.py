"""Outputs of FMUs that command and trigger events, FMUs that read FMUs, and when their outputs are recorded."""

from pathlib import Path

import numpy as np
import pytest
from pythonfmu.builder import FmuBuilder

import orchestrator as fanfold

STEP = 0.05
_SLAVE = """
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Real


class {name}(Fmi2Slave):
    def __init__(self, **keys):
        super().__init__(**keys)
        self.value = self.now = self.heard = 0.0
        self.go = False
        self.register_variable(Real("value", causality=Fmi2Causality.input))
        for name in ("now", "heard"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        self.register_variable(Boolean("go", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        self.now = current_time + step_size
        self.heard = self.value
        self.go = self.value > 0.3
        return True
"""

pytestmark = pytest.mark.filterwarnings("ignore:fmu.*W-fmu-unit")


@pytest.fixture(scope="module")
def sensor(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmu")
    source = folder / "sensor.py"
    source.write_text(_SLAVE.format(name="Sensor"), encoding="utf-8")
    return Path(FmuBuilder.build_FMU(str(source), dest=str(folder)))


def panel(until=2.0):
    """A panel that a constant torque opens from rest: M / 2J t2 = 0.5 t2."""
    scene = fanfold.Scene("panel", until=until)
    scene.base("ground", points={"left": (0, -0.5, 0), "right": (0, 0.5, 0)})
    points = {"left": (0, -0.5, 0), "right": (0, 0.5, 0)}
    scene.body(
        "panel", rigid={"mass": 2.0, "center_of_mass": (0.0, 0, 0), "inertia": (1, 1, 1), "points": points}
    )
    scene.hinge_line(
        "HL", "ground", "panel", axis="+y", aligned_angle="180 deg", motor={"stowed": "1 N.m", "deployed": "1 N.m"},
        latch={"stiffness": 3000.0, "effective_inertia": 1.0},
        hinges={"a": ("left", "left"), "b": ("right", "right")},
    )  # fmt: skip
    return scene


def happened(run):
    return {name: time for time, name, _ in run.events}


def test_an_output_that_becomes_true_latches_its_line_and_fails_a_hinge(sensor):
    """Closed form: the angle 0.5 t2 passes 0.3 rad at 0.7746 s, which the FMU sees at 0.8 s, at 0.32 rad."""
    scene = panel(1.0)
    scene.fmu(
        "sequencer", sensor, step=STEP, inputs={"value": "HL.angle"},
        outputs={"go": ["HL.latch_command", "b.failure_command"]},
    )  # fmt: skip
    run = fanfold.simulate(scene, estimate=False)
    assert happened(run)["sequencer.go"] == pytest.approx(0.8, abs=1e-9)
    assert run.latch_times["HL"] == pytest.approx(0.8, abs=1e-9)
    assert run["a", "angle"].at(0.8, "before") == pytest.approx(0.32, rel=1e-6)
    assert np.abs(run["b", "hinge_force"][run.time > 0.81]).max() == 0.0


def test_an_event_watches_an_output_that_is_not_listed(sensor):
    """The clock says 0.25 s at 0.25 s, which is not beyond it, and passes it at its next point."""
    scene = panel(0.4)
    scene.fmu("clock", sensor, step=0.125, inputs={"value": "HL.angle"}, outputs={"go": []})
    when = {"component": "clock", "variable": "now", "above": 0.25}
    scene.event("fails", when=when, set={"HL": {"motor_constant_torque": 0.0}})
    run = fanfold.simulate(scene, estimate=False)
    assert happened(run)["fails"] == pytest.approx(0.375, abs=1e-9)


def test_fmus_read_fmus_in_order_and_loops_are_a_step_late(sensor):
    """Definition: a chain written backwards has no delay; of a loop the first reads the step before, and warns."""
    scene = panel(0.3)
    scene.fmu("second", sensor, step=STEP, inputs={"value": "first.now"}, outputs={"heard": []})
    scene.fmu("first", sensor, step=STEP, inputs={"value": "HL.angle"}, outputs={"now": []})
    run = fanfold.simulate(scene, estimate=False)
    times = np.arange(1, 7) * STEP
    assert run["second", "heard"].at(times) == pytest.approx(times, abs=1e-12)
    assert any("first, second" in note and "N-fmu-order" in note for note in run.notes)
    loop = panel(0.3)
    loop.fmu("one", sensor, step=STEP, inputs={"value": "two.now"}, outputs={"heard": []})
    loop.fmu("two", sensor, step=STEP, inputs={"value": "one.heard"}, outputs={"heard": []})
    with pytest.warns(fanfold.FanfoldWarning, match=r"fmu.one.inputs.value: .*two.now.* \[W-fmu-delay\]"):
        run = fanfold.simulate(loop, estimate=False)
    assert run["one", "heard"].at(times) == pytest.approx(times - STEP, abs=1e-12)
    assert run["two", "heard"].at(times) == pytest.approx(times - STEP, abs=1e-12)


def test_outputs_are_recorded_at_their_own_time_up_to_the_end(sensor):
    """Definition: at a communication point the old value, then the new one, which is held; the end has its own."""
    scene = panel(0.3)
    scene.fmu("clock", sensor, step=0.1, inputs={"value": "HL.angle"}, outputs={"now": [], "heard": []})
    now = fanfold.simulate(scene, estimate=False)["clock", "now"]
    assert now.at([0.1, 0.2, 0.3]) == pytest.approx([0.1, 0.2, 0.3], abs=1e-12)
    assert now.at([0.1, 0.2, 0.3], "before") == pytest.approx([0.0, 0.1, 0.2], abs=1e-12)
    assert now.at([0.11, 0.15, 0.199]) == pytest.approx([0.1] * 3, abs=1e-12)


def test_a_line_whose_only_late_rows_are_those_of_one_instant_is_not_stuck(sensor):
    """Closed form: at the end it turns at 0.1 s of 1 rad/s2; the last rows are those before and after the output."""
    scene = panel(0.1)
    scene.fmu("clock", sensor, step=0.1, inputs={"value": "HL.angle"}, outputs={"now": []})
    run = fanfold.simulate(scene, estimate=False)
    assert np.count_nonzero(run.time >= 0.9 * run.time[-1]) == 2
    assert f"turns at {np.degrees(0.1):.3g} deg/s" in run.headline.verdict


WRONG = {
    "nobody gives it": ({"inputs": {"value": "sensr.now"}}, "inputs.value: .*sensor"),
    "no output": ({"inputs": {"value": "sensor.value"}}, "inputs.value: .*output"),
    "no latch there": (
        {"inputs": {"value": "HL.angle"}, "outputs": {"go": "panel.latch_command"}},
        "outputs.go: ",
    ),
    "a misspelt command": (
        {"inputs": {"value": "HL.angle"}, "outputs": {"go": "HL.latch_comand"}},
        "outputs.go: .*did you mean latch_command",
    ),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_cannot_be_joined(sensor, kind):
    keys, sentence = WRONG[kind]
    scene = panel()
    scene.fmu("sensor", sensor, step=STEP, **keys)
    with pytest.raises(fanfold.FanfoldError, match=rf"fmu.sensor.{sentence}"):
        fanfold.simulate(scene)


def test_conditions_on_fmus_are_checked(sensor):
    """One on an output that is not there, one that holds from the start, and those that no Boolean passes."""
    for variable, above, sentence in (
        ("later", 1.0, "when.variable: .*now"),
        ("now", -1.0, "from the start"),
        ("go", 1.0, "when.above: is 1.0; .*0.5"),
        ("go", True, "when.above: is True; .*0.5"),
    ):
        scene = panel()
        scene.fmu("clock", sensor, step=STEP, inputs={"value": "HL.angle"})
        when = {"component": "clock", "variable": variable, "above": above}
        scene.event("fails", when=when, set={"HL": {"latch_command": 1}})
        with pytest.raises(fanfold.FanfoldError, match=rf"event.fails.*{sentence}"):
            fanfold.simulate(scene, estimate=False)
