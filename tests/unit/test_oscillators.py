"""Exact propagators against the matrix exponential, and the heat against the energy balance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from components._oscillators import propagator

FREQUENCY = st.floats(-1.0, 5.5).map(lambda e: 10.0**e)
STEP = st.floats(-6.0, -1.0).map(lambda e: 10.0**e)
DAMPING = st.one_of(st.floats(0.0, 3.0), st.sampled_from((0.0, 1.0, 1.0 - 1e-9, 1.0 + 1e-9)))
EPS = np.finfo(float).eps


def matrix(p):
    """Transition of (w eta, v, Q / w), all of one unit."""
    return np.array([[p.a11[0], p.a12[0], p.b1[0]], [p.a21[0], p.a22[0], p.b2[0]]])


def scaled(w, table):
    return table * np.array([[1.0, w, w * w], [1.0 / w, 1.0, w]])


@given(FREQUENCY, DAMPING, STEP)
def test_propagator_is_the_matrix_exponential(w, zeta, h):
    """Independent library (SciPy's expm) for under-, over- and critically damped modes.

    Scaled to one unit all entries are at most of order one. Squaring in expm costs some eps (1 + w h). Close to
    critical damping the two roots differ by a root of eps w, where the difference quotient loses eps / gap.
    """
    p = propagator(np.array([w]), np.array([zeta]), h)
    generator = np.array([[0.0, w, 0.0], [-w, -2.0 * zeta * w, w], [0.0, 0.0, 0.0]])
    expected = expm(h * generator)[:2]
    gap = abs(np.emath.sqrt(zeta**2 - 1.0)) * w * h
    loss = EPS * max(1.0, zeta * w * h) / max(gap, 1e-6) * min(1.0, w * h)
    assert scaled(w, matrix(p)) == pytest.approx(
        expected, abs=200 * EPS * (1 + w * h * (1 + zeta)) + 20 * loss
    )


@given(FREQUENCY, DAMPING, STEP)
def test_force_response_is_accurate_for_small_steps(w, zeta, h):
    """Closed form of the series: b1 = h^2/2 - zeta w h^3/3 + ..., relative error below 1e-9 where w h is small.

    Either formula is worst at the switch w h = 1e-3: the next term of the series is (w h)^3 / 10, the
    difference 1 - a11 = (w h)^2 / 2 carries 2 eps / (w h)^2.
    """
    angle = min(w * h, 0.01)
    b1 = propagator(np.array([angle / h]), np.array([zeta]), h).b1[0]
    terms = [1.0, -2 * zeta]  # y_{n+2} = -2 zeta y_{n+1} - y_n of the unit step's derivatives
    while len(terms) < 12:
        terms.append(-2 * zeta * terms[-1] - terms[-2])
    powers = np.cumprod([0.5, *(angle / (n + 3) for n in range(11))])
    assert b1 == pytest.approx(h * h * float(np.array(terms) @ powers), rel=1e-8)


@given(FREQUENCY, DAMPING, STEP, st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1))
def test_heat_closes_the_energy_balance(w, zeta, h, stretch, velocity, force):
    """Conservation law: kinetic + elastic + heat = work of the held force, to round-off of the energies."""
    p = propagator(np.array([w]), np.array([zeta]), h)
    eta, v, q = np.array([stretch / w]), np.array([velocity]), np.array([force * w])
    eta1, v1 = p.a11 * eta + p.a12 * v + p.b1 * q, p.a21 * eta + p.a22 * v + p.b2 * q
    heat = p.dissipated(eta, v, q)
    before, after = (0.5 * float((b**2 + (w * a) ** 2)[0]) for a, b in ((eta, v), (eta1, v1)))
    work = float((q * (eta1 - eta))[0])
    assert heat >= -1e-12
    assert before + work - after == pytest.approx(heat, abs=2e-11)


@given(FREQUENCY, st.floats(0.0, 0.9), STEP)
def test_two_half_steps_make_one(w, zeta, h):
    """Semigroup property of an exact propagator."""
    half, whole = (propagator(np.array([w]), np.array([zeta]), s) for s in (0.5 * h, h))
    a, b = scaled(w, matrix(half))[:, :2], scaled(w, matrix(half))[:, 2]
    twice = np.column_stack((a @ a, a @ b + b))
    assert twice == pytest.approx(scaled(w, matrix(whole)), abs=1e-13 * (1 + w * h) / np.sqrt(1 - zeta**2))


def test_no_modes():
    """A rigid body has none: empty arrays, no heat."""
    none = np.zeros(0)
    p = propagator(none, none, 0.1)
    assert p.b1.size == 0
    assert p.dissipated(none, none, none) == 0.0
