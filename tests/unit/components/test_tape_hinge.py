"""Tape-spring hinge: published moments, snaps, energy."""

from itertools import pairwise

import numpy as np
import pytest

from components.contract.component import ComponentError
from components.numerics.tape import Tape, laws_of
from components.tape_hinge import TapeHinge
from tests.references.relative_motion import inputs, port_motion, work
from tests.unit.components.prepared import prepared

TAPE = {
    "radius": 0.0133,
    "subtended_angle": 1.5,
    "thickness": 1e-4,
    "length": 0.1,
    "youngs_modulus": 131e9,
    "poisson_ratio": 0.3,
}
D = 131e9 * 1e-12 / (12 * (1 - 0.3**2))
OPPOSITE, EQUAL = 1.3 * D * 1.5, 0.7 * D * 1.5
"""Steady moments (N.m) of Seffen and Pellegrino: (1 + nu) D a and (1 - nu) D a."""


def driven(component, angles, mode="mean", **start):
    """Observations by name along turns about y, and the work of the port's torque on the outboard side a step."""
    c = prepared(component, **start)
    states = [inputs(component, port_motion(), port_motion(turn=(0.0, angle, 0.0))) for angle in angles]
    x, rows, done = component.initial(c, states[0]), [], [0.0]
    rows.append(component.observe(c, x, states[0]))
    for before, after in pairwise(states):
        x = component.step(c, x, after, 0.01)
        rows.append(component.observe(c, x, after))
        done.append(done[-1] + work(component.outputs(c, x, after)[:12], before, after, 2))
    names = component.observation_layout
    found = {q.name: np.array(rows)[:, names[q.name]].ravel() for q in names.quantities}
    return {**found, "work": np.array(done)}


def test_uniform_bending_begins_as_a_beam_and_ends_as_a_plate():
    """Closed forms: E (t s^5 / (720 R^2) + t^3 s / 12) at small curvature, s D (k + nu / R) without effect of edges."""
    tape = Tape(**TAPE)
    width = 0.0133 * 1.5
    beam = 131e9 * (1e-4 * width**5 / (720 * 0.0133**2) + 1e-12 * width / 12)
    assert tape.uniform_moment(1e-4) / 1e-4 == pytest.approx(beam, rel=1e-5)
    thin = tape._replace(thickness=1e-9)
    plate = width * thin.plate_stiffness * (200.0 + 0.3 / 0.0133)
    assert thin.uniform_moment(200.0) == pytest.approx(plate, rel=1e-3)


@pytest.mark.parametrize("step", [0.02, 0.11])
def test_it_folds_over_the_peak_and_opens_at_the_steady_moment(step):
    """Published steady moments both ways, and the heat of a cycle is the area between both laws, at any step."""
    laws = laws_of(Tape(**TAPE))
    snap, (back, equal) = laws.straight_angle[-1], (laws.folded_angle[2], laws.folded_angle[1])
    way = np.concatenate([np.arange(0, 1, step), np.arange(1, -1, -step), np.arange(-1, step, step)])
    found = driven(TapeHinge(tape=TAPE), way)
    torque, angle, straight = found["tape_torque"], found["angle"], found["straight"] > 0.5
    opens = slice(np.argmax(angle) + 1, np.argmin(angle))
    assert torque[angle > snap] == pytest.approx(-OPPOSITE)
    assert torque[opens][angle[opens] > back] == pytest.approx(-OPPOSITE)
    assert torque[angle < equal] == pytest.approx(EQUAL)
    assert np.all(straight[opens][(angle[opens] < back) & (angle[opens] > equal)])
    balance = (
        found["work"]
        + found["potential_energy"]
        + found["dissipated_energy"]
        + found["numerical_dissipation"]
    )
    assert balance == pytest.approx(0.0, abs=1e-12)
    fine = np.linspace(back, snap, 4001)
    curve = [Tape(**TAPE).uniform_moment(one / 0.1) - OPPOSITE for one in fine]
    assert found["dissipated_energy"][-1] == pytest.approx(np.trapezoid(curve, fine), rel=1e-4)


def test_strips_back_to_back_fold_alike_both_ways():
    """Sum of both senses, and twice that of four strips."""
    two, four = (laws_of(Tape(**TAPE, opposite=n, equal=n)) for n in (1.0, 2.0))
    assert two.folded_torque == pytest.approx([OPPOSITE + EQUAL] * 2 + [-OPPOSITE - EQUAL] * 2)
    assert two.straight_torque == pytest.approx([-t for t in reversed(two.straight_torque)])
    assert four.straight_torque == pytest.approx([2 * t for t in two.straight_torque])


@pytest.mark.parametrize(
    ("structure", "words"),
    [
        ({}, "geometry.*tables"),
        ({"tape": {**TAPE, "radios": 1.0}}, "radios.*radius"),
        ({"tape": {**TAPE, "thickness": 0.0}}, "thickness is 0"),
        ({"tape": {**TAPE, "thickness": 3e-3}}, "too shallow or too thick"),
        ({"tape": {**TAPE, "opposite": 0, "equal": 0}}, "number of strips"),
        (
            {
                "straight_angle": (-0.1, 0.1), "straight_torque": (0.1, -0.1),
                "folded_angle": (-3, -0.2, 0.05, 3), "folded_torque": (0.1, 0.1, -0.1, -0.1),
            },
            "snap back between -0.1 and 0.1",
        ),
        (
            {
                "straight_angle": (-0.1, 0.1), "straight_torque": (0.1, -0.1),
                "folded_angle": (-3, -0.05, 0.05, 3), "folded_torque": (0.1, 0.1, -0.2, -0.2),
            },
            "gain energy",
        ),
    ],
)  # fmt: skip
def test_refusals(structure, words):
    with pytest.raises(ComponentError, match=words):
        TapeHinge(**structure)
