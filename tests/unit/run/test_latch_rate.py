"""Rates and kinetic energies at latch-up: closed forms of a flap, for springs and for locks."""

from math import sqrt

import pytest

import orchestrator as fanfold
from tests.unit.analysis.sampling.flap import ANGLE, INERTIA, flap

TORQUE = 1.3
RATE = sqrt(2.0 * TORQUE * ANGLE / INERTIA)
WORK = TORQUE * ANGLE


@pytest.mark.parametrize("kind", ["spring", "kinematic"])
def test_all_work_of_the_motor_is_taken_up(kind):
    """Closed form: T angle, with the rate that it makes of the inertia; a lock's impulse tells the same."""
    scene = flap(TORQUE).with_settings({"hinge_line.line.latch.kind": kind})
    found = fanfold.simulate(scene, rigid="all").headline
    assert found.latch_rates["line"] == pytest.approx(RATE, rel=1e-5)
    assert found.latch_energies["line"] == pytest.approx(WORK, rel=1e-4)
    assert ("line" in found.latch_impulses) == (kind == "kinematic")
    errors = {number.id: number.error for number in found.numbers()}
    assert 0.0 <= errors["latch_rate.line"] < 1e-4
    assert errors["latch_energy.line"] is not None


def test_a_rate_is_a_target():
    """Closed form: the torque goes with the square of the rate."""
    wanted = f"{1.1 * RATE} rad/s"
    ends = "hinge_line.line.motor.stowed,hinge_line.line.motor.deployed"
    found = fanfold.tune(
        flap(TORQUE), {ends: "uniform(1 N.m, 2 N.m)"}, {"line.latch_rate": wanted}, until=3.0, tolerance=1e-5
    )
    assert found.numbers[0].number == "latch_rate.line"
    assert found.values[ends] == pytest.approx(1.21 * TORQUE, rel=1e-3)
