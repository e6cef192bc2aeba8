"""Exact propagators against the matrix exponential, and the heat against the energy balance."""

import ctypes
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from components.numerics.oscillators import propagator
from fmus.native.compile import HERE, compile_files, compiler, suffix

FREQUENCY = st.floats(-1.0, 5.5).map(lambda e: 10.0**e)
STEP = st.floats(-6.0, -1.0).map(lambda e: 10.0**e)
DAMPING = st.one_of(st.floats(0.0, 3.0), st.sampled_from((0.0, 1.0, 1.0 - 1e-9, 1.0 + 1e-9)))
OVERDAMPED = st.floats(0.0, 6.0).map(lambda e: 10.0**e)
"""Stiffness-proportional damping of 1 % at 0.1 Hz makes a mode of 100 kHz 1e4 times critical."""
EPS = np.finfo(float).eps
NATIVE = ("a11", "a12", "a21", "a22", "b1", "w11", "w12", "w22", "c1", "c2", "d", "s1", "s2", "s3")
"""Fields of a propagator in C, in their order."""
POWERS = (-2.0, -1.0, -2.0, 0.0, -1.0, -2.0)
"""Of the frequency in the unit of the last six."""


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


def overdamped_in_sixty_digits(w, zeta, h):
    """a11, s, a21, a22 and b1 of a mode above critical damping, from both its roots."""
    with localcontext() as digits:
        digits.prec = 60
        w, zeta, h = Decimal(w), Decimal(zeta), Decimal(h)
        root = (zeta * zeta - 1).sqrt()
        slow, fast = w * (root - zeta), -w * (root + zeta)
        e1, e2, gap = (slow * h).exp(), (fast * h).exp(), slow - fast
        s = (e1 - e2) / gap
        a11 = (slow * e2 - fast * e1) / gap
        entries = (a11, s, -w * w * s, (slow * e1 - fast * e2) / gap, (1 - a11) / (w * w))
        return np.array([float(entry) for entry in entries])


def assert_overdamped(w, zeta, h, found):
    """Every entry to a relative 1e-12; a22 changes its sign and has no more than the round-off of both its terms.

    The exponent of the faster root has a round-off of eps fast h, as it decays: below 40 eps. b1 is
    truncated below zeta w h = 1e-3: its next term is (2 zeta w h)^3 / 60, 1.4e-10.
    """
    expected = overdamped_in_sixty_digits(w, zeta, h)
    # numbers below 1e-290 lose digits on the way to zero
    size = np.maximum(np.abs(expected), [0.0, 0.0, 0.0, abs(expected[0]) / zeta**2, 0.0]) + 1e-290
    assert np.all(np.abs(found - expected) <= np.array([1e-12, 1e-12, 1e-12, 1e-11, 2e-10]) * size)


@given(FREQUENCY, OVERDAMPED.filter(lambda z: z > 1.0), STEP)
def test_modes_far_above_critical_damping_are_accurate(w, zeta, h):
    """Closed form in sixty digits, up to a million times critical: no entry is a small difference of others."""
    p = propagator(np.array([w]), np.array([zeta]), h)
    assert_overdamped(w, zeta, h, np.array([p.a11[0], p.a12[0], p.a21[0], p.a22[0], p.b1[0]]))


@pytest.mark.skipif(compiler() is None, reason="no C compiler")
def test_the_native_twin_has_the_same_accuracy(tmp_path):
    """The same in C, and agreement of every field with Python below and above critical damping."""
    source, library = tmp_path / "twin.c", tmp_path / f"twin{suffix()}"
    source.write_text(
        f'#include "{HERE / "shared" / "oscillators.h"}"\n'
        "void mode(double w, double zeta, double h, double *y) {\n"
        "    Propagator p = propagator_at(y, 1);\n"
        "    propagator_mode(&p, 0, w, zeta, h);\n"
        "}\n",
        encoding="utf-8",
    )
    compile_files([source], library, ("-std=c99", "-O2", "-fPIC", f"-I{HERE}"))
    mode = ctypes.CDLL(str(library)).mode
    mode.argtypes, mode.restype = [ctypes.c_double] * 3 + [ctypes.c_void_p], None
    rng = np.random.default_rng(5)
    for exponent in rng.uniform([-1.0, -2.0, -6.0], [5.5, 6.0, -1.0], (600, 3)):
        w, zeta, h = (float(v) for v in 10.0**exponent)
        found = np.zeros(len(NATIVE))
        mode(w, zeta, h, found.ctypes.data)
        if zeta > 1.0:
            assert_overdamped(w, zeta, h, found[:5])
        p = propagator(np.array([w]), np.array([zeta]), h)
        expected = np.array([getattr(p, name)[0] for name in NATIVE])
        scale = np.array([1.0, 1.0 / w, w, 1.0, 1.0 / w**2, w * w, w, 1.0, *np.power(w, POWERS)])
        assert np.all(np.abs(found - expected) <= 1e-12 * scale)
        if w * h < 1.0:
            assert found[8:11] == pytest.approx(expected[8:11], rel=1e-11)


