"""Impulses of kinematic latches, and whose torque is that of the lock."""

import numpy as np
import pytest

from orchestrator.results.key_figures import headline_rows

from .scene_runs import RUNS

LOCKED = ("hinge_line.HL.latch.kind=kinematic",)


def test_impulse_is_the_angular_momentum_that_the_latch_takes():
    """Conservation law: a rigid panel about a fixed axis has the angular momentum 2 T / w, and loses all of it.

    To 1e-4: its hinges give way by 1e-5 rad, and their rates are those of the joints, not of the panel.
    """
    outcome = RUNS("workbench", rigid=("all",), settings=LOCKED)
    result, latched = outcome.result, outcome.headline.latch_times["HL"]
    before = int(np.searchsorted(result.time, latched, side="right")) - 1
    kinetic = float(result.signal("panel", "kinetic_energy")[before])
    rate = float(result.signal("hinge_left", "angular_rate")[before])
    assert outcome.headline.latch_impulses["HL"] == pytest.approx(2.0 * kinetic / rate, rel=1e-4)


def test_torque_of_a_lock_between_rigid_bodies_is_told_as_such():
    """Rule: beside a flexible body the torque of a lock is a load, between rigid ones it is that of the lock."""
    rigid, flexible = (RUNS("workbench", rigid=names, settings=LOCKED).headline for names in (("all",), ()))
    assert flexible.latch_impulses == {}
    told = [{row[0] for row in headline_rows(found)} for found in (rigid, flexible)]
    wanted = {"latch impulse", "latch torque peak", "lock torque peak"}
    assert [wanted & found for found in told] == [wanted - {"latch torque peak"}, {"latch torque peak"}]


def test_a_latch_spring_has_no_impulse():
    assert RUNS("workbench", rigid=("all",)).headline.latch_impulses == {}
