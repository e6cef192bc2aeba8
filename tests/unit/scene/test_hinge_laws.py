"""Torques of motors and harnesses that differ both ways: what opens is the table that was given."""

from __future__ import annotations

import numpy as np
import pytest

from components.numerics.laws import Table
from orchestrator.scene.hinge_line_tables import TorqueLoop

SEEDS = range(12)


@pytest.mark.parametrize("seed", SEEDS)
def test_mean_less_half_is_what_opens_and_both_together_what_closes(seed):
    """Definition, over random tables: mean - half is the law of the opening table, mean + half that of closing.

    A cubic between two points bends by at most 12 of their step over the square of their distance, and straight lines
    between 16 samples of it err by 12/8 / 16^2.
    """
    rng = np.random.default_rng(seed)
    angle = np.cumsum(rng.uniform(0.2, 1.0, 5))
    opening = rng.uniform(-2.0, 2.0, 5)
    closing = opening + rng.uniform(0.5, 1.0, 5)
    loop = TorqueLoop.of(angle.tolist(), opening.tolist(), closing.tolist())
    mean, half = Table(loop.angle, loop.mean), Table(loop.angle, loop.half)
    bound = 12.0 / 8.0 / 16.0**2 * max(np.abs(np.diff(t)).max() for t in (opening, closing))
    for law, side, inside in ((Table(angle, opening), -1.0, False), (Table(angle, closing), 1.0, True)):
        reach = 0.0 if inside else angle[-1] - angle[0]
        for s in rng.uniform(angle[0] - reach, angle[-1] + reach, 200).tolist():
            if inside and law.value(s) < Table(angle, opening).value(s):
                continue  # two laws that cross between their points take nothing
            assert mean.value(s) + side * half.value(s) == pytest.approx(law.value(s), abs=2.0 * bound)


def test_without_a_difference_the_table_stays_as_it_is():
    assert TorqueLoop.of((0.0, 1.0), (2.0, 1.0), ()) == ((0.0, 1.0), (2.0, 1.0), (0.0, 0.0))
    assert TorqueLoop.of((0.0, 1.0), (2.0, 1.0), (2.0, 1.0)).half == (0.0, 0.0)
