"""The workless pair of one coordinate: work of its potential, order 4, and what numerical damping does."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components.numerics.fourth_order_correction import remembered_path, workless_law, workless_spring
from components.numerics.laws import Linear, SlackSpring, Table
from components.numerics.stiff_coordinate import Memory, StepMotion

LAWS = {
    "linear": Linear(300.0, 0.02),
    "strand": SlackSpring(500.0, 10.0),
    "hardening": Table((-0.3, -0.1, 0.0, 0.1, 0.3), (90.0, 12.0, 0.0, -12.0, -90.0)),
}
NUMBER = st.floats(-0.2, 0.2)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@given(NUMBER, NUMBER, NUMBER, st.floats(0.0, 1.0))
def test_work_is_the_change_of_potential_and_the_heat(law, start, end, moment, roughness):
    """Exact: means on changes, slopes on moments; differences below 1e-5 take the force at the middle."""
    motion = StepMotion(start, end, 1e-2, Memory(0.0, 0.0), moment)
    load = workless_law(law, 2.0, motion, roughness)
    work = load.force * (end - start) + load.slope * moment
    stored = law.potential(end) - law.potential(start)
    assert work == pytest.approx(-stored - load.heat - load.numerical, abs=1e-12 * (1.0 + load.heat))
    assert load.heat >= 0.0
    assert load.numerical >= 0.0


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@given(NUMBER, NUMBER)
def test_tangent_is_the_divided_difference(law, start, end):
    """Definition, where a difference of forces has digits left."""
    if abs(end - start) > 1e-4:
        expected = (law.value(start) - law.value(end)) / (end - start)
        assert law.tangent(start, end) == pytest.approx(expected, abs=1e-9)
    assert law.tangent(start, end) == pytest.approx(law.tangent(end, start), abs=1e-12)


@pytest.mark.parametrize("s", [-0.4, -0.1, 0.0, 0.05, 0.35])
def test_tangent_at_one_point_is_the_derivative(s):
    """Central differences of a cubic, at breaks too, where the slope is continuous."""
    law = LAWS["hardening"]
    expected = (law.value(s - 1e-4) - law.value(s + 1e-4)) / 2e-4
    for end in (s, s + 1e-8):
        assert law.tangent(s, end) == pytest.approx(expected, rel=2e-3)


def swinging(angle, steps, start=(1.0, 0.0), damped=True):
    """Place and rate (in radians a step) of a unit mass on a spring of w h = angle after steps of size 1."""
    place, rate = start
    memory, states, rough = Memory(rate, rate), [start], []
    for _ in range(steps):
        motions = []

        def rest(u, place=place, rate=rate, memory=memory, motions=motions):
            change, moment = rate + 0.5 * u[0] - u[1] / 6.0, u[0] / 6.0
            motions[:] = [StepMotion(place, place + change, 1.0, memory, moment)]
            load = workless_spring(angle**2, 0.0, motions[0])
            return np.array((load.force - u[0], load.slope - u[1]))

        free = rest(np.zeros(2))
        matrix = np.stack([rest(e) - free for e in np.eye(2)], axis=1)
        u = np.linalg.solve(matrix, -free)
        rest(u)
        place, rate = motions[0].end, rate + u[0]
        memory = remembered_path(motions[0])
        rough.append(memory.roughness)
        if not damped:
            memory = memory._replace(roughness=0.0)
        states.append((place, rate))
    return np.array(states), np.array(rough)


@pytest.mark.parametrize("start", [(1.0, 0.0), (0.3, 0.7)])
def test_a_resolved_vibration_is_of_order_four(start):
    """Closed form, after ten radians: errors fall by 2^4 from 80 to 320 steps, numerical damping included."""
    errors = []
    for steps in (80, 160, 320):
        angle = 10.0 / steps
        states, _ = swinging(angle, steps, (start[0], start[1] * angle))
        errors.append(abs(states[-1, 0] - start[0] * np.cos(10.0) - start[1] * np.sin(10.0)))
    assert errors[0] < 2e-5
    assert np.log2(errors[0] / errors[2]) / 2.0 > 3.9


@pytest.mark.parametrize("angle", [0.01, 0.3, 3.0, 300.0])
def test_the_energy_is_kept_and_only_ever_damped(angle):
    states, _ = swinging(angle, 200, damped=False)
    energy = 0.5 * (angle**2 * states[:, 0] ** 2 + states[:, 1] ** 2)
    assert energy == pytest.approx(energy[0], rel=1e-9)
    states, rough = swinging(angle, 200)
    energy = 0.5 * (angle**2 * states[:, 0] ** 2 + states[:, 1] ** 2)
    assert np.all(np.diff(energy) <= 1e-12 * energy[0])
    assert np.all((rough >= 0.0) & (rough <= 1.0))


@pytest.mark.parametrize(("angle", "left"), [(0.3, 0.9999999), (1.0, 0.999), (5.0, 1e-5), (10.0, 1e-9)])
def test_damping_takes_what_is_not_resolved(angle, left):
    """Vibration of 50 steps: untouched up to w h = 1, gone from w h = 5 on."""
    states, _ = swinging(angle, 50, (0.0, 1.0))
    energy = angle**2 * states[-1, 0] ** 2 + states[-1, 1] ** 2
    assert energy > left if angle <= 1.0 else energy < left
