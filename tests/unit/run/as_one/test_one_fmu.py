"""A scene as one FMU against the run of the scene: deployment at any communication step, states, commands, events."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest

import orchestrator as fanfold
from fmus import check_fmu, native_library
from tests.unit.run.as_one.host import STACK, TWO_PANELS, Host, latching

pytestmark = [
    pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native"),
    pytest.mark.filterwarnings("ignore:.*W-no-end"),  # nothing stops it
]
SAME = 1e-9
"""Of numbers that both masters come to by the same steps, whose iterations end at 1e-6 of the tolerance."""


def exported(scene, folder, **options):
    (path,) = fanfold.export(scene, folder, as_one=True, **options)
    return path


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return exported(latching(), tmp_path_factory.mktemp("latching"))


@pytest.fixture(scope="module")
def result():
    return fanfold.simulate(latching(), estimate=False)


def test_it_latches_when_the_scene_does_and_as_hard(path, result):
    host = Host(path).start().to(2.0, 0.013)
    assert host["HL.latch_time"] == pytest.approx(result.latch_times["HL"], rel=SAME)
    peak = result.headline.latch_torque_peaks["HL"]
    assert host["HL.latch_torque_peak"] == pytest.approx(peak, rel=1e-5)
    assert host["HL.latched"] == 1.0
    assert host["steps"] == pytest.approx(result.costs["steps"], abs=3)


def test_outputs_depend_on_no_input_of_the_same_instant(tmp_path):
    """FMI 2.0.4, 2.2.8. Regression: all inputs were listed, an algebraic loop with a spacecraft that answers loads."""
    host = Host(exported(latching(), tmp_path, driven_base=True)).start().to(0.5, 0.05)
    assert all(unknown.dependencies == [] for unknown in host.description.outputs)
    before = host.all()
    for variable in host.description.modelVariables:
        if variable.causality == "input":
            host[variable.name] = 1.0
    np.testing.assert_array_equal(host.all(), before)


def test_no_value_is_above_its_peak_so_far(path, result):
    """Definition, at points between rows of the rising torque. Regression: up to 5 % above it."""
    host = Host(path).start()
    for time in result.latch_times["HL"] + np.arange(0.0, 0.1, 0.0013):
        host.to(time, 0.1)
        assert host["HL.latch_torque_peak"] >= abs(host["root.latch_torque"])


def test_what_is_observed_lies_between_the_rows_of_the_run(path, result):
    """The angle turns smoothly: rows are so near to each other that a straight line is off by 1e-4 of it."""
    host = Host(path).start()
    for time in (0.3, 0.77, 1.4):
        expected = np.interp(time, result.time, result.signal("root", "angle"))
        assert host.to(time, 0.01)["root.angle"] == pytest.approx(expected, rel=1e-3)


def test_communication_steps_change_no_bit(path):
    hosts = [Host(path).start() for _ in range(3)]
    for time in (0.5, 1.2, 2.0):
        found = [host.to(time, step).all() for host, step in zip(hosts, (1e-3, 0.02, 0.5), strict=True)]
        # communication points are sums of step sizes, which round
        np.testing.assert_allclose(found[1], found[0], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(found[2], found[0], rtol=1e-9, atol=1e-9)
        assert found[0][hosts[0].outputs.index("HL.latch_time") - 2] == hosts[2]["HL.latch_time"]


@pytest.mark.parametrize("way", ["restored", "serialised"])
def test_a_state_leads_to_the_same_bits_across_latch_up(path, way):
    """Saved just before latch-up: who goes on, who comes back, and who reads the bytes in another instance."""
    going_on = Host(path).start()
    before = Host(path).start().to(2.0, 0.01)["HL.latch_time"] - 0.004
    going_on.to(before, 0.01)
    state = going_on.fmu.getFMUstate()
    data = going_on.fmu.serializeFMUstate(state)
    going_on.to(2.0, 0.003)
    assert going_on["HL.latched"] == 1.0
    expected = going_on.all()
    other = going_on if way == "restored" else Host(path).start()
    other.fmu.setFMUstate(state if way == "restored" else other.fmu.deSerializeFMUstate(data))
    other.time = before
    assert other["HL.latched"] == 0.0
    np.testing.assert_array_equal(other.to(2.0, 0.003).all(), expected)


def test_a_parameter_that_changes_acts_at_the_communication_point(path):
    """As the event of a scene that sets it at that time; the master was ahead, and went back."""
    event = {"name": "faster", "time": "0.3 s", "set": {"root": {"motor_constant_torque": "4 N.m"}}}
    expected = fanfold.simulate(latching([event]), estimate=False).latch_times["HL"]
    host = Host(path).start().to(0.3, 0.01)
    host["root.motor_constant_torque"] = 4.0
    assert host.to(2.0, 0.01)["HL.latch_time"] == pytest.approx(expected, rel=1e-6)


def test_a_latch_is_commanded(path):
    """At once, long before its angle is reached; then nothing moves on."""
    host = Host(path).start().to(0.3, 0.01)
    host["HL.latch_command"] = 1.0
    host.to(0.31, 0.01)
    assert host["HL.latch_time"] == pytest.approx(0.3, abs=1e-9)
    angle = host["root.angle"]
    assert host.to(1.0, 0.01)["root.angle"] == pytest.approx(angle, abs=0.05)


def test_a_command_that_is_given_from_the_start_acts_there(path):
    """Inputs may be set before initialization: the latch engages at the first communication point."""
    host = Host(path).start(**{"HL.latch_command": 1.0}).to(0.5, 0.1)
    assert host["HL.latched"] == 1.0
    assert host["HL.latch_time"] == pytest.approx(0.0, abs=1e-9)
    assert abs(host["root.angle"] - np.radians(60.0)) < 2e-3


def test_a_release_is_commanded(tmp_path):
    """A bolt that lets go by command lets go as by the scene's own event."""
    host = Host(exported(STACK, tmp_path, rigid="all"))
    names = [name for name in host.references if name.endswith("release_command")]
    assert names == ["wall_bolt.release_command", "panel_bolt.release_command"]


