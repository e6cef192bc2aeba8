"""Derivatives of headline numbers by keys: closed forms, runs of their own along the same steps, sentences."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.analysis.sampling.gradients import parameter
from orchestrator.analysis.sampling.neighbours import run_beside
from orchestrator.cli.main import main
from orchestrator.cosim.events import crossings
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.results.key_figures import headline
from orchestrator.run.simulation import Options
from orchestrator.views.gradients import plot_gradients
from tests.benchmark.gradients import MET, differences, followed
from tests.unit.analysis.sampling.flap import ANGLE, ENDS, MOTOR, STIFFNESS, flap, latch_time, undamped_peak
from tests.unit.analysis.sampling.flap import INERTIA as MOMENT
from tests.unit.run.as_one.host import latching

INERTIA = "body.flap.rigid.inertia*"
DAMPING = "hinge_line.line.latch.damping_ratio"
TWO_PANELS = "tests/scenes/two_panels.toml"


def of_steps(tolerance):
    """What is left of a derivative along steps whose errors are of a tolerance (an own one of 1e-6 errs by less)."""
    return 20.0 * tolerance


def test_a_latch_time_in_closed_form():
    """Closed form: t = sqrt(2 angle J / T), so dt/dT = -t / 2T, and half a percent for one of the inertia."""
    found = fanfold.gradients(flap(), [MOTOR, INERTIA], verify=False)
    assert found.of("latch_time.line", MOTOR) == pytest.approx(-0.5 * latch_time(), rel=of_steps(1e-6))
    relative = found.relative[found.names.index("latch_time.line")]
    assert relative == pytest.approx([-0.5, 0.5], rel=of_steps(1e-6))
    rate = found.names.index("latch_rate.line")  # sqrt(2 angle T / J)
    assert found.relative[rate] == pytest.approx([0.5, -0.5], rel=of_steps(1e-6))
    assert found.units == ("", "")
    assert found.values == (1.0, 1.0)


def test_a_latch_torque_in_closed_form():
    """Closed form: k x^2 / 2 = T (angle + x) without damping, for a peak after the latch-up, which comes earlier."""
    keys = [MOTOR, "hinge_line.line.latch.stiffness"]
    found = fanfold.gradients(flap(damping_ratio=0.0), keys, verify=False)
    step = 1e-5
    slope = (undamped_peak(1.0 + step) - undamped_peak(1.0 - step)) / (2.0 * step)
    assert found.of("latch_torque_peak.line", MOTOR) == pytest.approx(slope, rel=of_steps(1e-5))
    by_stiffness = ANGLE / (undamped_peak() - 1.0)  # of sqrt(T^2 + 2 k T angle)
    assert found.of("latch_torque_peak.line", "hinge_line.line.latch.stiffness") == pytest.approx(
        by_stiffness, rel=of_steps(1e-5)
    )
    assert undamped_peak() == pytest.approx(np.sqrt(1.0 + 2.0 * STIFFNESS * ANGLE) + 1.0)


def test_both_sides_are_more_accurate():
    """Definition: one side errs with the part of the key, both with its square; dt/dT as above."""
    one, both = (
        fanfold.gradients(flap(), MOTOR, central=central, verify=False).of("latch_time.line", MOTOR)
        for central in (False, True)
    )
    # half the second derivative, 3/4 t, over a part of 5e-6
    assert one - both == pytest.approx(0.5 * 0.75 * latch_time() * 5e-6, rel=0.2)


def test_errors_of_one_side_are_estimated():
    """Closed form: t of T^-1/2 J^1/2, a part e of each, to the other side: e^2 / 4 is missed of e / sqrt(2).

    Slopes of one side are too small by half the second derivatives, 3/8 e and -1/8 e; both at once move nothing.
    """
    found = fanfold.gradients(flap(), [MOTOR, INERTIA])
    error = found.errors[found.names.index("latch_time.line")]
    assert error == pytest.approx(0.25 * 5e-6 / np.sqrt(0.5), rel=0.05)
    assert not found.unreliable
    assert not found.warning


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_errors_of_the_steps_are_verified(tolerance):
    """Closed form of the peak without damping, as above: differences alone know nothing of what steps err by."""
    keys = [MOTOR, "hinge_line.line.latch.stiffness"]
    plain, verified = (
        fanfold.gradients(flap(damping_ratio=0.0), keys, tolerance=tolerance, verify=verify)
        for verify in (False, True)
    )
    peak = verified.names.index("latch_torque_peak.line")
    np.testing.assert_array_equal(verified.derivatives, plain.derivatives)
    slope = (undamped_peak(1.0 + 1e-5) - undamped_peak(1.0 - 1e-5)) / 2e-5
    exact = np.array([slope, ANGLE / (undamped_peak() - 1.0)])
    by_part = verified.values * (verified.derivatives[peak] - exact)
    error = abs(by_part.sum()) / np.linalg.norm(verified.values * exact)
    assert plain.errors[peak] < 1e-5
    # the run at a tenth of the tolerance errs as well, by up to as much
    assert error / 4.0 < verified.errors[peak] < 4.0 * error


def test_a_small_derivative_beside_large_ones_has_an_error_of_its_own():
    """Closed form as above, by a key that moves little. Regression: errors were those of all keys together."""
    keys = [MOTOR, "hinge_line.line.latch.stiffness"]
    found = fanfold.gradients(flap(damping_ratio=0.0), keys, tolerance=1e-3)
    peak = found.names.index("latch_torque_peak.line")
    slope = (undamped_peak(1.0 + 1e-5) - undamped_peak(1.0 - 1e-5)) / 2e-5
    exact = np.array([slope, ANGLE / (undamped_peak() - 1.0)])
    off = np.abs(found.derivatives[peak] - exact)
    # the run at a tenth of the tolerance errs as well, by a part of it
    assert np.all((off / 4.0 < found.single_errors[peak]) & (found.single_errors[peak] < 4.0 * off))
    assert np.isnan(fanfold.gradients(flap(), keys, verify=False).single_errors).all()
    # the error of a gradient as a whole is that of all, though single ones cancel in a neighbour in all keys at once
    whole = np.linalg.norm(found.single_errors * found.values, axis=1)
    whole /= np.linalg.norm(found.derivatives * found.values, axis=1)
    assert np.all(found.errors[[peak]] >= whole[[peak]] * (1.0 - 1e-9))


def test_numbers_that_scatter_are_told_of(tmp_path, monkeypatch):
    """A latch time with noise of a part of 1e-5, as large as what the keys do to it: named, and crossed out."""
    dice = np.random.default_rng(0)

    def scattered(result):
        found = headline(result)
        times = {
            line: time * (1.0 + 1e-5 * dice.standard_normal()) for line, time in found.latch_times.items()
        }
        return replace(found, latch_times=times)

    monkeypatch.setattr("orchestrator.analysis.sampling.gradients.headline", scattered)
    found = fanfold.gradients(flap(), [MOTOR, INERTIA])
    assert found.unreliable == ("latch_time.line",)
    assert "latch_time.line" in found.warning
    picture = plot_gradients(found, tmp_path / "unreliable.png")
    plain = plot_gradients(replace(found, errors=0.0 * found.errors), tmp_path / "plain.png")
    assert picture.read_bytes() != plain.read_bytes()


def test_what_no_key_moves_has_no_error():
    """A key that only takes part after the latch-up: the latch time is not moved at all, and not doubted."""
    found = fanfold.gradients(flap(damping_ratio=0.0), "hinge_line.line.latch.stiffness")
    assert np.isnan(found.errors[found.names.index("latch_time.line")])


def test_a_wing_that_comes_to_rest_has_derivatives():
    """Regression: where all loads had died out, rounding that no sweep makes smaller was taken for no convergence."""
    scene = latching().with_settings({"hinge_line.HL.latch.damping_ratio": 0.5})
    moving, resting = (
        fanfold.gradients(scene, "body.panel.rigid.mass", until=end, verify=False) for end in (2.0, 8.0)
    )
    number = "latch_time.HL", "body.panel.rigid.mass"
    assert resting.of(*number) == moving.of(*number)


def test_loads_of_rigid_locks_are_vouched_for_by_nobody():
    """Rule: an impulse meets rates of stiff joints by chance, alike in neighbours; latch times are the wing's.

    Regression: derivatives of impulses 41 % off were told to be 2 % off.
    """
    tree = latching().tree
    tree["hinge_line"][0]["latch"]["kind"] = "kinematic"
    scene = fanfold.Scene.of_tree("latching.toml", tree)
    found = fanfold.gradients(scene, ["hinge_line.HL.motor.stowed"])
    assert "latch_impulse.HL" in found.warning
    assert "latch_impulse.HL" in found.unreliable
    assert "latch_time.HL" not in found.unreliable


def test_a_key_of_zero_and_one_at_its_end():
    """A damping ratio of zero can only grow; a derivative by it is there all the same."""
    found = fanfold.gradients(flap(damping_ratio=0.0), DAMPING, verify=False)
    quarter = 0.5 * np.pi  # less energy by 2 pi zeta a swing takes the peak down by zeta pi / 2
    assert found.of("latch_torque_peak.line", DAMPING) == pytest.approx(-undamped_peak() * quarter, rel=0.1)
    assert found.of("latch_time.line", DAMPING) == 0.0


KEYS = ("hinge_line.HL3.motor.stowed", "friction.coefficient", "damper.damper.damping_coefficient")


ROUNDED = 1e-4
"""Of gradients of torques in locks of flexible bodies: angles of pi round by 4e-16 rad, which locks of 1e8 N.m/rad make
1e-7 N.m of, over 30 N.m and the part 5e-5 of a key to both sides."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rigid", "until"),
    [({"rigid": "all"}, 12.2), pytest.param({}, 12.5, marks=pytest.mark.thorough)],
    ids=["rigid", "flexible"],
)
def test_amos3_against_runs_of_their_own(rigid, until, monkeypatch):
    """Runs of their own along the same steps, to their own latch-ups: every gradient as a whole to 1e-5."""
    scene, options = fanfold.load("amos3"), {"until": until, "tolerance": 1e-3}
    own = Options(**options, **{key: frozenset({which}) for key, which in rigid.items()})
    monkeypatch.setattr(crossings, "EVENT_TOLERANCE", MET)
    found, plan = followed(scene, own, KEYS, central=True)
    true = [differences(scene, own, parameter(scene.tree, key), plan) for key in KEYS]
    for name, number, row in zip(found.names, found.numbers, found.derivatives, strict=True):
        if number.key in true[0]:
            wanted = np.array([one[number.key] for one in true]) * found.values
            off = np.linalg.norm(row * found.values - wanted) / np.linalg.norm(wanted)
            exact = 1e-5 if rigid else 2e-5  # the smallest component of the interface force has 1.4e-5
            assert off < (ROUNDED if "latch_torque" in name and not rigid else exact), name


