"""Motion laws: closed forms, rates as derivatives, moments of steps, breaks, and what is no law."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components.contract.component import ComponentError
from components.numerics.motion_law import NEVER, PROFILES, MotionLaw, gauss_moments, interpolated

TERMS = {
    "constant": {"value": 0.7},
    "ramp": {"start": 0.2, "duration": 1.5, "change": -2.0},
    "step": {"start": 0.2, "duration": 1.5, "change": 1.2},
    "step5": {"start": -0.3, "duration": 2.5, "change": 1.2},
    "havsin": {"duration": 2.0, "change": 0.4},
    "spin_up": {"start": 0.5, "duration": 1.5, "rate": 6.0},
    "harmonic": {"start": 0.3, "amplitude": 0.2, "frequency": 1.3, "phase": 0.4},
    "table": {"times": [0.1, 0.5, 1.7, 2.0], "values": [0.0, 1.0, 0.5, 0.9]},
    "polyline": {"times": [0.1, 0.5, 1.7, 2.0], "values": [0.0, 1.0, 0.5, 0.9]},
}
TIMES = np.linspace(-1.0, 4.0, 201) + 1e-3


def law(*names):
    return MotionLaw([{"profile": name, **TERMS[name]} for name in names])


def closed_form(name, t):
    """Every profile as the field writes it (STEP, STEP5, HAVSIN of multibody programs; benchmark 11's spin-up)."""
    term = {"start": 0.0, "phase": 0.0, **TERMS[name]}
    if name == "constant":
        return np.full_like(t, term["value"])
    if name == "harmonic":
        return term["amplitude"] * np.sin(
            2 * np.pi * term["frequency"] * np.maximum(t - term["start"], 0.0) + term["phase"]
        )
    if name == "polyline":
        return np.interp(t, term["times"], term["values"])
    s = np.clip((t - term["start"]) / term["duration"], 0.0, 1.0)
    if name == "spin_up":
        T, after = term["duration"], np.maximum(t - term["start"] - term["duration"], 0.0)
        up = s**2 / 2 + (np.cos(2 * np.pi * s) - 1) / (2 * np.pi) ** 2
        return term["rate"] * (T * up + after)
    shapes = {
        "ramp": s,
        "step": s * s * (3 - 2 * s),
        "step5": s**3 * (10 - 15 * s + 6 * s * s),
        "havsin": 0.5 * (1 - np.cos(np.pi * s)),
    }
    return term["change"] * shapes[name]


@pytest.mark.parametrize("name", [name for name in TERMS if name != "table"])
def test_profiles_are_their_closed_forms(name):
    values = [law(name).value(t) for t in TIMES]
    assert values == pytest.approx(closed_form(name, TIMES), abs=1e-13)


def test_a_table_passes_through_its_points_and_between_them():
    table, term = law("table"), TERMS["table"]
    assert [table.value(t) for t in term["times"]] == pytest.approx(term["values"], abs=1e-13)
    inner = [table.value(t) for t in np.linspace(0.5, 1.7, 50)]
    assert np.all(np.diff(inner) <= 1e-13), "monotone between two points"
    assert (table.value(-3.0), table.value(9.0)) == (0.0, pytest.approx(0.9, abs=1e-13))


@pytest.mark.parametrize("name", TERMS)
def test_rates_and_accelerations_are_derivatives(name):
    """Central differences of 1e-5 err by d^2/6 of the next but one derivative, below 1e4 here, and by round-off."""
    one, d = law(name), 1e-5
    times = np.array([t for t in TIMES if abs(one.time_to_break(t - 2 * d)) > 5 * d])
    for function, derivative, noise in ((one.value, one.rate, 1e-6), (one.rate, one.acceleration, 1e-5)):
        slopes = [(function(t + d) - function(t - d)) / (2 * d) for t in times]
        assert slopes == pytest.approx([derivative(t) for t in times], abs=noise)


def test_terms_add_up():
    """Of laws whose breaks coincide, cross, or are none."""
    names = tuple(TERMS)
    whole, parts = law(*names), [law(name) for name in names]
    for t in TIMES:
        assert whole.value(t) == pytest.approx(sum(part.value(t) for part in parts), abs=1e-12)
    assert set(whole.breaks) == {time for part in parts for time in part.breaks}


@given(st.floats(-1.0, 3.0), st.floats(1e-3, 0.5))
def test_moments_of_a_step(start, h):
    """The first moment of the rate against the integral by a rule of many points; no break within."""
    one = law("step5", "harmonic", "constant")
    if one.time_to_break(start) < h:
        return
    nodes, weights = np.polynomial.legendre.leggauss(20)
    rates = np.array([one.rate(start + 0.5 * h * (1 + x)) for x in nodes])
    moment = 0.5 * h * float(weights @ (nodes * rates))
    # Gauss' rule with three points errs by h^6 / 2016000 of the sixth derivative, (2 pi 1.3)^6 0.2, of the value
    bound = 2 * h**6 / 2016000 * (2 * np.pi * 1.3) ** 6 * 0.2
    assert one.rate_moment(start, start + h) == pytest.approx(moment, abs=1e-13 + bound)
    mean, slope = gauss_moments(one.samples(start, start + h))
    assert mean == pytest.approx(one.mean(start, start + h), abs=1e-14)
    assert slope == pytest.approx(0.5 * (one.value(start + h) - one.value(start)), abs=0.2 * h**3 * 600)


def test_parabolas_pass_through_their_places():
    parabola = np.polynomial.Polynomial([0.3, -1.0, 2.0])
    points = 0.6**0.5 * np.array((-1.0, 0.0, 1.0))
    assert interpolated(*parabola(np.array((-1.0, 0.0, 1.0)))) == pytest.approx(parabola(points), abs=1e-14)


def test_breaks():
    one = MotionLaw([{"profile": "step", "duration": 1.0, "change": 1.0, "start": s} for s in (0.0, 1.0)])
    assert one.breaks == (0.0, 1.0, 2.0)
    assert [one.time_to_break(t) for t in (0.0, 0.25, 1.0 - 1e-12, 1.5)] == pytest.approx(
        [1.0, 0.75, 1.0, 0.5]
    )
    assert one.time_to_break(2.0) == NEVER == law("constant").time_to_break(0.0)


@pytest.mark.parametrize(
    ("terms", "words"),
    [
        ([], "list"),
        ("step", "list"),
        ([{"profile": "stepp"}], "constant, ramp, step"),
        ([3.0], "profiles are"),
        ([{"profile": "step", "change": 1.0}], "term 1 .*step: duration"),
        ([{"profile": "step", "change": 1.0, "duration": 0}], "duration .*0.*positive"),
        ([{"profile": "step", "change": "1", "duration": 1}], "change .*'1'"),
        ([{"profile": "ramp", "change": np.inf, "duration": 1}], "change .*inf"),
        (
            [{"profile": "ramp", "change": 1, "duration": 1, "end": 2}],
            "end .*numbers",
        ),
        ([{"profile": "table", "times": [0, 0], "values": [1, 2]}], "times rising"),
        ([{"profile": "table", "times": 1.0, "values": 2.0}], "many values"),
    ],
)
def test_what_is_no_law_is_told(terms, words):
    with pytest.raises(ComponentError, match=words):
        MotionLaw(terms)


def test_every_profile_is_tried():
    assert TERMS.keys() == PROFILES.keys()
