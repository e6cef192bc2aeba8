"""Order of the coupling in one dimension: a beam, exact in time, whose root is held by one law of stiffness.

The law alone is under test: the body, in closed form, and the law's two numbers meet in a Newton iteration.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from components.numerics.fourth_order_correction import remembered_path, workless_law, workless_spring
from components.numerics.laws import Law, Linear, mean_force
from components.numerics.stiff_coordinate import bushing_load, damped_load, remembered
from tests.references.held_beam import Beam, Path, coupled, energy, exact_means, integrated_means

BEAM = Beam.pinned_free()
SECONDS, SHORT = 0.125, 0.005
LATCH, STIFF, LOCK, WALL = 3e3, 1e6, 1e8, 1e10
"""N.m/rad. On the beam the last three swing on their own at 1.8, 17 and 170 kHz."""
FINE = 2.5e-4
"""The smallest step (s) of the design's table: w h is 1.2 in the highest mode of the beam."""
_SHORTEST = 5e-5


class Hardening:
    """Spring of moment 3000 s + 3e6 s^3: half of it from the cubic term where the beam turns farthest."""

    linear, cubic = LATCH, 3e6

    def value(self, s: float) -> float:
        """Moment at s."""
        return -(self.linear + self.cubic * s * s) * s

    def potential(self, s: float) -> float:
        """Energy at s."""
        return (0.5 * self.linear + 0.25 * self.cubic * s * s) * s * s

    def tangent(self, s0: float, s1: float) -> float:
        """Divided difference of the moment."""
        return self.linear + self.cubic * (s0 * s0 + s0 * s1 + s1 * s1)


def of_order_two(law: Law, h: float) -> Path:
    """The mean over both ends, and inertial terms that damp."""
    if isinstance(law, Linear):
        return run(law, h, lambda m: bushing_load(law.stiffness, 0.0, m), remembered)
    return run(law, h, lambda m: damped_load(mean_force(law, m.start, m.end), LATCH, 0.0, m), remembered)


def of_order_four(law: Law, h: float) -> Path:
    """The workless pair."""
    if isinstance(law, Linear):
        return run(law, h, lambda m: workless_spring(law.stiffness, 0.0, m), lambda m, _: remembered_path(m))
    return run(
        law, h, lambda m: workless_law(law, 0.0, m, m.memory.roughness), lambda m, _: remembered_path(m)
    )


def run(law, h, step_law, remember):
    return coupled(BEAM, start(law), step_law, remember, law.potential, h, steps_of(h))


def steps_of(h):
    return round((SECONDS if h > _SHORTEST else SHORT) / h)


def start(law):
    return BEAM.start(law.tangent(0.0, 0.0))


@cache
def means(law, h):
    steps = steps_of(h)
    if isinstance(law, Linear):
        return exact_means(BEAM, law.stiffness, h, steps)
    return integrated_means(BEAM, start(law), law, h, steps)


def error(path, law, h):
    """Rms error of the step means over their rms."""
    exact = means(law, h)
    return float(np.sqrt(np.mean((path.means - exact) ** 2) / np.mean(exact**2)))


def errors(of_order, law, steps):
    return np.array([error(of_order(law, h), law, h) for h in steps])


def slopes(found):
    """Of errors at steps that halve."""
    return np.log2(found[:-1] / found[1:])


LAWS = {
    "latch spring": Linear(LATCH),
    "stiff joint": Linear(STIFF),
    "lock": Linear(LOCK),
    "hardening": Hardening(),
}


def test_frequencies_of_the_beam():
    """Closed form: the elastic modes of a pinned-free beam, 33.6 from first to last; as high as in the design."""
    elastic = BEAM.frequency[1:] / (2.0 * np.pi)
    assert elastic[-1] == pytest.approx(783.0, rel=1e-3)
    assert elastic[-1] / elastic[0] == pytest.approx((22.776547 / 3.926602) ** 2, rel=1e-9)


@pytest.mark.parametrize("law", [LAWS["latch spring"], LAWS["hardening"]], ids=["latch spring", "hardening"])
def test_order_four_where_steps_resolve_the_vibration(law):
    """Exact solutions: sixteen times less error with every halving, once w h is 1.2 at the most."""
    assert np.all(slopes(errors(of_order_four, law, (5e-4, 2.5e-4, 1.25e-4))) >= 3.5)


@pytest.mark.parametrize(("name", "step"), [("stiff joint", 1.25e-4), ("lock", 1e-5)])
def test_order_four_where_steps_resolve_the_joint(name, step):
    """The same with w h of 1.4 and 0.7, 1.1 and 0.5 in the mode of the joint or lock itself."""
    assert np.all(slopes(errors(of_order_four, LAWS[name], (step, 0.5 * step))) >= 3.5)


def test_order_two_where_no_step_resolves_the_joint():
    """Beside a joint like a wall, at w h of 40 and more in its own mode: the pair is of order 2, the other of order 1.

    The pair keeps the ends and the mean of s at zero then. What a linear wrench leaves out of the wanted u,
    u2 P2 with u2 = h^2 u''/12, would bend s by a mean of -u2 h^2 / (60 M); keeping it at zero costs the mean wrench a
    fifth of u2, in closed form for a rigid body.
    """
    law, steps = Linear(WALL), (5e-4, 2.5e-4, 1.25e-4)
    two, four = errors(of_order_two, law, steps), errors(of_order_four, law, steps)
    assert np.all(four <= 0.1 * two)
    assert np.all(np.abs(slopes(two) - 1.0) < 0.3)
    assert np.all(np.abs(slopes(four) - 2.0) < 0.4)


def test_what_a_wall_costs_is_known():
    """The closed form of the above, -h^2 u''/60, on the flexible beam at the smallest step, where it prevails."""
    h = 0.5 * FINE
    lost = of_order_four(Linear(WALL), h).means - means(Linear(WALL), h)
    bent = np.diff(means(Linear(WALL), h), 2)
    expected = -bent / 60.0
    assert np.linalg.norm(lost[1:-1] - expected) < 0.2 * np.linalg.norm(expected)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_far_less_error_at_equal_steps(law):
    """Beside order 2 at the smallest step of the table; both sum up what numerical damping takes."""
    assert errors(of_order_four, law, [FINE])[0] <= 0.1 * errors(of_order_two, law, [FINE])[0]


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("h", [4e-3, 1e-3, FINE])
def test_energy_is_exact(law, h):
    """Conservation at any step, resolved or not: beam, law and what numerical damping takes add up.

    To round-off: torques of a lock of 1e8 N.m/rad round to 1e-8 N.m and move by less than 1e-3 rad in each of a few
    hundred steps, 1e-8 of the energy at most. Damping only takes.
    """
    path, whole = of_order_four(law, h), energy(BEAM, np.zeros_like(BEAM.rotation), start(law))
    assert path.residual < 1e-8 * whole
    assert 0.0 <= path.heat < 1e-2 * whole