def test_flags_are_0_or_1_between_rows(tmp_path):
    """They are those of the row before: contact that opens and closes, and a bolt that lets go at its time."""
    host = Host(exported(STACK, tmp_path, rigid="all")).start()
    flags = [name for name in host.references if name.endswith((".in_contact", ".released"))]
    seen = {name: set() for name in flags}
    while host.time < 0.6:
        host.to(host.time + 0.0003, 0.0003)
        for name in flags:
            seen[name].add(host[name])
    assert set().union(*seen.values()) == {0.0, 1.0}
    assert seen["wall_bolt.released"] == seen["wall_left.in_contact"] == {0.0, 1.0}


def test_the_tolerance_is_a_parameter_and_the_experiments(path, tmp_path):
    """Every bit of a scene with that tolerance; what was set before goes before what the host gives."""
    expected = Host(exported(latching(tolerance=1e-6), tmp_path)).start().to(2.0, 0.01).all()
    assert np.array_equal(Host(path).start(tolerance=1e-6).to(2.0, 0.01).all(), expected)
    assert np.array_equal(Host(path).start(1e-6).to(2.0, 0.01).all(), expected)
    assert np.array_equal(Host(path).start(1e-2, tolerance=1e-6).to(2.0, 0.01).all(), expected)
    assert float(fmpy.read_model_description(str(path)).defaultExperiment.tolerance) == 1e-4


def test_an_experiment_with_a_senseless_tolerance_is_told_so(path):
    """A warning with both bounds; it runs as it would without."""
    host, usual = Host(path), Host(path).start().to(0.5, 0.1).all()
    assert np.array_equal(host.start(7.0).to(0.5, 0.1).all(), usual)
    assert all(number in host.said[-1] for number in ("1e-10", "0.1", "0.0001"))


def test_a_tolerance_of_zero_is_none(path):
    """OMSimulator gives 0 where its annotation has none, and takes a warning as failure."""
    host, usual = Host(path), Host(path).start().to(0.5, 0.1).all()
    assert np.array_equal(host.start(0.0).to(0.5, 0.1).all(), usual)
    assert host.said == []


@pytest.mark.parametrize("step", [1e30, 1e6])
def test_a_step_that_nobody_could_wait_for_is_refused(path, step):
    """FMI 2.0, 4.2.1: discarded, as smaller steps may do; nothing is lost. Regression: it never came back."""
    host = Host(path).start().to(0.5, 0.1)
    with pytest.raises(fmpy.fmi1.FMICallException) as caught:
        host.fmu.doStep(0.5, step)
    assert caught.value.status == 2
    assert "communication steps" in host.said[-1]
    assert np.array_equal(host.to(0.8, 0.1).all(), Host(path).start().to(0.8, 0.1).all())


