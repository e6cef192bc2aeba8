"""A sample of the campaign of random wings: small ones, at a loose tolerance."""

import tomllib

import pytest

from tests.benchmark.campaign import try_wing
from tests.benchmark.campaign_errors import misses
from tests.references.random_wings import load_wing, random_wing, toml_text

SEEDS = range(8)
SMALL = (2, 3)
TOLERANCE = 1e-2


@pytest.mark.parametrize("seed", SEEDS)
def test_latch_times_and_peaks_stay_within_ten_tolerances(seed):
    """Against a run at a hundredth of the tolerance; nothing was left out for how it comes out."""
    trial = try_wing(seed, TOLERANCE, bodies=SMALL)
    assert not trial.failure
    assert not trial.reference_failure
    assert misses(trial.deviations, TOLERANCE, 10.0) == []


@pytest.mark.parametrize("seed", range(40))
def test_every_wing_is_a_sound_scene(seed):
    """The reader refuses nothing, a file of it says the same, and a seed always means one wing."""
    tree = random_wing(seed)
    assert tomllib.loads(toml_text(tree)) == tree == random_wing(seed)
    assert len(load_wing(seed).bodies) == len(tree["body"])
