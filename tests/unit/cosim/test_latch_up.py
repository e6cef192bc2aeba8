"""What a latch-up stiffens, against the closed form of one rigid panel on its hinge line."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest

from fmus import native_library
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from orchestrator.cosim.settings import Settings
from tests.benchmark.stability import LATCH_RATE, panel_data, panel_scene
from tests.references.coupled import mastered
from tests.references.coupling_parts import call

pytestmark = pytest.mark.skipif(native_library() is None, reason="no C compiler")

LATCH, DAMPING, STEP = 2e3, 40.0, 5e-3
INERTIAL = 1.6
"""Stiffness with the inertial terms of unresolved coordinates over the stiffness of the law alone."""


def at_latch_up(joint):
    """The coupling of the workbench panel at its latch angle."""
    parts, links, lines = panel_scene(panel_data(0), joint, LATCH)
    for part in parts:
        if part.kind == "hinge":
            part.start["latch_damping"] = 0.5 * DAMPING
    run = mastered(Network(in_process(parts), links), Settings(largest_step=STEP, start_step=STEP), lines)
    run.master.initialize(preload=False)
    return run.master.coupling


@pytest.fixture(scope="module")
def latched():
    """The same with its line latched."""
    coupling = at_latch_up(1e9)
    assert 0.0 < coupling.engage(0, judged=True) <= STEP
    return coupling


@pytest.fixture(scope="module")
def line(latched):
    """Frequency, decay and energy of the line, and the axes of its hinges."""
    found = np.zeros(3 + 3 * 2)
    assert call("stiffened", latched, 0, found) == 2
    return found


def inertia():
    """Of the panel about its hinge line (kg.m2)."""
    data = panel_data(0)
    x, _, z = data.center_of_mass
    return data.inertia[1, 1] + data.mass * (x * x + z * z)


@pytest.mark.thorough
def test_a_line_swings_as_the_latched_panel(line):
    """Closed form: the root of stiffness over the inertia about the hinge line, damping over it, J w^2 / 2."""
    frequency = sqrt(INERTIAL * LATCH / inertia())
    assert line[:3] == pytest.approx(
        (frequency, DAMPING / inertia(), 0.5 * inertia() * LATCH_RATE**2), rel=1e-3
    )
    for axis in line[3:].reshape(2, 3):
        np.testing.assert_allclose(np.abs(axis), (0.0, 1.0, 0.0), atol=1e-6)


def test_what_does_not_change_is_left_out(latched):
    """The same slopes before and after are no event."""
    latched.engage(0, judged=True)
    assert call("stiffened", latched, 0, np.zeros(9)) == 0


@pytest.mark.parametrize("factor", [-1.0, 1e17])
def test_a_hinge_that_turns_without_sense_tells_nothing(factor):
    """Rule: derivatives of a step too long for the motion give no frequency, not that of a wing at rest.

    Turned against its torque, or so far that matrices are as good as singular.
    """
    coupling = at_latch_up(1e9)
    coupling.engage(0, judged=True)
    assert call("fastest_displaced", coupling, 0, STEP, 1.0) > 0.0
    assert call("fastest_displaced", coupling, 0, STEP, factor) == 0.0
