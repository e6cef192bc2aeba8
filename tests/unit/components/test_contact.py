"""Contact: Hertz impact, damped impact, a turning plane; conservation at any step, passivity, refusals."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from components.contact import Contact, mean_power, mean_rise
from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import Tolerance, base, between, completed, rigid
from tests.references.relative_motion import inputs, port_motion, resultant, work, wrenches
from tests.unit.components.prepared import made

MASS, SPEED, STIFFNESS = 10.0, 0.5, 1e6
HERTZ = {"reference_force": STIFFNESS * 1e-3**1.5, "reference_penetration": 1e-3, "exponent": 1.5}
TIGHT = Tolerance(1e-11, 1.0, 1.0)
SMALL = st.floats(-0.5, 0.5)
THREE = st.tuples(SMALL, SMALL, SMALL)


def impact(settings, until, height=0.0, **parameters):
    """A ball that falls on a wall without gravity."""
    parts = [
        base(wall=(0, 0, 0)),
        rigid(
            "ball", MASS, (1.0, 1.0, 1.0), {"point": (0, 0, 0)},
            initial_position=(0, 0, height), initial_velocity=(0, 0, -SPEED),
        ),
        Part("pad", "contact", {}, parameters),
    ]  # fmt: skip
    return completed(
        until, parts, between("pad", "base.wall", "ball.point"), settings=settings, iteration=TIGHT
    )


def at_steps(h):
    return Settings(tolerance=1e-8, fixed_step=h)


def highest(run, name):
    """Peak of an observation from a cubic interpolant, in the middle of a Hertz impact."""
    times = np.linspace(0.01, 0.03, 20001)
    return CubicSpline(run.times, run.signal("pad", name))(times).max()


def leaves(run):
    """When the ball leaves the wall; its last step is free."""
    depth, time = run.signal("pad", "penetration"), run.times
    return time[-1] - depth[-1] * (time[-1] - time[-2]) / (depth[-1] - depth[-2])


def test_hertz_impact():
    """Reference: closed forms of an impact under k s^1.5 give 6.279716 mm, 497.634 N and 36.9659 ms.

    The duration errs by (w h)^2 / 12 with w = pi / duration; extrapolated, terms of the order of (w h)^4 are left.
    Peaks lie on the discrete energy surface; what is left is the cubic interpolant's (w h)^4 / 384.
    """
    deepest = (1.25 * MASS * SPEED**2 / STIFFNESS) ** 0.4
    runs = [impact(at_steps(h), 0.045, **HERTZ) for h in (5e-4, 2.5e-4)]
    share = np.pi / 0.0369659 * 5e-4
    for run in runs:
        assert highest(run, "penetration") == pytest.approx(deepest, rel=share**4 / 384 * 10)
        assert highest(run, "penetration") == pytest.approx(6.279716e-3, rel=3e-7)
        assert highest(run, "contact_force") == pytest.approx(497.634, rel=1e-6)
    assert leaves(runs[0]) == pytest.approx(0.0369659, rel=share**2 / 12 * 2)
    assert (4 * leaves(runs[1]) - leaves(runs[0])) / 3 == pytest.approx(0.0369659, rel=share**4 + 2e-6)


@pytest.mark.parametrize("h", [2e-2, 3e-3, 1e-3])
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.2])
def test_energy_is_kept_at_any_step(h, exponent):
    """Conservation: the ball comes back as fast as it came, and energy never changes, touch within a step.

    The iteration ends at 1e-11 of the force, which works over twice the depth.
    """
    parameters = {**HERTZ, "exponent": exponent}
    run = impact(at_steps(h), max(0.12, 20 * h), 0.0123, **parameters)
    depth = run.signal("pad", "penetration")
    assert depth.max() > 0.0 > depth[-1]
    assert list(run.signal("pad", "in_contact")) == list((depth >= 0.0).astype(float))
    assert np.abs(run.scene("energy_residual")).max() < 1e-9 * 0.5 * MASS * SPEED**2
    assert run.signal("ball", "linear_momentum")[-1, 2] == pytest.approx(MASS * SPEED, rel=1e-9)
    assert np.all(run.signal("pad", "dissipated_energy") == 0.0)


def test_step_control_follows_an_impact():
    """Default settings: relative error of the peak and of the energy within the tolerance of 1e-4."""
    run = impact(Settings(), 0.1, 0.02, **HERTZ)
    deepest = run.signal("pad", "penetration").max()
    assert deepest == pytest.approx(6.279716e-3, rel=1e-4)
    assert np.abs(run.scene("energy_residual")).max() < 1e-4 * 0.5 * MASS * SPEED**2


def damped(exponent, damping, full, until):
    """Depth and rate at the end, depth at most, and heat from the law written down once more, by SciPy."""

    def force(depth, rate):
        part = np.clip(depth / full, 0.0, 1.0)
        return max(
            0.0,
            HERTZ["reference_force"] * (max(depth, 0.0) / 1e-3) ** exponent
            + damping * part**2 * (3 - 2 * part) * rate,
        )

    found = solve_ivp(
        lambda t, s: (s[1], -force(*s) / MASS), (0.0, until), (0.0, SPEED), "DOP853",
        rtol=1e-11, atol=1e-14, max_step=1e-3, dense_output=True,
    )  # fmt: skip
    heat = 0.5 * MASS * (SPEED**2 - found.y[1, -1] ** 2)
    return found.y[0, -1], found.y[1, -1], found.sol(np.linspace(0, until, 100001))[0].max(), heat


@pytest.mark.parametrize(
    ("exponent", "damping", "full"), [(1.0, 200.0, 5e-3), (1.5, 300.0, 1e-3), (1.0, 5000.0, 2e-3)]
)
def test_damped_impact(exponent, damping, full):
    """Independent integration of the same ball; the last case would pull if it could.

    Second order in the step: (w h)^2 / 12 is 6e-4 of everything at 1 ms, and an eighth of the step leaves 1/64 of
    it, four times as much where steps meet the kinks of the law elsewhere. The energy balance is that of the
    iteration: 1e-11 of a force of 500 N over 1 cm and 300 steps.
    """
    until = 0.06 if exponent == 1.5 else 0.1 if damping < 1e3 else 0.15
    depth, rate, deepest, heat = damped(exponent, damping, full, until)
    parameters = {**HERTZ, "exponent": exponent, "damping": damping, "full_damping_penetration": full}
    values = []
    for h in (1e-3, 1.25e-4):
        run = impact(at_steps(h), until, **parameters)
        s = run.signal("pad", "penetration")
        spline = CubicSpline(run.times, s)(np.linspace(0, until, 20001)).max()
        values.append((s[-1], (s[-1] - s[-2]) / h, spline, run.signal("pad", "dissipated_energy")[-1]))
        assert np.abs(run.scene("energy_residual")).max() < 2e-8
        assert run.signal("pad", "contact_force").min() >= 0.0
    coarse, fine = np.array(values)
    exact = np.array((depth, rate, deepest, heat))
    assert depth < 0.0 < heat
    assert np.all(np.abs(coarse - exact) < 1e-3 * np.array((1e-2, SPEED, 1e-2, heat)))
    assert np.all(np.abs(fine - exact) < np.abs(coarse - exact) / 16 + 1e-10)


def test_the_last_damped_case_is_limited():
    """Control: without the limit at zero, damping would pull the ball in the third case above."""
    component, c = contact(damping=5000.0, full_damping_penetration=2e-3, exponent=1.0, **REFERENCE)
    u = inputs(component, port_motion(), port_motion((0, 0, -1e-3), velocity=(0, 0, 0.5)))
    x = component.initial(c, u)
    assert component.observe(c, x, u)[1] == 0.0
    assert REFERENCE["reference_force"] - 5000.0 * 0.5 * 0.5 < 0.0


REFERENCE = {name: HERTZ[name] for name in ("reference_force", "reference_penetration")}


def contact(mode="mean", normal=(0.0, 0.0, 1.0), **values):
    return made(Contact, mode, {"normal": normal}, **values)


def collision(h, end_time=0.2):
    """A ball that a tumbling paddle hits; both float free."""
    spin, velocity = np.array((0.2, 1.0, -0.1)), np.array((0.1, 0.0, 0.05))
    parts = [
        rigid(
            "paddle", 20.0, (3.0, 4.0, 5.0), {"face": (0.6, 0.1, 0.05)},
            initial_velocity=tuple(velocity), initial_angular_velocity=tuple(spin),
        ),
        rigid("ball", 5.0, (0.1, 0.1, 0.1), {"point": (0, 0, 0)}, initial_position=(0.7, 0.05, 0.03)),
        Part("pad", "contact", {"normal": (0.1, 0.0, -1.0)}, {**HERTZ, "gap": 0.01, "reference_force": 30.0}),
    ]  # fmt: skip
    links = between("pad", "paddle.face", "ball.point")
    return completed(end_time, parts, links, settings=at_steps(h), iteration=TIGHT)


def test_a_turning_plane_keeps_momenta_and_energy():
    """Conservation laws of two free bodies: momenta to the iteration's 1e-11, energy to second order in the step."""
    rests = []
    for h in (2e-3, 1e-3):
        run = collision(h)
        depth = run.signal("pad", "penetration")
        assert depth[0] < 0.0 < depth.max()
        assert depth[-1] < 0.0
        for name in ("linear_momentum", "angular_momentum"):
            both = [run.signal(body, name) for body in ("paddle", "ball")]
            total = both[0] + both[1]
            assert np.abs(total - total[0]).max() < 1e-10 * max(np.abs(b).max() for b in both)
            assert np.ptp(both[0], axis=0).max() > 1e-2
        rests.append(np.abs(run.scene("energy_residual")).max())
    assert rests[0] < 1e-5 * run.signal("paddle", "kinetic_energy")[0]
    assert rests[1] < 0.5 * rests[0]


