"""What a latch-up stiffens, against the closed form of one rigid panel on its hinge line."""

from __future__ import annotations

from math import sqrt
from types import SimpleNamespace

import numpy as np
import pytest
from orchestrator.cosim.implicit.solvers import solver_for
from orchestrator.cosim.latch_up import slopes, stiffened_line, stiffenings

from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from tests.benchmark.stability import LATCH_RATE, panel_data, panel_scene
from tests.references.coupled import Tolerance
from tests.unit.cosim.networks import start

LATCH, DAMPING, STEP = 2e3, 40.0, 5e-3
HINGES = ("left_hinge", "right_hinge")
INERTIAL = 1.6
"""Stiffness with the inertial terms of unresolved coordinates over the stiffness of the law alone."""


def at_latch_up(joint):
    """The workbench panel at its latch angle, with the matrices of a step in use."""
    parts, links, _ = panel_scene(panel_data(0), joint, LATCH)
    for part in parts:
        if part.kind == "hinge":
            part.start["latch_damping"] = 0.5 * DAMPING
    network = Network(in_process(parts), links)
    start(network)
    solver = solver_for(network, Tolerance(1e-8))
    solver.save(0.0)
    solver.linearize(0.0, STEP)
    return solver


@pytest.fixture(scope="module")
def line():
    """Its hinge line, both latches just commanded."""
    solver = at_latch_up(1e9)
    before = slopes(solver, HINGES, 0.0, STEP)
    for name in HINGES:
        hinge = solver.network.by_name[name]
        hinge.inputs[hinge.input_layout["latch_command"]] = 1.0
    after = slopes(solver, HINGES, 0.0, STEP)
    found = stiffenings(solver, HINGES, before, after, STEP)
    return stiffened_line(solver, found, STEP)


def inertia():
    """Of the panel about its hinge line (kg.m2)."""
    data = panel_data(0)
    x, _, z = data.center_of_mass
    return data.inertia[1, 1] + data.mass * (x * x + z * z)


def test_frequency_is_that_of_the_latched_panel(line):
    """Closed form: the root of stiffness over the inertia about the hinge line."""
    assert line.frequency == pytest.approx(sqrt(INERTIAL * LATCH / inertia()), rel=1e-3)


def test_energy_is_that_of_the_rate_at_latch_up(line):
    """Closed form: J w^2 / 2."""
    assert line.energy == pytest.approx(0.5 * inertia() * LATCH_RATE**2, rel=1e-3)


def test_decay_is_damping_over_inertia(line):
    assert line.decay == pytest.approx(DAMPING / inertia(), rel=1e-3)
    assert line.fastest == max(line.decay, line.frequency)


def test_axis_is_the_hinge_line(line):
    for hinge in line.hinges:
        np.testing.assert_allclose(np.abs(hinge.axis), (0.0, 1.0, 0.0), atol=1e-6)


def test_what_does_not_change_is_left_out():
    """The same slopes before and after are no event."""
    solver = at_latch_up(1e6)
    same = slopes(solver, HINGES, 0.0, STEP)
    assert stiffenings(solver, HINGES, same, same, STEP) == ()


def turning(solver, factor):
    """The solver where everything is displaced so many times as far."""
    return SimpleNamespace(
        network=solver.network, displacements=lambda wrenches: factor * solver.displacements(wrenches)
    )


def test_a_hinge_that_would_turn_against_its_torque_tells_nothing(line):
    """Rule: derivatives of a step too long for the motion give no frequency, not that of a wing at rest."""
    solver = at_latch_up(1e9)
    assert stiffened_line(turning(solver, -1.0), line.hinges, STEP).fastest == 0.0
    assert stiffened_line(solver, line.hinges, STEP).fastest > 0.0


def test_a_hinge_that_turns_without_bound_tells_nothing(line):
    """Regression: where matrices were as good as singular the sign alone decided, and steps were judged by that."""
    assert stiffened_line(turning(at_latch_up(1e9), 1e17), line.hinges, STEP).fastest == 0.0