def slopes_in_many_digits(w, zeta, h):
    """c1, c2 and d by the power series of the impulse response, for frequencies and rates up to about 60 / h."""
    with localcontext() as digits:
        digits.prec = 100
        w, zeta, h = Decimal(w), Decimal(zeta), Decimal(h)
        derivatives, sums, power = [Decimal(1), -2 * zeta * w], [Decimal(0)] * 4, Decimal(1)
        for n in range(400):
            power *= h / (n + 1)
            term = derivatives[n] * power
            for k in range(4):
                sums[k] += term
                term *= h / (n + 2 + k)
            derivatives.append(-2 * zeta * w * derivatives[-1] - w * w * derivatives[-2])
        once, twice, thrice = (integral / h for integral in sums[1:])
        return [
            float(c)
            for c in (
                h * (2 * twice / h - once),
                2 * once - sums[0],
                h * (4 * (twice - thrice / h) / h - once),
            )
        ]


@given(FREQUENCY, st.one_of(DAMPING, OVERDAMPED), STEP)
def test_slope_responses_are_accurate_where_they_are_small(w, zeta, h):
    """Independent formulation, a power series in a hundred digits: relative accuracy where all three keep a sign.

    Above a radian a step c1 and c2 swing through zero: there of the size of the response they are part of.
    """
    w = min(w, 60.0 / (h * max(zeta, 1.0) * 2.0))
    p = propagator(np.array([w]), np.array([zeta]), h)
    expected = np.array(slopes_in_many_digits(w, zeta, h))
    size = np.abs(expected) + (np.array([1.0, w, 1.0]) / w**2 if w * h > 1.0 else 0.0)
    assert np.all(np.abs(np.array([p.c1[0], p.c2[0], p.d[0]]) - expected) <= 2e-12 * size)


@given(FREQUENCY, DAMPING, STEP)
def test_slope_responses_are_the_matrix_exponential(w, zeta, h):
    """Independent library (SciPy's expm) for a force that runs from -1 to 1 over the step; the moment by parts.

    With P1 = 2 t / h - 1 as a state, P1' = 2 / h, and the integral of eta: m = eta1 + eta0 - 2 mean(eta).
    """
    p = propagator(np.array([w]), np.array([zeta]), h)
    generator = np.zeros((5, 5))
    generator[:2, :2] = ((0.0, w), (-w, -2.0 * zeta * w))
    generator[1, 2], generator[2, 3], generator[4, 0] = w, 2.0 / h, 1.0 / h
    end = expm(h * generator) @ (0.0, 0.0, -1.0, 1.0, 0.0)
    found = np.array([p.c1[0] * w * w, p.c2[0] * w, p.d[0] * w * w])
    error = 400 * EPS * (1 + w * h * (1 + zeta)) ** 2
    assert found == pytest.approx([end[0], end[1], end[0] - 2.0 * end[4]], abs=error)


UNIT = st.floats(-1, 1)


@given(FREQUENCY, st.one_of(DAMPING, OVERDAMPED), STEP, UNIT, UNIT, UNIT, UNIT)
def test_heat_closes_the_energy_balance(w, zeta, h, stretch, velocity, force, slope):
    """Conservation law: kinetic + elastic + heat = work of the force, to round-off of the energies."""
    p = propagator(np.array([w]), np.array([zeta]), h)
    eta, v, q, s = (np.array([value]) for value in (stretch / w, velocity, force * w, slope * w))
    eta1 = p.a11 * eta + p.a12 * v + p.b1 * q + p.c1 * s
    v1 = p.a21 * eta + p.a22 * v + p.b2 * q + p.c2 * s
    heat = p.dissipated(eta, v, q, s)
    before, after = (0.5 * float((b**2 + (w * a) ** 2)[0]) for a, b in ((eta, v), (eta1, v1)))
    work = float((q * (eta1 - eta) + s * p.moment(eta, v, q, s))[0])
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
    assert p.dissipated(none, none, none, none) == 0.0