def test_a_run_with_neighbours_is_the_run():
    """Its numbers are those of a run without, but for iterations and a step more before a latch-up."""
    found = fanfold.gradients(flap(), MOTOR, verify=False)
    run = fanfold.simulate(flap(), estimate=False)
    numbers = {one.id: one.value for one in found.numbers}
    assert numbers["latch_time.line"] == pytest.approx(run.latch_times["line"], rel=of_steps(1e-6))


def test_through_an_event_at_a_condition():
    """Closed form: a torque T up to half the angle, T / 2 beyond, from where a neighbour meets it at its own time."""
    scene = flap()
    scene.event(
        "weaker",
        when={"component": "line", "variable": "angle", "above": f"{0.5 * ANGLE} rad"},
        set={"line": {"motor_constant_torque": 0.25}},  # of each of two hinges
    )
    found = fanfold.gradients(scene, INERTIA, verify=False)
    # rate sqrt(T angle / J) at half the angle, sqrt(1.5) times that at the end, and T / 2 J between
    first = 0.5**0.5 * latch_time()
    whole = first + 2.0 * MOMENT * (1.5**0.5 - 1.0) * (ANGLE / MOMENT) ** 0.5
    assert found.numbers[found.names.index("latch_time.line")].value == pytest.approx(
        whole, rel=of_steps(1e-6)
    )
    assert found.of("latch_time.line", INERTIA) == pytest.approx(0.5 * whole, rel=of_steps(1e-6))


