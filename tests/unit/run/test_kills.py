"""A sample of the runs that `python -m tests.benchmark.faults.kills` kills."""

import sys

import pytest

from tests.benchmark.faults.kills import kills

pytestmark = pytest.mark.slow
RUN = ("amos3", "--rigid", "all", "--no-estimate", "--until", "8", "--checkpoint", "0.4")
"""Beyond the first latch-up."""


@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
def test_killed_runs_are_readable_and_go_on(tmp_path):
    """Identity of every bit after kills, from checkpoints where there are any; no file that cannot be read."""
    found = list(kills(1, 1, tmp_path, [RUN]))
    assert [kill.fault for kill in found] == [""]
