"""The largest stable step of masters without iteration: against such a master, closed forms, and tools' own limits."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pytest

import orchestrator as fanfold
from fmus import native_library
from orchestrator.analysis.stable_step import growth, largest_stable_step, own_growth
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.linear_model import linearise
from orchestrator.assembly.statics.mechanism import Mechanism
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import RunError, run
from orchestrator.scene import find_scene, load_scene


def workbench():
    return assemble(load_scene(find_scene("workbench")), {"all"}, (), "endpoint")


def test_tools_that_do_not_iterate_bear_it():
    """Measured: the workbench's rigid panel is stable at 5e-5 s and diverges at 1e-4 s in libcosim and in Ecos."""
    assert largest_stable_step(workbench()) == 5e-5


def test_joints_with_play_are_as_stiff_as_at_their_walls():
    """Definition: the step of joints without play, though within it they and their latches have no stiffness."""
    latch = {"kind": "spring", "stiffness": "1e7 N.m/rad", "inboard_stiffness": "1e8 N.m/rad"}
    latch |= {"outboard_stiffness": "1e8 N.m/rad"}
    play = {
        "joint.axial_clearance": "1 mm",
        "joint.radial_clearance": "1 mm",
        "joint.cross_clearance": "1 mrad",
    }
    stiff = {f"hinge_line.HL.latch.{name}": value for name, value in latch.items()}

    def step_with(**keys):
        return largest_stable_step(
            assemble(fanfold.load("workbench", (), keys).check(), {"all"}, (), "endpoint")
        )

    loose = {**play, "hinge_line.HL.latch.play": "5 mrad"}
    assert step_with(**loose) == step_with() == 5e-5
    assert step_with(**loose, **stiff) == step_with(**stiff) < 5e-5


@pytest.mark.parametrize(("factor", "stays"), [(1.0, True), (10.0, False)])
def test_our_own_master_without_iteration_agrees(factor, stays):
    """Against the Jacobi master: the panel stays at its place within 0.03 s, or is gone."""
    assembly = workbench()
    step = factor * (largest_stable_step(assembly) or np.nan)
    try:
        found = run(assembly, None, Settings(fixed_step=step), 0.03, "jacobi").result
        rate = np.abs(found.signal("hinge_left", "angular_rate")).max()
    except RunError:
        rate = np.inf
    assert (rate < 1.0) == stays


def test_small_steps_grow_as_the_wing_itself_does():
    """Limit: as the step goes to zero the delay goes with it."""
    assembly = workbench()
    model = linearise(Mechanism(assembly.parts, assembly.links, assembly.base))
    assert growth(model, 1e-7) == pytest.approx(own_growth(model), abs=1e-3)


def test_growth_is_that_of_the_recurrence():
    """Closed form: the stiffest damped joint alone, v' = v - h mu d u with u the rate a step ago: mu h d < 1 holds."""
    assembly = workbench()
    model = linearise(Mechanism(assembly.parts, assembly.links, assembly.base))
    rows = model.free_rows
    mobility = np.linalg.inv(model.mass[np.ix_(rows, rows)])
    fastest = np.linalg.eigvals(mobility @ model.damping[np.ix_(rows, rows)]).real.max()
    only_damped = replace(model, stiffness=np.zeros_like(model.stiffness))
    assert growth(only_damped, 0.99 / fastest) < 1e-3 * fastest
    assert growth(only_damped, 1.01 / fastest) > 1e-3 * fastest


@pytest.mark.skipif(native_library() is None, reason="reduces and exports PythonFMUs for minutes")
def test_an_export_tells_of_a_step_that_nobody_can_wait_for(tmp_path):
    """Rule: a flexible panel needs 3e7 steps in other tools, and says so; a rigid one needs 1e5 and is quiet."""
    with pytest.warns(fanfold.FanfoldWarning, match=r"2e-07 s, 3e\+07 .*W-export-step"):
        fanfold.export("workbench", tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fanfold.export("workbench", tmp_path, rigid="all")
