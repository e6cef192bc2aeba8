"""Latches and events that come at one instant: all of them act, in every master, and no time runs back."""

import numpy as np
import pytest

import orchestrator as fanfold
from tests.references.native_fmus import needs_native
from tests.unit.run.as_one.host import Host

PANEL = {
    "mass": 2.0,
    "center_of_mass": [0.5, 0.0, 0.0],
    "inertia": [0.1, 0.2, 0.3],
    "points": {"root": [0.0, 0.0, 0.0]},
}
SIDES = {"A": ("a", "left"), "B": ("b", "right")}


def twins(kind="spring", axes=("+y", "+y"), **tree):
    """The same panel on both sides of a fixed spacecraft."""
    bodies = [{"name": body, "rigid": PANEL} for body, _ in SIDES.values()]
    lines = [
        {
            "name": name,
            "inboard": "base",
            "outboard": body,
            "axis": axis,
            "aligned_angle": "90 deg",
            "motor": {"stowed": "0.6 N.m", "deployed": "0.2 N.m"},
            "latch": {"kind": kind, "stiffness": "500 N.m/rad"},
            "hinges": [{"name": f"hinge_{body}", "inboard": point, "outboard": "root"}],
        }
        for (name, (body, point)), axis in zip(SIDES.items(), axes, strict=True)
    ]
    base = {"points": {"left": [0.0, 1.0, 0.0], "right": [0.0, -1.0, 0.0]}}
    whole = {"scene": {"name": "twins", "until": 2.5}, "base": base, "body": bodies, "hinge_line": lines}
    return fanfold.Scene.of_tree("twins.toml", whole | tree)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 1e-6])
@pytest.mark.parametrize("kind", ["spring", "kinematic"])
def test_twins_latch_together(tmp_path, tolerance, kind):
    """Symmetry. Regression: one of both was past its latch when the other engaged, and went on for ever.

    Or rows of the instant after the first were later than those of the second, and the file was called damaged.
    """
    run = fanfold.simulate(twins(kind), tolerance=tolerance, refine=False, save=tmp_path / "twins.h5")
    assert run.latch_times["A"] == pytest.approx(run.latch_times["B"], abs=2e-6)
    angles = [run[f"hinge_{body}", "angle"][-1] for body, _ in SIDES.values()]
    assert angles == pytest.approx([np.pi / 2] * 2, abs=0.06)
    assert np.all(np.diff(run.time) >= 0.0)
    if kind == "spring":
        peaks = run.headline.latch_torque_peaks
        assert peaks["A"] == pytest.approx(peaks["B"], rel=1e-3)
        assert peaks["A"] == pytest.approx(24.51, rel=1e-2)


def test_mirrored_twins(tmp_path):
    """Symmetry: the same about the opposite axis."""
    run = fanfold.simulate(twins(axes=("+y", "-y")), save=tmp_path / "twins.h5")
    assert run.latch_times["A"] == pytest.approx(run.latch_times["B"], abs=1e-6)


def test_mirrored_twins_lock_in_one_impulse():
    """Symmetry: a free spacecraft between two panels that open to both sides never turns, and both lock alike.

    Regression: one locked after the other, so that the first lock turned all, and its impulse was told as 0.4 of this.
    """
    tree = twins("kinematic", axes=("+x", "-x")).tree
    tree["base"]["free"] = {"mass": 20.0, "center_of_mass": [0, 0, 0], "inertia": [4.0, 4.0, 4.0]}
    tree["body"] = [
        {"name": body, "rigid": PANEL | {"center_of_mass": [0.0, side, 0.0]}}
        for (body, _), side in zip(SIDES.values(), (0.5, -0.5), strict=True)
    ]
    run = fanfold.simulate(fanfold.Scene.of_tree("twins.toml", tree), refine=False)
    impulses = run.headline.latch_impulses
    assert impulses["A"] == pytest.approx(impulses["B"], rel=1e-6)
    rates = np.abs(run["base", "attitude_rate"][:])
    assert np.max(rates) < 1e-6 * np.max(np.abs(run["hinge_a", "angular_rate"][:]))


def test_an_event_at_the_angle_of_a_latch(tmp_path):
    """A condition that is met where a latch engages: both act, and what one does holds for the other as well."""
    event = {
        "name": "cut",
        "when": {"component": "A", "variable": "angle", "above": "90 deg"},
        "set": {"A": {"motor_stiffness": 0.0}},
    }
    run = fanfold.simulate(twins(event=[event]), save=tmp_path / "twins.h5")
    assert set(run.latch_times) == {"A", "B"}
    assert np.all(run["hinge_a", "motor_torque"][run.time > run.latch_times["A"] + 1e-6] == 0.0)


@pytest.mark.parametrize("first", ["A", "B"])
def test_conditions_that_come_together_act_in_the_order_of_the_scene(first, tmp_path):
    """As those at one time do: what is set last stays. Regression: they acted the other way round."""
    when = {"component": "A", "variable": "angle", "above": "45 deg"}
    settings = {"A": 0.5, "B": 0.25}
    names = [first, *(settings.keys() - {first})]
    events = [
        {"name": f"to_{n}", "when": when, "set": {"A": {"motor_stiffness": settings[n]}}} for n in names
    ]
    scene = twins(event=events)
    run = fanfold.simulate(scene, estimate=False)
    acted = [name for _, name, _ in run.events if name.startswith("to_")]
    assert acted == [f"to_{name}" for name in names]
    (path,) = fanfold.export(scene, tmp_path, as_one=True)
    host = Host(path).start().to(2.5, 0.1)
    assert host["A.latch_time"] == pytest.approx(run.latch_times["A"], abs=4e-7)


@needs_native
def test_numbers_have_no_derivatives_where_lines_latch_together():
    """Which of both comes first hangs on the sign of a change: there is no derivative, and that is told."""
    with pytest.raises(fanfold.FanfoldError, match=r"hinge_line\.A\.motor\.stowed .* no derivatives"):
        fanfold.gradients(twins(), ["hinge_line.A.motor.stowed"])
