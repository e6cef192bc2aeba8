"""Verification runs: steps halved and quartered; the error they estimate against the true one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import RunError, run
from orchestrator.run.verify import halved, verify
from orchestrator.scene.builder import Scene

TWO_PANELS = Path(__file__).parents[2] / "scenes" / "two_panels.toml"
LATCH = {"stiffness": 200, "outboard_stiffness": 200, "effective_inertia": 1.5}
SMOOTH = {
    "axial_stiffness": "4e4 N/m",
    "radial_stiffness": "4e4 N/m",
    "cross_stiffness": "4e3 N.m/rad",
    "damping_ratio": 0.3,
    "damping_frequency": "15 Hz",
}
"""Slow and damped enough for the steps to resolve what a release and a latch-up excite."""


def smooth_scene():
    """Two panels with strong motors and soft joints; the middle line latches at 2.04 s."""
    scene = Scene.load(TWO_PANELS)
    scene.joint(**SMOOTH)
    root = {"name": "root_line", "motor": {"stowed": 6.4, "deployed": 4.0}}
    middle = {"name": "middle_line", "motor": {"stowed": 8.0, "deployed": 4.8}, "latch": LATCH}
    return assemble(scene.with_settings({"hinge_line": [root, middle]}).check())


def test_halved_steps():
    """Closed form: twice as many steps, segment by segment, that reach the same times."""
    segments = [[0.25, 0.5], [], [1.0]]
    assert halved(segments) == [[0.125, 0.125, 0.25, 0.25], [], [0.5, 0.5]]


@pytest.fixture(scope="module")
def verified(tmp_path_factory):
    """A coarse run with its verification, and headline numbers of a run at a hundredth of its tolerance."""
    folder = tmp_path_factory.mktemp("verified")
    assembly = smooth_scene()
    settings = Settings(tolerance=1e-3)
    outcome = run(assembly, folder / "run.h5", settings, 2.8)
    found = verify(assembly, outcome, settings, 2.8)
    tight = run(assembly, folder / "tight.h5", Settings(tolerance=1e-5), 2.8)
    return outcome, found, {(n.quantity, n.of): n.value for n in tight.headline.numbers()}


KNOWN = 1e-9
"""Relative accuracy to which rounding leaves the instant of an event known."""


def ratios(verified, *quantities):
    """Estimated over true error of the named quantities, both beside rounding.

    What is zero by symmetry has no error to estimate.
    """
    _, found, truth = verified
    ratio = {}
    for v in found:
        number = v.number
        if number.quantity in quantities and abs(number.value) > 1e-6:
            known = KNOWN * abs(number.value)
            true = abs(number.value - truth[number.quantity, number.of])
            ratio[f"{number.quantity} {number.of}"] = (v.error + known) / (true + known)
    return ratio


def test_estimated_error_of_smooth_quantities(verified):
    """Within a factor 2 of the true error, here a run with other steps and 20 times its accuracy."""
    found = ratios(verified, "latch time", "motor work")
    assert len(found) == 2
    assert all(0.5 < ratio < 2.0 for ratio in found.values()), found


def test_estimated_error_of_peaks(verified):
    """Within a factor 4 of the true error for peaks, which are interpolated between steps."""
    found = ratios(verified, "latch torque peak", "interface force peak")
    assert len(found) == 3
    assert all(0.25 < ratio < 4.0 for ratio in found.values()), found


def test_observed_order_is_two(verified):
    """Convergence: what the scheme promises, seen in the verification's own three runs."""
    _, found, _ = verified
    orders = [v.order for v in found if v.number.quantity in ("latch time", "motor work")]
    assert orders == pytest.approx([2.0, 2.0], abs=0.2)


def test_extrapolation_comes_closer(verified):
    """Independent path: the extrapolated latch time is nearer to that of the tight run than the coarse one."""
    _, found, truth = verified
    v = next(v for v in found if v.number.quantity == "latch time")
    true = truth["latch time", "middle_line"]
    assert abs(v.extrapolated - true) < 0.2 * abs(v.number.value - true)


def test_results_of_finer_runs_stay(verified):
    """Consistency: the finer results stand beside the first, with two and four times its steps, give or take events."""
    outcome, found, _ = verified
    steps = [
        len(Result.open(outcome.path.with_suffix(suffix)).time)
        for suffix in (".h5", ".halved.h5", ".quartered.h5")
    ]
    assert steps[1] / steps[0] == pytest.approx(2.0, rel=0.02)
    assert steps[2] / steps[1] == pytest.approx(2.0, rel=0.02)
    assert not {"end time", "energy residual"} & {v.number.quantity for v in found}


def test_plan_that_ends_before_its_event(tmp_path):
    """Regression: beyond the end of a plan the last step, cut short by an event, is not repeated for ever."""
    assembly = smooth_scene()
    plan = Settings(step_plan=[[0.005] * 5 + [1e-7], [0.005]])
    outcome = run(assembly, tmp_path / "run.h5", plan, 0.1)
    assert outcome.costs.steps < 30
    assert np.all(np.diff(Result.open(outcome.path).time) > 0.0)


def test_latch_up_that_a_finer_run_does_not_reach(tmp_path):
    """Bad luck: numbers that not all runs have are left out, the others are still verified."""
    assembly = smooth_scene()
    settings = Settings(tolerance=1e-3)
    outcome = run(assembly, tmp_path / "run.h5", settings, 0.02)
    early = replace(outcome.headline, latch_times={"middle_line": 0.015})
    quantities = [v.number.quantity for v in verify(
        assembly, replace(outcome, headline=early), settings, 0.02)]  # fmt: skip
    assert "latch time" not in quantities
    assert "motor work" in quantities


def test_explicit_run_is_not_verified(tmp_path):
    """Bad input: no halving of steps that were not recorded; a sentence instead."""
    assembly = smooth_scene()
    settings = Settings(fixed_step=1e-4)
    outcome = run(assembly, tmp_path / "run.h5", settings, 1e-3, "jacobi")
    with pytest.raises(RunError, match="implicit"):
        verify(assembly, outcome, settings)
