"""What counts as round-off: definition at its edge, of values of both signs."""

import math

from orchestrator.results.estimated_errors import round_off_of_loads
from orchestrator.results.round_off import NOISE, noise_floor, rounded_to_floor


def test_floor_is_a_part_of_the_largest_magnitude():
    assert noise_floor([1.0, -200.0, 3.0]) == 200.0 * NOISE
    assert noise_floor([]) == 0.0


def test_round_off_becomes_zero_without_sign():
    assert rounded_to_floor(-1e-7, 1e-6) == 0.0
    assert rounded_to_floor(-2e-6, 1e-6) == -2e-6
    assert math.copysign(1.0, rounded_to_floor(-0.0, 0.0)) == 1.0


def test_loads_below_what_iterations_resolve_are_round_off():
    """Definition: iterations end beside the largest load and one newton (metre), so 3e-8 N alone is nothing.

    Several joints leave ten times as much. Regression: 4e-6 N.m beside hinges that bear 50 N were followed to a smaller
    tolerance.
    """
    force, torque, hinge = (
        ("interface force peak", "x"),
        ("interface torque peak", "y"),
        ("hinge force peak", "h"),
    )
    assert round_off_of_loads([(force, 3e-8)]) == 10.0 * NOISE
    assert round_off_of_loads([(force, 3e-8), (torque, 20.0)]) == 200.0 * NOISE
    assert round_off_of_loads([(force, 0.7), (hinge, 50.0)]) == 500.0 * NOISE
