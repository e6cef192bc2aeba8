"""Friction of a rail that sticks, in two dimensions: energy, straight motion, sticking, sliding, rest under a load."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from components.numerics.fourth_order_correction import workless_spring
from components.numerics.presliding import step_force
from components.numerics.stiff_coordinate import Memory, StepMotion
from components.rail import Rail
from tests.references.relative_motion import inputs, port_motion, with_moments
from tests.unit.components.prepared import prepared
from tests.unit.components.test_rail import FRICTION, MASS, slid

SIGNED = st.floats(-1.0, 1.0)
TWO = st.tuples(SIGNED, SIGNED)
ANGLE = st.floats(0.0, 2.0 * np.pi)
FREE = {"normal_stiffness": 0.0, "rotational_stiffness": 0.0}
STEP = 0.1


class Trolley:
    """A rail that does nothing but rub; places, forces and deflections are vectors of its plane."""

    def __init__(self, mode="mean", order=4.0, **start):
        self.component = Rail(wrench_mode=mode)
        self.c = prepared(self.component, **{**FREE, "order": order, **start})
        self.place = np.zeros(2)
        self.x = self.component.initial(self.c, self.inputs())

    def inputs(self, moment=(0.0, 0.0), velocity=(0.0, 0.0), **commands):
        u = inputs(self.component, port_motion((*self.place, 0.0), velocity=(*velocity, 0.0)), **commands)
        if self.component.endpoint:
            return u
        return with_moments(self.component, u, np.array([[*moment, 0.0, 0.0, 0.0, 0.0]]))

    def move(self, change, moment=(0.0, 0.0), h=STEP, **commands):
        """Mean force over a step and its slope."""
        self.place = self.place + change
        u = self.inputs(moment, **commands)
        self.x = self.component.step(self.c, self.x, u, h)
        y = self.component.outputs(self.c, self.x, u)
        return y[:2], y[-6:-4]

    def outputs(self, velocity=(0.0, 0.0)):
        return self.component.outputs(self.c, self.x, self.inputs(velocity=velocity))[:2]

    def rates(self, velocity=(0.0, 0.0)):
        return self.component.rates(self.c, self.x, self.inputs(velocity=velocity))

    def seen(self, name):
        u = self.inputs()
        return float(self.component.observe(self.c, self.x, u)[self.component.observation_layout[name]][0])


def direction(angle):
    return np.array((np.cos(angle), np.sin(angle)))


@given(
    st.tuples(*(st.floats(0.0, 1.0),) * 3), ANGLE, st.floats(0.0, 1.0), TWO, TWO, st.floats(-2.0, 2.0),
    st.floats(1e-3, 1.0),
)  # fmt: skip
@settings(max_examples=300)
def test_no_step_makes_energy(numbers, angle, part, change, moment, size, h):
    """Work = energy of the spring + heat, and heat >= 0, to round-off, from any deflection along any path."""
    friction, limit, speed = 1e-3 + 10.0 * numbers[0], 1e-3 + numbers[1], 1e-3 + 10.0 * numbers[2]
    trolley = Trolley(friction_force=friction, breakaway_deflection=limit, stiction_velocity=speed)
    trolley.move(part * limit * direction(angle))
    stored, lost = trolley.seen("potential_energy"), trolley.seen("friction_energy")
    change, moment = limit * 10.0**size * np.array(change), limit * 10.0**size * np.array(moment)
    force, slope = trolley.move(change, moment, h)
    stored, lost = trolley.seen("potential_energy") - stored, trolley.seen("friction_energy") - lost
    way = np.abs(change).sum() + 6.0 * np.abs(moment).sum()
    k, c = friction / limit, friction / speed
    round_off = 1e-14 * (
        k * (limit + way) ** 2 + friction * way + c * way**2 / h + friction * limit**2 / speed
    )
    assert -(force @ change) - slope @ moment == pytest.approx(stored + lost, abs=round_off)
    assert lost >= -round_off
    assert trolley.seen("potential_energy") <= 0.5 * friction * limit * (1.0 + 1e-9)


@given(ANGLE, SIGNED, SIGNED, SIGNED, st.floats(-2.0, 1.0))
def test_straight_motion_is_the_law_of_one_dimension(angle, start, change, moment, size):
    """`step_force` along the motion, with mean, slope, deflection and heat, and nothing across it."""
    limit, along = 0.02, direction(angle)
    trolley = Trolley(friction_force=3.0, breakaway_deflection=limit, stiction_velocity=0.5)
    trolley.move(start * limit * along)
    lost = trolley.seen("friction_energy")
    change, moment = limit * 10.0**size * change, limit * 10.0**size * moment
    loads = trolley.move(change * along, moment * along, 0.01)
    law = step_force(3.0 / limit, 6.0, 3.0, start * limit, change, 0.01, moment=moment)
    for vector, expected in zip(loads, (law.force, law.slope), strict=True):
        assert vector == pytest.approx(expected * along, abs=1e-11)
    assert trolley.seen("potential_energy") == pytest.approx(75.0 * law.deflection**2, abs=1e-13)
    assert trolley.seen("friction_energy") - lost == pytest.approx(law.heat, abs=1e-13)


@given(TWO, TWO, TWO)
def test_while_it_sticks_it_is_a_spring_and_a_damper_in_any_direction(start, change, moment):
    """Of order 4, component by component; spring and damper are each less than half of the friction."""
    limit, h, speed = 1.0, 0.1, 40.0
    trolley = Trolley(friction_force=5.0, breakaway_deflection=limit, stiction_velocity=speed)
    start, change, moment = 0.2 * np.array(start), 0.1 * np.array(change), 0.03 * np.array(moment)
    trolley.move(start, h=h)
    force, slope = trolley.move(change, moment, h)
    loads = [
        workless_spring(5.0, 5.0 / speed, StepMotion(z, z + d, h, Memory(0.0, 0.0), m))
        for z, d, m in zip(start, change, moment, strict=True)
    ]
    assert force == pytest.approx([load.force for load in loads], abs=1e-13)
    assert slope == pytest.approx([load.slope for load in loads], abs=1e-13)


def test_without_motion_it_holds_what_it_holds():
    """From any deflection the force of the spring, without a slope; an impulse does nothing and leaves it."""
    trolley = Trolley(friction_force=5.0, breakaway_deflection=0.1)
    for angle in np.linspace(0.0, 6.0, 7):
        trolley.move(0.2 * direction(angle), h=10.0)
        held = trolley.seen("potential_energy")
        force, slope = trolley.move((0.0, 0.0))
        assert force == pytest.approx(trolley.outputs(), abs=0.0)
        assert force @ force == pytest.approx(2.0 * held * 5.0 / 0.1, rel=1e-12)
        assert slope == pytest.approx((0.0, 0.0), abs=0.0)
        force, _ = trolley.move((0.01, 0.02), impulse=1.0, h=1e-7)
        assert force == pytest.approx((0.0, 0.0), abs=0.0)
        assert trolley.seen("potential_energy") == pytest.approx(held, rel=1e-15)


@pytest.mark.parametrize("order", [2.0, 4.0])
@pytest.mark.parametrize("breakaway", [1e-4, 0.0])
def test_sliding_along_a_circle_loses_friction_times_the_way(order, breakaway):
    """Of 0.1 m radius in 200 steps, after a first turn; the force opposes the chord.

    A deflection lags behind the turn by L / r, which is 1e-3. Chords are shorter by 4e-5.
    """
    radius, count = 0.1, 200
    trolley = Trolley(order=order, friction_force=2.0, breakaway_deflection=breakaway)
    trolley.place = np.array((radius, 0.0))
    trolley.x = trolley.component.initial(trolley.c, trolley.inputs())
    turn = 2.0 * np.pi / count
    # of P1 with the velocity of a circle, along the inward normal of the chord
    first = (
        radius * (2.0 * np.sin(0.5 * turn) / turn * 2.0 - 2.0 * np.cos(0.5 * turn)) if order == 4.0 else 0.0
    )
    work = 0.0
    for i in range(2 * count):
        change = radius * (direction((i + 1) * turn) - direction(i * turn))
        moment = -first * direction((i + 0.5) * turn)
        force, slope = trolley.move(change, moment)
        if i >= count:
            work -= force @ change + slope @ moment
            assert force @ change < -(1.0 - 1e-5) * np.linalg.norm(force) * np.linalg.norm(change)
    assert work == pytest.approx(2.0 * 2.0 * np.pi * radius, rel=1e-4)


def test_it_turns_its_deflection_into_a_new_direction():
    """Closed form: the deflection's angle to a motion goes as tan(angle / 2) = e^(-way / L), from a right angle on.

    Its steps are of a twentieth of L, and err by less than a tenth of them.
    """
    trolley = Trolley(order=2.0, friction_force=1.0, breakaway_deflection=1.0, stiction_velocity=1e6)
    trolley.move((0.0, 1.0))
    for k in range(40):
        trolley.move((0.05, 0.0), h=1.0)
        angle = 2.0 * np.arctan(np.exp(-0.05 * (k + 1)))
        assert trolley.move((0.0, 0.0))[0] == pytest.approx(-direction(angle), abs=5e-3)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_a_load_below_the_friction_moves_nothing(order, angle):
    """0.9 of the friction, all at once: after a quarter of 1000 steps it has settled, and stays there to 1e-12 m.

    At first it swings beyond what friction holds, and slides by about as much as the contact gives way.
    """
    pull = 0.9 * FRICTION / MASS * direction(angle)
    start = {"gravity": (*pull, 0.0)}
    parts = {"friction_force": FRICTION, "breakaway_deflection": 1e-4, "stiction_velocity": 0.01}
    run = slid(8e-3, 8.0, start=start, order=order, **parts)
    place = run.signal("trolley", "frame_position")[:, :2]
    assert len(place) == 1001
    assert np.abs(place[250:] - place[-1]).max() < 1e-12
    assert place[-1] == pytest.approx(np.linalg.norm(place[-1]) * direction(angle), abs=1e-10)
    assert 0.9e-4 < np.linalg.norm(place[-1]) < 2.5e-4
    assert run.signal("rail", "friction_force_magnitude")[-1] == pytest.approx(0.9 * FRICTION, rel=1e-6)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_above_the_friction_it_slides(order, angle):
    """1.1 of the friction: from breaking away on, a tenth of the friction accelerates it."""
    start = {"gravity": (*(1.1 * FRICTION / MASS * direction(angle)), 0.0)}
    parts = {"friction_force": FRICTION, "breakaway_deflection": 1e-4, "stiction_velocity": 0.01}
    run = slid(8e-3, 4.0, start=start, order=order, **parts)
    speed, time = run.signal("rail", "sliding_speed")[50:], np.array(run.times)[50:]
    assert np.polyfit(time, speed, 1)[0] == pytest.approx(0.1 * FRICTION / MASS, rel=1e-8)
    assert np.ptp(speed - 0.1 * FRICTION / MASS * time) < 1e-9


def test_without_friction_there_is_none():
    """Whatever the deflection allowed; nothing divides by zero."""
    for breakaway in (0.0, 1e-4):
        trolley = Trolley(friction_force=0.0, breakaway_deflection=breakaway)
        force, slope = trolley.move((0.3, -0.1), (0.02, 0.01))
        assert not np.any((*force, *slope))
        assert trolley.seen("friction_force_magnitude") == trolley.seen("potential_energy") == 0.0


@pytest.mark.parametrize("parts", [1, 7])
def test_of_an_end_point_it_follows_the_trolley_in_any_parts(parts):
    """Explicit hosts: the force at a place and its heat do not depend on the steps that led there."""
    trolley = Trolley("endpoint", 2.0, friction_force=3.0, breakaway_deflection=0.01, stiction_velocity=2.0)
    for _ in range(parts):
        trolley.move(np.array((0.03, 0.04)) / parts)
    assert trolley.outputs() == pytest.approx((-1.8, -2.4), rel=1e-12)
    assert trolley.rates((0.3, 0.4)) == pytest.approx((1.5, 0.0), rel=1e-12)
    # at the limit, a motion back is damped; the spring gives back what it stores
    assert trolley.rates((-0.03, -0.04)) == pytest.approx((1.5 * 0.05**2, 0.0), rel=1e-9)
    trolley.place = trolley.place - (0.003, 0.004)
    assert trolley.outputs() == pytest.approx((-0.9, -1.2), rel=1e-12)
    assert trolley.outputs((0.2, 0.0)) == pytest.approx((-1.2, -1.2), rel=1e-12)
    x = trolley.component.update(trolley.c, trolley.x, trolley.inputs(), False)
    assert trolley.component.outputs(trolley.c, x, trolley.inputs())[:2] == pytest.approx(
        (-0.9, -1.2), rel=1e-12
    )