def test_a_step_has_to_move_time(path):
    """In floats 1e30 s and a second are 1e30 s."""
    host = Host(path)
    host.fmu.setupExperiment(startTime=1e30)
    host.fmu.enterInitializationMode()
    host.fmu.exitInitializationMode()
    with pytest.raises(fmpy.fmi1.FMICallException):
        host.fmu.doStep(1e30, 1.0)
    assert "rounding" in host.said[-1]


def test_a_step_begins_where_the_last_one_ended(path):
    """Another communication point is refused, and nothing is lost."""
    host = Host(path).start().to(0.5, 0.1)
    for time in (0.4, 0.6):
        with pytest.raises(fmpy.fmi1.FMICallException):
            host.fmu.doStep(time, 0.1)
        assert "0.5 s" in host.said[-1]
    assert np.array_equal(host.to(0.8, 0.1).all(), Host(path).start().to(0.8, 0.1).all())


def test_parameters_before_the_start(path):
    """A constant motor torque that is half as large again opens in the root of 2/3 of the time: nothing else works."""
    usual = Host(path).start().to(2.0, 0.01)["HL.latch_time"]
    fast = Host(path).start(**{"root.motor_constant_torque": 12.0}).to(2.0, 0.01)["HL.latch_time"]
    assert fast == pytest.approx(usual * (2.0 / 3.0) ** 0.5, rel=1e-4)


def test_what_is_the_masters_is_its_own(path):
    """Regression: components of another order or scheme than the master's gave wrong torques, without a word."""
    host = Host(path)
    with pytest.raises(fmpy.fmi1.FMICallException):
        host.start(**{"root.order": 2.0})


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_other_tools_find_nothing_wrong(fmi, tmp_path):
    """The checker of the project, and FMPy's plain command."""
    found = exported(TWO_PANELS, tmp_path, fmi=fmi)
    assert not list(check_fmu(found))
    rows = fmpy.simulate_fmu(str(found), stop_time=0.5, output_interval=0.1, output=["middle_left.angle"])
    expected = fanfold.simulate(TWO_PANELS, until=0.5, estimate=False).signal("middle_left", "angle")[-1]
    assert rows["middle_left.angle"][-1] == pytest.approx(expected, rel=1e-6)


def test_what_cannot_be_one_fmu_is_told(tmp_path):
    with pytest.raises(fanfold.FanfoldError, match="back end"):
        fanfold.export(TWO_PANELS, tmp_path, as_one=True, backend="python")


def shaken(until, amplitude=0.02, frequency=1.5, duration=0.8, turn=0.5):
    """The two panels on a base that follows laws, and these laws as rates and accelerations."""
    motion = {
        "translation": [
            {"profile": "harmonic", "amplitude": amplitude, "frequency": frequency, "phase": np.pi / 2}
        ],
        "translation_axis": [1, 0, 0],
        "rotation": [{"profile": "step5", "duration": duration, "change": turn}],
        "rotation_axis": [0, 1, 0],
    }
    scene = fanfold.load(TWO_PANELS, settings={"base.motion": motion})
    w = 2.0 * np.pi * frequency

    def rates(t):
        s = min(t / duration, 1.0)
        yield "base.velocity[1]", -amplitude * w * np.sin(w * t)
        yield "base.acceleration[1]", -amplitude * w**2 * np.cos(w * t)
        yield "base.angular_velocity[2]", turn * (30 * s**2 - 60 * s**3 + 30 * s**4) / duration
        yield "base.angular_acceleration[2]", turn * (60 * s - 180 * s**2 + 120 * s**3) / duration**2

    return fanfold.simulate(scene, until=until, estimate=False), rates


def test_a_driven_base_takes_the_wing_along(tmp_path):
    """Against the scene whose base follows the same laws; the error goes with the square of the communication step."""
    result, rates = shaken(0.6)
    expected = result.signal("middle_left", "angle")[-1]
    path = exported(TWO_PANELS, tmp_path, driven_base=True)
    errors = []
    for step in (0.02, 0.01):
        host = Host(path).start()
        while host.time < 0.6 - 1e-9:
            for name, value in rates(host.time):
                host[name] = value
            host.to(host.time + step, step)
        errors.append(abs(host["middle_left.angle"] - expected))
        assert abs(host["energy_residual"]) < 2.0 * abs(result.headline.energy_residual)
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 3.0


