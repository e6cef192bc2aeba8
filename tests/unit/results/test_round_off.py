"""What counts as round-off: definition at its edge, of values of both signs."""

import math

from orchestrator.results.round_off import NOISE, noise_floor, without_noise


def test_floor_is_a_part_of_the_largest_magnitude():
    assert noise_floor([1.0, -200.0, 3.0]) == 200.0 * NOISE
    assert noise_floor([]) == 0.0


def test_round_off_becomes_zero_without_sign():
    assert without_noise(-1e-7, 1e-6) == 0.0
    assert without_noise(-2e-6, 1e-6) == -2e-6
    assert math.copysign(1.0, without_noise(-0.0, 0.0)) == 1.0
