"""The spin-up beam of Kane, Ryan and Banerjee: a scene whose base turns, with its boom at two fidelities."""

import numpy as np
import pytest

import orchestrator as fanfold
from tests.references.spin_up import (
    AT_TEN,
    CLAMP,
    DEEPEST,
    LENGTH,
    RATE,
    RISE,
    SECTION,
    WHEN,
    seen_from_the_base,
    spin_up,
    tip_of_beam,
    tip_of_modal,
)


def check_deflection(t, behind):
    """Published: 0.574 m at 6.76 s, and computed by others 0.3628 m at 10 s, within 0.5 %."""
    assert behind.max() == pytest.approx(DEEPEST, rel=5e-3)
    assert t[behind.argmax()] == pytest.approx(WHEN, abs=0.02)
    assert np.interp(10.0, t, behind) == pytest.approx(AT_TEN, rel=5e-3)
    assert np.abs(behind[t > RISE + 0.2]).max() < 0.01 * behind.max()


def test_a_boom_with_second_order_modes_spins_up():
    """The same published deflection with six modes; those of first order alone miss it by a fifth."""
    keys = {"fidelity": "flexible", "fixed_interface_modes": 6, "second_order_modes": 6}
    result = fanfold.simulate(spin_up(1e-4, **keys), estimate=False)
    t = np.array(result.time)
    check_deflection(t, seen_from_the_base(t, tip_of_modal(result, 1, 24, 6, 6))[1])


def test_a_boom_of_large_deformation_spins_up():
    """The published deflection with 12 elements; 16 and a tolerance of 1e-4 err by 0.2 %.

    Closed form: at the end straight and longer by rho A w^2 L^3 / 3 EA, to 0.2 %, beside what the clamp gives.
    """
    result = fanfold.simulate(spin_up(3e-4, elements=12, fidelity="large_deformation"), estimate=False)
    t = np.array(result.time)
    along, behind = seen_from_the_base(t, tip_of_beam(result))
    check_deflection(t, behind)
    late = t > RISE + 0.2
    pull = SECTION["line_mass"] * RATE**2 * LENGTH**2
    stretch = pull * LENGTH / 3.0 / SECTION["axial"]
    assert stretch == pytest.approx(5.142857e-4, rel=1e-6)
    assert along[late].mean() == pytest.approx(stretch + 0.5 * pull / CLAMP, rel=2e-3)
