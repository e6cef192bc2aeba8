"""Wrenches of a hinge with slopes and without: their work, their momentum, their order."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from components.contract.ports import PortMoments
from components.hinge import Hinge
from components.numerics.relative_motion import Passage, turn_between
from tests.references.relative_motion import (
    angular_momentum,
    inputs,
    port_motion,
    resultant,
    slope_work,
    slopes,
    with_moments,
    work,
)
from tests.unit.components.hinge.hinge_cases import HARNESS, hinge, observed
from tests.unit.components.hinge.test_work import MECHANISM

SMALL = st.floats(-0.02, 0.02)
THREE = st.tuples(SMALL, SMALL, SMALL)
MOMENTS = st.tuples(THREE, THREE, THREE, THREE)
TABLE = {
    "latch": "table",
    "latch_deflection": (-2.0, -0.5, 0.0, 0.5, 2.0),
    "latch_torque": (-60.0, -8.0, 0.0, 8.0, 60.0),
}
LATCHES = [{"latch": "none"}, {"latch": "spring"}, TABLE]


def moments_of(values):
    return np.array(values).reshape(2, 6)


def pushed(component, place, turn, moments, inboard=(0.0, 0.0, 0.0), command=1.0):
    """Inputs: inboard port somewhere, not turned; outboard port turned about the axis."""
    u = inputs(component, port_motion(inboard), port_motion(place, (0.0, turn, 0.0)), latch_command=command)
    return with_moments(component, u, moments_of(moments))


@pytest.mark.parametrize("order", [2.0, 4.0])
@pytest.mark.parametrize("latch", LATCHES, ids=lambda latch: latch["latch"])
@given(
    turns=st.tuples(*[st.floats(-1.2, 1.2)] * 3),
    places=st.tuples(THREE, THREE, THREE),
    bases=st.tuples(THREE, THREE, THREE),
    moments=st.tuples(MOMENTS, MOMENTS),
)
def test_work_is_the_change_of_energy(latch, order, turns, places, bases, moments):
    """Work of means and slopes + stored + heat = 0 to round-off, whatever the moments; all laws at once.

    The second step is damped by the roughness of the first.
    """
    component, c = hinge("mean", {**HARNESS, **latch}, **MECHANISM, order=order)
    still = np.zeros((4, 3))
    states = [
        pushed(component, place, turn, moment, base)
        for place, turn, base, moment in zip(places, turns, bases, (still, *moments), strict=True)
    ]
    x = component.step(c, component.initial(c, states[0]), states[1], 0.1)
    y = component.step(c, x, states[2], 0.1)
    before, after = observed(component, c, x, states[1]), observed(component, c, y, states[2])
    outputs = component.outputs(c, y, states[2])
    done = work(outputs, states[1], states[2], 2) + slope_work(component, outputs, states[2], 2)
    changes = {name: after[name] - before[name] for name in before}
    heat = changes["dissipated_energy"] + changes["numerical_dissipation"]
    scale = before["potential_energy"] + after["potential_energy"] + abs(heat)
    assert done + changes["potential_energy"] + heat == pytest.approx(0.0, abs=1e-12 * scale)
    if order == 4.0:  # of order 2 inertial terms give and take
        assert changes["numerical_dissipation"] >= 0.0
    assert changes["dissipated_energy"] >= 0.0


LARGE = st.floats(-1.0, 1.0)
ANY = st.tuples(LARGE, LARGE, LARGE)


@given(st.tuples(ANY, ANY), st.tuples(ANY, ANY), st.tuples(ANY, ANY, ANY, ANY), st.tuples(ANY, ANY), ANY, ANY)
def test_slopes_and_moments_are_adjoint(turns, gaps, moments, loads, swings, slopes_of_torque):
    """Virtual work of the slopes of loads, with what they add to the mean torque on the inboard port."""
    frames = [tuple(np.roll(Rotation.from_rotvec(turn).as_quat(), 1).tolist()) for turn in turns]
    passage = Passage(*frames, *gaps)
    ports = np.concatenate(moments).tolist()
    velocity, spin = passage.moments([PortMoments.read(ports[:6]), PortMoments.read(ports[6:])])
    zero = (0.0, 0.0, 0.0)
    mean, slope = passage.wrenches(zero, zero, loads[0], slopes_of_torque)
    done = np.dot(slope, ports) + np.dot(mean[3:6], turn_between(*frames))
    assert done == pytest.approx(np.dot(loads[0], velocity) + np.dot(slopes_of_torque, spin), abs=1e-12)


@given(st.tuples(ANY, ANY), st.tuples(LARGE, LARGE))
def test_turn_between_frames_is_that_of_a_difference(turns, vector):
    """Cayley: what a rotation adds to a vector is the turn x the mean of both."""
    rotations = [Rotation.from_rotvec(turn) for turn in turns]
    frames = [tuple(np.roll(r.as_quat(), 1).tolist()) for r in rotations]
    before, after = (r.apply((*vector, 0.3)) for r in rotations)
    turn = turn_between(*frames)
    scale = 1.0 + np.linalg.norm(turn)
    assert after - before == pytest.approx(np.cross(turn, 0.5 * (before + after)), abs=1e-13 * scale)
    assert turn_between(frames[0], tuple(-q for q in frames[1])) == pytest.approx(turn, abs=1e-14 * scale)


@pytest.mark.parametrize(("mode", "order"), [("mean", 2.0), ("mean", 4.0), ("endpoint", 2.0)])
@given(first=st.tuples(THREE, THREE), second=st.tuples(THREE, THREE), about=THREE, moments=MOMENTS)
def test_wrenches_give_no_momentum(mode, order, first, second, about, moments):
    """Conservation law over a step or at its end, both ports turning and moving; round-off of forces up to 1e3 N."""
    component, c = hinge(mode, {**HARNESS, "latch": "spring"}, **MECHANISM, order=order)
    before = inputs(
        component, port_motion(), port_motion((0.01, 0.02, -0.01), (0.1, 0.5, 0.0)), latch_command=1.0
    )
    after = inputs(
        component,
        port_motion(first[0], 10 * np.array(first[1]), 50 * np.array(second[1]), 50 * np.array(first[0])),
        port_motion(second[0], 10 * np.array(second[1]), 50 * np.array(first[1]), 50 * np.array(second[0])),
        latch_command=1.0,
    )
    if mode == "mean":
        after = with_moments(component, after, moments_of(moments))
    y = component.step(c, component.initial(c, before), after, 0.1)
    outputs = component.outputs(c, y, after)
    if order == 2.0:
        total = resultant(outputs, before if mode == "mean" else after, after, 2, about)
        assert total == pytest.approx(np.zeros(6), abs=1e-12)
        return
    total = angular_momentum(component, outputs, before, after, 2, about)
    assert total == pytest.approx(np.zeros(6), abs=1e-12)
    force, _ = slopes(component, outputs, 2)
    assert force.sum(0) == pytest.approx(np.zeros(3), abs=1e-12)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
PATH = {
    **{key: value for key, value in MECHANISM.items() if not key.startswith("friction")},
    "order": 4.0,
}


def passing(t):
    """Places, angle and their rates of a smooth motion; the inboard port only moves along."""
    a = np.array((0.02 * np.sin(t), 0.01 * np.cos(2.0 * t), -0.015 * t))
    va = np.array((0.02 * np.cos(t), -0.02 * np.sin(2.0 * t), -0.015))
    b = np.array((0.01 * np.cos(3.0 * t), 0.01 * t * t, 0.02 * np.sin(2.0 * t)))
    vb = np.array((-0.03 * np.sin(3.0 * t), 0.02 * t, 0.04 * np.cos(2.0 * t)))
    return a, va, b, vb, 0.3 + 0.2 * np.sin(2.0 * t), 0.4 * np.cos(2.0 * t)


def moving(component, t, h, latched=1.0):
    """Inputs at t, with the exact moments of the step of size h that ends there."""
    a, va, b, vb, turn, rate = passing(t)
    u = inputs(
        component,
        port_motion(a, velocity=va),
        port_motion(b, (0.0, turn, 0.0), vb, (0.0, rate, 0.0)),
        latch_command=latched,
    )
    if h == 0.0:
        return u
    moments = np.zeros((2, 6))
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        _, va, _, vb, _, rate = passing(t - 0.5 * h + 0.5 * h * node)
        moments[0, :3] += 0.5 * h * weight * node * va
        moments[1, :3] += 0.5 * h * weight * node * vb
        moments[1, 4] += 0.5 * h * weight * node * rate
    return with_moments(component, u, moments)


def wrench_errors(h, structure):
    """Largest errors of mean and slope (2,) of outboard force and torque over one second, against every instant."""
    component, c = hinge("mean", structure, **PATH)
    instant, d = hinge("endpoint", structure, **{**PATH, "order": 2.0, "latch_automatic": 0.0})
    x = component.initial(c, moving(component, 0.0, 0.0))
    now = instant.initial(d, moving(instant, 0.0, 0.0))
    now = instant.update(d, now, moving(instant, 0.0, 0.0), True)
    errors = np.zeros((2, 2))
    for k in range(round(1.0 / h)):
        u = moving(component, (k + 1) * h, h)
        x = component.step(c, x, u, h)
        y = component.outputs(c, x, u)
        exact = np.zeros((2, 6))
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            wrench = instant.outputs(d, now, moving(instant, (k + 0.5 + 0.5 * node) * h, 0.0))[6:12]
            exact[0] += 0.5 * weight * wrench
            exact[1] += 1.5 * weight * node * wrench
        force, torque = slopes(component, y, 2)
        found = np.array((y[6:12], np.concatenate((force[1], torque[1]))))
        errors = np.maximum(errors, np.abs(found - exact).reshape(2, 2, 3).max(2))
    return errors


@pytest.mark.parametrize(
    "structure",
    [{"harness_angle": (-2.0, 2.0), "harness_torque": (0.5, -0.5), "latch": "spring"}, TABLE],
    ids=["linear", "table"],
)
def test_mean_and_slope_are_of_order_four_and_three(structure):
    """Along a prescribed path with exact moments: the errors of the mean go with h^4, of the slope with h^3.

    Beside linear laws the mean is exact, up to the rounding of divided differences.
    """
    errors = np.array([wrench_errors(h, structure) for h in (0.1, 0.05, 0.025)])
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.all((orders[:, 0] > 3.5) | (errors[1:, 0] < 1e-10))
    assert np.all(orders[:, 1] > 2.5)


@given(MOMENTS, st.tuples(ANY, ANY))
def test_order_two_takes_no_note_of_moments(moments, motions):
    """The parameter's start: same bits, and slopes zero."""
    component, c = hinge("mean", {**HARNESS, "latch": "spring"}, **MECHANISM)
    u = inputs(component, port_motion(motions[0]), port_motion((0.01, 0.0, 0.0), motions[1]))
    x = component.initial(c, u)
    v = with_moments(component, u, moments_of(moments))
    plain, fed = component.step(c, x, u, 0.01), component.step(c, x, v, 0.01)
    assert plain.tobytes() == fed.tobytes()
    force, torque = slopes(component, component.outputs(c, fed, v), 2)
    assert not force.any()
    assert not torque.any()


@pytest.mark.parametrize("special", ["static", "impulse"])
def test_static_solutions_and_impulses_have_no_slopes(special):
    """As at order 2, and what is remembered of them damps nothing."""
    weight = {"end_weight": 1.0} if special == "static" else {}
    loads = []
    for order in (2.0, 4.0):
        component, c = hinge("mean", {"latch": "spring"}, **MECHANISM, **weight, order=order)
        x = component.initial(c, pushed(component, (0.0, 0.0, 0.0), 0.1, np.zeros((4, 3)), command=0.0))
        u = pushed(component, (0.01, 0.0, 0.0), 0.2, np.full((4, 3), 0.01))
        u[component.input_layout["impulse"]] = special == "impulse"
        x = component.step(c, x, u, 0.01)
        loads.append(component.outputs(c, x, u))
    assert np.array_equal(*loads)
    assert [memory.roughness for memory in Hinge.states.read(x).memories] == [0.0] * 6
    assert not np.any(slopes(component, loads[1], 2))


def test_an_end_point_hinge_has_no_slopes():
    component, c = hinge("endpoint", order=4.0)
    assert not any(name.endswith(("_slope", "_moment")) for name in component.output_layout.scalar_names())
    assert not c.paired
