"""A cable loop that is cut in mid-run: it carries nothing from there on, and what it held is taken from the balance."""

import numpy as np

import orchestrator as fanfold

CUT = {
    "name": "cut",
    "when": {"component": "HL1", "variable": "angle", "above": "45 deg"},
    "release": ["yoke_loop"],
}


def cut_wing():
    tree = fanfold.load("amos3").tree | {"event": [CUT]}
    return fanfold.Scene.of_tree("amos3.toml", tree)


def test_a_cut_loop_carries_nothing():
    """Definition, and conservation: the preload's energy leaves from outside. Its lines latch out of step then.

    Regression: a loop could not be released, and was advised to lose its stiffness, which kept its preload.
    """
    run = fanfold.simulate(cut_wing(), rigid="all", until=12.0, estimate=False)
    (cut,) = (time for time, name, _ in run.events if name == "cut")
    before, after = run.time < cut, run.time > cut + 1e-6
    for strand in ("tension_a", "tension_b"):
        assert np.max(run["yoke_loop", strand][before]) > 10.0
        assert not np.any(run["yoke_loop", strand][after])
    assert not np.any(run["yoke_loop", "potential_energy"][after])
    assert run.headline.energy_residual < 1e-5
    whole = fanfold.simulate("amos3", rigid="all", until=12.0, estimate=False).latch_times
    assert abs(run.latch_times["HL2"] - whole["HL2"]) > 0.05
