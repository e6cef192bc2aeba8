"""Newton's correction of the turn of a step, beside differences of what it corrects."""

from __future__ import annotations

import numpy as np
import pytest

from components.body_parts.load import Load
from components.body_parts.turn import Ending, is_slender, newton_turn
from components.contract.frames import exponential, normalized, rotation_matrix

STEP = 0.1
RNG = np.random.default_rng(1)
ROOT = RNG.normal(size=(3, 3))
INERTIA = ROOT @ ROOT.T + 0.3 * np.eye(3)
ARMS, START = RNG.normal(size=(2, 3)), 3.0 * RNG.normal(size=3)
AXES = rotation_matrix(normalized(tuple(RNG.normal(size=4).tolist())))
WRENCHES = 20.0 * RNG.normal(size=24)


def missing(omega, load):
    """By how much a mean angular velocity misses the one that its end asks for, and the end; written out once more."""
    half = rotation_matrix(exponential(tuple((0.5 * STEP * omega).tolist())))
    middle, end = AXES @ half, AXES @ half @ half
    moment, slope = load.moments(ARMS @ AXES.T, ARMS @ end.T)
    spin = (AXES @ INERTIA @ START + STEP * moment) @ end
    bend = STEP / 6.0 * np.linalg.solve(INERTIA, slope @ middle)
    mean = 0.5 * (START + np.linalg.solve(INERTIA, spin)) - bend
    return mean - omega, Ending(INERTIA, spin, ARMS, slope @ middle, end)


@pytest.mark.parametrize(("slopes", "accuracy"), [(0.0, 1e-5), (1.0, 2e-2)])
def test_the_correction_is_newtons(slopes, accuracy):
    """Independent: central differences; with slopes to the second order of what a step turns, 0.4 rad here.

    Regression: terms of slopes that cancel were kept in part, and iterations stopped at 1e-8 N of noise.
    """
    load = Load.of(WRENCHES * np.repeat((1.0, slopes), 12))
    omega = START + 0.1
    away, end = missing(omega, load)
    columns = [(missing(omega + d, load)[0] - missing(omega - d, load)[0]) / 2e-6 for d in 1e-6 * np.eye(3)]
    expected = -np.linalg.solve(np.column_stack(columns), away)
    found = newton_turn(end, load, omega, away, STEP)
    assert np.linalg.norm(found - expected) <= accuracy * np.linalg.norm(expected)


def test_a_panel_is_not_slender_and_a_tube_is():
    """A panel of 2 x 1 m, and a tube of 1.5 m."""
    assert not is_slender(np.diag((0.8, 3.3, 4.2)))
    assert is_slender(np.diag((6e-4, 0.56, 0.56)))