def test_small_communication_steps_of_a_driven_base_are_one_step_each(tmp_path):
    """Under a smooth motion matrices, prediction and step size last: one step inside, but for the start."""
    _, rates = shaken(0.6)
    host = Host(exported(TWO_PANELS, tmp_path, driven_base=True)).start()
    for k in range(400):
        for name, value in rates(1e-3 * k):
            host[name] = value
        host.to(1e-3 * (k + 1), 1e-3)
    assert host["steps"] + host["rejected_steps"] < 1.3 * 400


def test_a_driven_base_meets_rates(tmp_path):
    """Definition: rates are those of a step's end, for hosts that iterate; a constant acceleration is met exactly.

    Independent path: the same motion by rates of the step's beginning and the acceleration, whose error goes with the
    square of the step.
    """
    path = exported(latching(), tmp_path, driven_base=True)

    def angle(step, meets):
        host = Host(path).start(base_meets_rates=float(meets))
        host["base.acceleration[3]"] = 0.0 if meets else 2.0
        for k in range(round(0.4 / step)):
            host["base.velocity[3]"] = 2.0 * step * (k + meets)
            host.to((k + 1) * step, step)
        return host["root.angle"]

    exact = angle(0.02, True)
    assert angle(0.01, True) == pytest.approx(exact, rel=1e-6)
    coarse, fine = (abs(angle(step, False) - exact) for step in (0.02, 0.01))
    assert coarse < 1e-3
    assert fine < coarse / 3.0


def test_a_driven_base_is_stable_over_steps_in_any_order(tmp_path):
    """Regression: corrections of short steps, as accelerations, grew without bound over long ones between them."""
    result, rates = shaken(0.6)
    expected = result.signal("middle_left", "angle")[-1]
    path = exported(TWO_PANELS, tmp_path, driven_base=True)
    for steps in ((0.001, 0.02), (0.001, 0.001, 0.002, 0.02)):
        host, k = Host(path).start(), 0
        while host.time < 0.6 - 1e-9:
            for name, value in rates(host.time):
                host[name] = value
            h = min(steps[k % len(steps)], 0.6 - host.time)
            host.to(host.time + h, h)
            k += 1
        assert host["middle_left.angle"] == pytest.approx(expected, abs=1e-3)


def test_what_a_wing_as_one_fmu_cannot_give_is_told(tmp_path):
    """Impulses of locks are no load of an instant; an equilibrium is that of the values at export."""
    locked = latching().with_settings({"hinge_line.HL.latch.kind": "kinematic"})
    with pytest.warns(fanfold.FanfoldWarning, match="W-export"):
        exported(locked, tmp_path, driven_base=True)
    described = fmpy.read_model_description(str(exported(latching(preload=True), tmp_path)))
    started = [v.description for v in described.modelVariables if ".initial_velocity" in v.name]
    assert started
    assert all("static equilibrium" in text for text in started)


def test_a_driven_base_that_rests_is_a_fixed_one(tmp_path):
    moving = Host(exported(TWO_PANELS, tmp_path / "driven", driven_base=True)).start().to(0.5, 0.1)
    fixed = Host(exported(TWO_PANELS, tmp_path / "fixed")).start().to(0.5, 0.1)
    assert moving["middle_left.angle"] == pytest.approx(fixed["middle_left.angle"], rel=1e-12)


def test_only_a_fixed_base_can_be_driven(tmp_path):
    with pytest.raises(fanfold.FanfoldError, match="only a fixed base"):
        fanfold.export("tests/scenes/two_panels_free.toml", tmp_path, as_one=True, driven_base=True)
    with pytest.raises(fanfold.FanfoldError, match="as_one"):
        fanfold.export(TWO_PANELS, tmp_path, driven_base=True)


def test_a_base_that_moves_at_the_start_is_refused(tmp_path):
    """The wing starts at rest: a rate would be led up within the first step, with loads that nobody asked for."""
    host = Host(exported(TWO_PANELS, tmp_path, driven_base=True))
    with pytest.raises(Exception, match="fmi2ExitInitializationMode"):
        host.start(**{"base.velocity[1]": 0.1})