def test_fmus_with_signals_have_no_derivatives():
    """They cannot make a step twice; the sentence names them."""
    assembly = replace(
        Options().assemble(flap().check_one_run()), signal_fmus=(SimpleNamespace(name="controller"),)
    )
    with pytest.raises(fanfold.FanfoldError, match="controller"):
        run_beside(assembly, {}, Options().settings(assembly), 1.0)


def test_bodies_without_native_code_have_no_derivatives(monkeypatch):
    """The sentence names what there is only in Python."""
    monkeypatch.setattr(FmuParticipant, "native", property(lambda self: None))
    with pytest.raises(fanfold.FanfoldError, match=r"native.*flap"):
        fanfold.gradients(flap(), MOTOR)


WRONG = {
    "none": ([], "no key"),
    "twice": ([MOTOR, MOTOR], "given twice"),
    "absent": (["hinge_line.line.motor.wind_up"], r"motor\.wind_up"),
    "mistyped": (["hinge_line.line.moter.stowed"], "moter"),
    "a list": (["body.flap.rigid.inertia"], r"body\.flap\.rigid\.inertia\*"),
    "a text": (["scene.name"], r"scene\.name"),
    "different": ([f"{ENDS[0]},hinge_line.line.latch.stiffness"], "values differ; write"),
}


@pytest.mark.parametrize("kind", WRONG)
def test_what_has_no_derivative_is_a_sentence(kind):
    keys, sentence = WRONG[kind]
    with pytest.raises(fanfold.FanfoldError, match=sentence):
        fanfold.gradients(flap(), keys)


def test_the_command(tmp_path):
    """A table, a picture, JSON with the relative ones beside."""
    path = tmp_path / "flap.toml"
    path.write_text(flap().to_toml(), encoding="utf-8")
    picture = tmp_path / "flap.png"
    asked = ["analyse", "gradients", str(path), "--by", MOTOR, "--output", str(picture)]
    told = CliRunner().invoke(main, asked)
    assert told.exit_code == 0, told.output
    assert "latch_time.line" in told.stdout
    noise = [line for line in told.stdout.splitlines() if "round-off" in line]
    assert any("interface_force_peak.y" in line for line in noise)  # the flap turns about y
    assert not any("±" in line for line in noise)
    assert picture.stat().st_size > 1000
    found = json.loads(CliRunner().invoke(main, [*asked, "--json"]).stdout)
    assert found["keys"] == [MOTOR]
    place = list(found["numbers"]).index("latch_time.line")
    assert 0.0 < found["errors"][place] < 1e-4
    assert found["relative"][place] == pytest.approx([-0.5], rel=of_steps(1e-6))
    wrong = CliRunner().invoke(main, ["analyse", "gradients", str(path), "--by", "scene.name"])
    assert wrong.exit_code == 1
    assert "scene.name: " in wrong.output
