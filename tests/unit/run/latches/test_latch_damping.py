"""The damping that a line latches with, and what is told where it is not what was asked."""

import warnings

import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import run
from orchestrator.scene import read_scene

PANEL = {
    "mass": 8,
    "center_of_mass": (0.8, 0, 0),
    "inertia": (0.9, 1.8, 2.7),
    "points": {"root": (0, 0, 0), "tip": (1.6, 0, 0)},
}


def wing(panels, motors, until, **latch):
    """Rigid panels folded on each other, each with a motor (N.m) and a spring latch at its line."""
    scene = fanfold.Scene("wing", until=until)
    inner, point = scene.base(points={"root": (0, 0, 0)}), "root"
    for number in range(panels):
        outer = scene.body(f"p{number}", rigid=PANEL)
        scene.hinge_line(
            f"L{number}", inner, outer, axis="-y" if number == 0 else "+y" if number % 2 else "-y",
            aligned_angle="90 deg" if number == 0 else "180 deg",
            hinges={f"h{number}": (point, "root")},
            motor={"stowed": motors[number], "deployed": 0.6 * motors[number]},
            latch={"kind": "spring", "stiffness": 4e3, "damping_ratio": 0.02, **latch},
        )  # fmt: skip
        inner, point = outer, "tip"
    return scene


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_line_latches_as_a_whole_at_any_tolerance(tolerance, friction):
    """Closed form: sqrt(k / I) of one panel. Regression: the frequency of ever shorter times as tolerances fell.

    Damping was taken from what a latch-up adds, from which friction that it ends was taken away.
    """
    tree = wing(1, [2.0], 4.0).with_settings({"hinge_line.L0.friction_preload": friction}).tree
    assembly = assemble(read_scene("wing.toml", tree))
    outcome = run(assembly, None, Settings(tolerance, assembly.largest_step))
    inertia = PANEL["inertia"][1] + PANEL["mass"] * PANEL["center_of_mass"][0] ** 2
    assert outcome.latch_frequencies["L0"] == pytest.approx((4e3 / inertia) ** 0.5, rel=0.01)


@pytest.mark.filterwarnings("ignore:.* has not latched")  # it ends before
@pytest.mark.filterwarnings("ignore:L. folded back")  # nothing there stops it
def test_a_line_that_latches_before_the_others_is_told_of():
    """Its peak was 16 % low without a word: the default inertia is that of the deployed wing."""
    motors = [8.0, 0.02, 0.02]
    with pytest.warns(
        fanfold.FanfoldWarning, match=r"L0 latched with .* of critical damping instead of 2.0%"
    ):
        low = fanfold.simulate(wing(3, motors, 3.0), estimate=False)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        right = fanfold.simulate(wing(3, motors, 3.0, effective_inertia=12.0), estimate=False)
    assert not any("critical" in str(one.message) for one in told)
    peaks = [found.headline.latch_torque_peaks["L0"] for found in (low, right)]
    assert peaks[0] < 0.95 * peaks[1]
