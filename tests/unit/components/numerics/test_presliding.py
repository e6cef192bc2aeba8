"""Friction that sticks, over a step: the mean of its law in time, its spring, and heat that is never negative."""

from math import copysign

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components.numerics.fourth_order_correction import workless_spring
from components.numerics.presliding import instant_force, step_force
from components.numerics.stiff_coordinate import Memory, StepMotion

NUMBER = st.floats(0.0, 1.0)
SIGNED = st.floats(-1.0, 1.0)
PARTS = 20_000


@given(
    NUMBER, NUMBER, st.floats(1e-6, 1.0) | st.just(0.0), SIGNED, SIGNED, SIGNED, SIGNED, st.floats(1e-3, 1.0)
)
def test_no_step_makes_energy(stiffness, damping, friction, growing, deflection, change, moment, h):
    """Work = energy of the spring + heat, and heat >= 0, to the round-off of these products; force within friction."""
    k = 1e-3 + 10.0 * stiffness
    found = step_force(k, damping, friction, deflection, change, h, moment=moment, friction_slope=growing)
    stored = 0.5 * k * (found.deflection**2 - deflection**2)
    size = abs(change) + 6.0 * abs(moment)
    round_off = (
        1e-14 * (k * (deflection**2 + size**2) + friction * (1.0 + size) + damping * size**2 / h) + 1e-300
    )
    work = -found.force * change - found.slope * moment
    assert work == pytest.approx(stored + found.heat, abs=round_off)
    assert found.heat >= -round_off
    assert abs(found.force) <= friction * (1.0 + 1e-12) + 1e-300
    at_end = friction + copysign(min(abs(growing), friction), growing)
    assert k * abs(found.deflection) <= at_end + 1e-12 * friction + 1e-300


def law_in_time(k, c, friction, start, change, moment, h):
    """Mean, slope and end of the deflection along the path, by steps of the law with the midpoint rule."""
    t = (np.arange(PARTS) + 0.5) / PARTS
    rate, most = change + 3.0 * moment * (2.0 * t - 1.0), friction[0] + friction[1] * (2.0 * t - 1.0)
    z, force = (
        np.clip(start, -(friction[0] - friction[1]) / k, (friction[0] - friction[1]) / k),
        np.zeros(PARTS),
    )
    for i in range(PARTS):
        half = 0.5 * rate[i] / PARTS
        z = min(max(z + half, -most[i] / k), most[i] / k)
        force[i] = -min(max(k * z + c * rate[i] / h, -most[i]), most[i])
        z = min(max(z + half, -most[i] / k), most[i] / k)
    return force.mean(), 3.0 * np.mean(force * (2.0 * t - 1.0)), z


PATHS = np.random.default_rng(7).uniform(-1.0, 1.0, (20, 4))


@pytest.mark.parametrize("damping", [0.0, 0.4])
@pytest.mark.parametrize("path", PATHS, ids=range(len(PATHS)))
def test_a_step_that_sticks_slides_and_turns_is_that_of_its_law_in_time(path, damping):
    """Along paths that turn within a step, with friction that changes: the mean and the first moment of the force.

    20,000 parts are off by their size times the jump of the slope at each of a few corners: below 5e-5 of 1 N.
    """
    start, change, moment, growing = path[0] * 0.1, 0.4 * path[1], 0.3 * path[2], 0.5 * path[3]
    found = step_force(10.0, damping, 1.0, start, change, 0.7, moment=moment, friction_slope=growing)
    mean, slope, end = law_in_time(10.0, damping, (1.0, growing), start, change, moment, 0.7)
    assert found.force == pytest.approx(mean, abs=5e-5)
    assert found.slope == pytest.approx(slope, abs=1.5e-4)
    assert found.deflection == pytest.approx(end, abs=5e-5)


