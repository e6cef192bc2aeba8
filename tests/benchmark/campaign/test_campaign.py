"""The campaign keeps what it finds as it goes; its verdict on estimates."""

from __future__ import annotations

import csv

import pytest

from tests.benchmark.campaign.errors import Deviation, is_covered
from tests.benchmark.campaign.trials import Trial, kept_in

PEAK = Deviation("latch torque peak", "L0", 0.02, 0.01, 102.0, 100.0)


def _trial(*found, failure=""):
    return Trial(7, 2, 1, False, ("spring", "none"), 1e-3, deviations=found, failure=failure)


def test_what_is_found_is_kept_before_the_next_wing(tmp_path):
    """Rule: an interrupted campaign leaves the numbers of every wing that is done, and what failed."""
    path = tmp_path / "wings.csv"
    with kept_in(path) as keep:
        keep(_trial(PEAK))
        keep(_trial(failure="does not converge"))
        found, failed = csv.DictReader(path.read_text(encoding="utf-8").splitlines())
    assert [found[name] for name in Deviation._fields] == [str(value) for value in PEAK]
    assert (found["seed"], found["latches"], failed["failure"]) == ("7", "spring none", "does not converge")


@pytest.mark.parametrize(
    ("error", "estimate", "verdict"),
    [
        (0.02, 0.011, True),
        (0.02, 0.009, False),
        (0.003, 0.02, True),
        (1.5e-4, 9e-5, True),
        (1e-7, 9e-5, None),
        (0.02, None, None),
    ],
)
def test_estimates_cover_errors_within_a_factor(error, estimate, verdict):
    """Rule: a factor of two; below a tenth of the tolerance, here 1e-3, the reference errs as well."""
    assert is_covered(PEAK._replace(error=error, estimate=estimate), 1e-3) is verdict