@given(
    start=SMALL,
    change=SMALL,
    slide=THREE,
    exponent=st.sampled_from((1.0, 1.5, 3.3)),
    damping=st.sampled_from((0.0, 5.0, 1e5)),
    h=st.sampled_from((1e-4, 1.0)),
)
def test_work_is_what_is_stored_and_lost(start, change, slide, exponent, damping, h):
    """Passivity: work taken = potential gained + heat; heat and force are never negative, at any step.

    Round-off: of the larger of both energies, and of positions of order one under the force.
    """
    component, c = contact(
        normal=(0, 3.0, 4.0), gap=0.1, reference_penetration=0.1, reference_force=10.0, exponent=exponent,
        damping=damping, full_damping_penetration=0.2,
    )  # fmt: skip
    normal = np.array((0, 0.6, 0.8))
    across = np.array(slide) - normal * (normal @ slide)
    u0 = inputs(component, port_motion(), port_motion((0.1 - start) * normal))
    u1 = inputs(component, port_motion(slide), port_motion((0.1 - start - change) * normal + slide + across))
    x0 = component.initial(c, u0)
    x1 = component.step(c, x0, u1, h)
    before, after = component.observe(c, x0, u0), component.observe(c, x1, u1)
    assert (before[0], after[0]) == pytest.approx((start, start + change), abs=1e-14)
    y = component.outputs(c, x1, u1)
    force = wrenches(y, 2)[0][1] @ normal
    gained, heat = after[2] - before[2], after[3]
    round_off = 1e-14 * (before[2] + after[2] + force)
    assert force >= 0.0
    assert heat >= 0.0
    assert work(y, u0, u1, 2) + gained + heat == pytest.approx(0.0, abs=round_off)
    if damping == 0.0:
        assert heat == 0.0


