"""Bodies whose bending stretches them, against Duffing's oscillator, statics and the conservation of energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipj

from components.body import Body
from components.contract.component import ComponentError
from tests.unit.components.body.body_cases import modal, total_energy
from tests.unit.components.clamped_membrane import THICKNESS, clamped_membrane
from tests.unit.components.prepared import prepared

PORTS = tuple({"name": name, "point": name} for name in ("border", "center"))


@pytest.fixture(scope="module")
def data():
    """The foil in one rigid border, undamped."""
    return clamped_membrane(12).with_damping(0.0)


def bent(data, amplitude):
    """The body, its constants and a state at rest that bends its middle by an amplitude (m) in the first mode."""
    body = Body(data.to_arrays(), PORTS)
    c = prepared(body)
    x = body.initial(c, np.zeros(24))
    shape = data.translation[data.point_names.index("center"), 2, 0]
    modal(x, body.modes)[0][0] = amplitude / shape
    return body, c, x


@pytest.mark.parametrize("h", [2e-4, 2e-3, 2e-2])
def test_free_vibration_keeps_its_energy(data, h):
    """Conservation law at any step: four thicknesses, most of the energy in tension, through all that stretches."""
    body, c, x = bent(data, 4.0 * THICKNESS)
    start, (eta, _) = total_energy(body, c, x), modal(x, body.modes)
    assert body.tension.energy(eta) > 0.8 * start
    for _ in range(40):
        x = body.step(c, x, np.zeros(24), h)
        assert total_energy(body, c, x) == pytest.approx(start, rel=3e-10)
    assert np.abs(modal(x, body.modes)[0][1:]).max() > 0.01 * np.abs(eta[0])


def test_one_mode_is_duffings_oscillator(data):
    """Closed form: eta'' + w^2 eta + S^2 / 2 eta^3 = 0 swings as A cn(W t, m) (Abramowitz and Stegun, 16.4).

    Errors fall with the fourth power of the step.
    """
    single = data.keep_modes([0])
    single = replace(single, tension_forms=single.tension_forms[:1])
    body, c, x = bent(single, 2.0 * THICKNESS)
    amplitude, form = float(modal(x, 1)[0][0]), float(single.tension_forms[0, 0, 0])
    cubic, time = 0.5 * (form * amplitude) ** 2, 0.1
    rate = np.sqrt(single.frequency[0] ** 2 + cubic)
    _, cn, _, _ = ellipj(rate * time, 0.5 * cubic / rate**2)
    assert cubic > single.frequency[0] ** 2
    errors = []
    for steps in (40, 80, 160):
        state = x
        for _ in range(steps):
            state = body.step(c, state, np.zeros(24), time / steps)
        errors.append(abs(modal(state, 1)[0][0] / amplitude - cn))
    assert errors[2] < 1e-6
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(16.0, rel=0.05)


def test_rates_are_those_of_small_steps(data):
    """Definition: what a step changes, divided by its size, as the size vanishes."""
    body, c, x = bent(data, 3.0 * THICKNESS)
    u, h = np.zeros(24), 1e-7
    u[2], u[8] = -3.0, 3.0
    grown = modal(body.step(c, x, u, h), body.modes)[1] / h
    rates = body.rates(c, x, u)[-body.modes :]
    # the next term is by h of the largest curvature in time
    assert grown == pytest.approx(rates, abs=1e-6 * np.abs(rates).max())


def test_it_needs_the_inertia_of_second_order(data):
    """Sentence, as of all bodies with modes of second order."""
    with pytest.raises(ComponentError, match="'full'"):
        Body(data.to_arrays(), PORTS, "rigid")