@given(SIGNED, SIGNED, SIGNED, st.floats(0.1, 10.0))
def test_sticking_is_a_spring_and_a_damper_of_order_4(start, change, moment, k):
    """Below the friction: what `workless_spring` says of both."""
    h, c, friction = 0.5, 0.3, 1e6
    found = step_force(k, c, friction, start, change, h, moment=moment)
    motion = StepMotion(start, start + change, h, Memory(0.0, 0.0), moment)
    spring = workless_spring(k, c, motion)
    assert found.force == pytest.approx(spring.force, abs=1e-12)
    assert found.slope == pytest.approx(spring.slope, abs=1e-12)
    assert found.heat == pytest.approx(spring.heat, abs=1e-12)


@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.parametrize(
    ("start", "change"), [(0.0, 0.05), (0.0, 0.4), (0.09, -0.15), (-0.1, -0.2), (0.1, 1e-9)]
)
def test_the_mean_of_a_step_is_that_of_its_law_in_time(start, change, damping):
    """By the midpoint rule over 20,000 parts at a constant rate: off by h^2 / 24 of jumps in slope, here below 1e-8."""
    k, friction, h = 10.0, 1.0, 0.7
    found = step_force(k, damping, friction, start, change, h)
    rate, limit = change / h, friction / k
    moved = np.clip(start + change * (np.arange(PARTS) + 0.5) / PARTS, -limit, limit)
    law = np.mean([instant_force(k, damping, friction, z, rate).force for z in moved])
    assert found.force == pytest.approx(law, abs=2e-8)
    assert found.deflection == pytest.approx(np.clip(start + change, -limit, limit), abs=1e-15)


@given(SIGNED, SIGNED, SIGNED)
def test_force_follows_the_motion_without_jumps(start, change, further):
    """Nowhere steeper than stuck: k / 2 + c / h."""
    k, friction, h, damping = 10.0, 1.0, 0.5, 0.2
    one, other = (
        step_force(k, damping, friction, 0.1 * start, s, h).force for s in (change, change + further)
    )
    assert abs(other - one) <= (0.5 * k + damping / h) * abs(further) * (1.0 + 1e-12) + 1e-14


@given(st.floats(-0.9, 0.9))
def test_slope_of_the_force_has_no_jump_where_it_breaks_away(start):
    """At the way w where k (z + w) + c w / h = F; beyond it slopes change by at most k / w."""
    k, friction, h, damping = 10.0, 1.0, 0.5, 0.2
    way, d = (friction / k - 0.1 * start) / (1.0 + damping / (h * k)), 1e-6
    around = [step_force(k, damping, friction, 0.1 * start, way + n * d, h).force for n in (-1, 0, 1)]
    before, after = (around[1] - around[0]) / d, (around[2] - around[1]) / d
    assert after == pytest.approx(before, abs=2.0 * d * (k + damping / h) / way + 1e-8)


def test_friction_that_falls_lets_the_spring_go():
    """Held at z = F / k while friction halves: three quarters of the spring's energy become heat, none of it work."""
    found = step_force(10.0, 0.0, 0.5, 0.1, 0.0, 1.0)
    assert found.deflection == pytest.approx(0.05)
    assert found.heat == pytest.approx(0.5 * 10.0 * (0.1**2 - 0.05**2), rel=1e-14)


def test_power_of_an_instant_is_heat_and_spring():
    """Force times rate less the spring: c v^2 stuck, F v sliding, (F - k z) v where damping breaks it away."""
    assert instant_force(10.0, 0.3, 1.0, 0.02, 0.5).heat == pytest.approx(0.3 * 0.5**2)
    assert instant_force(10.0, 0.3, 1.0, 0.1, 0.5).heat == pytest.approx(1.0 * 0.5)
    assert instant_force(10.0, 0.3, 1.0, 0.09, 0.5).heat == pytest.approx((1.0 - 0.9) * 0.5)
    assert instant_force(10.0, 0.3, 1.0, 0.1, -0.5).heat == pytest.approx(0.3 * 0.5**2)