@given(a=st.floats(-2, 2), width=st.floats(-1, 1), scale=st.sampled_from((1.0, 1e-3, 1e-6, 0.0)))
def test_means_of_power_and_rise(a, width, scale):
    """Definition: means over an interval of any size, by quadrature split at the kinks."""
    b = a + scale * width
    kinks = [k for k in (0.0, 1.0) if min(a, b) < k < max(a, b)]

    def mean(function):
        if a == b:
            return function(a)
        ends = [a, *sorted(kinks, reverse=a > b), b]
        return sum(quad(function, *part, epsabs=0, epsrel=1e-12)[0] for part in pairwise(ends)) / (b - a)

    for exponent in (1.0, 1.5, 2.2, 4.0):
        exact = mean(lambda s, e=exponent: max(s, 0.0) ** e)
        assert mean_power(a, b, exponent) == pytest.approx(exact, rel=1e-11, abs=1e-30)
    exact = mean(lambda s: np.clip(s, 0, 1) ** 2 * (3 - 2 * np.clip(s, 0, 1)))
    assert mean_rise(a, b) == pytest.approx(exact, rel=1e-11, abs=1e-30)


def test_end_point_force_of_a_turning_plane():
    """Definition: the force of the penetration and of its rate, which is a difference of penetrations."""
    component, c = contact(
        "endpoint", (0.2, 0.3, 1.0), gap=0.4, damping=3e4, full_damping_penetration=0.5, **REFERENCE
    )
    spin, speed, turn = np.array((0.3, -0.4, 0.2)), np.array((0.1, 0.2, -0.5)), np.array((0.1, 0.2, -0.1))

    def at(t):
        there = (Rotation.from_rotvec(t * spin) * Rotation.from_rotvec(turn)).as_rotvec()
        return inputs(
            component,
            port_motion((0, 0, 0.1 * t), there, (0, 0, 0.1), spin),
            port_motion(np.array((0.5, -0.2, 0.1)) + t * speed, velocity=speed),
        )

    u = at(0.0)
    x = component.initial(c, u)
    h = 1e-5
    depths = [component.observe(c, x, at(t))[0] for t in (-h, 0.0, h)]
    rate = (depths[2] - depths[0]) / (2 * h)
    assert 0.0 < depths[1] < 0.5
    part = depths[1] / 0.5
    elastic = REFERENCE["reference_force"] * (depths[1] / 1e-3) ** 1.5
    damping = 3e4 * part**2 * (3 - 2 * part) * rate
    seen = component.observe(c, x, u)
    assert seen[1] == pytest.approx(elastic + damping, rel=1e-8)
    assert seen[2] == pytest.approx(0.4 * elastic * depths[1], rel=1e-12)
    assert component.rates(c, x, u)[0] == pytest.approx(damping * rate, rel=1e-7)
    y = component.outputs(c, x, u)
    assert resultant(y, u, u, 2, (1.0, 2.0, 3.0)) == pytest.approx(
        np.zeros(6), abs=1e-14 * np.abs(y).max() * 10
    )
    direction = Rotation.from_rotvec(turn).apply(np.array((0.2, 0.3, 1.0)) / np.sqrt(1.13))
    assert y[6:9] == pytest.approx(seen[1] * direction, rel=1e-12)
    assert y[9:] == pytest.approx(np.zeros(3))
