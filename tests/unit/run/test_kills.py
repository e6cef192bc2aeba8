"""A killed run, which `python -m tests.benchmark.faults.kills` kills hundreds of."""

import sys
from time import sleep

import pytest

import orchestrator as fanfold
from orchestrator.run.checkpoint import checkpoint_file
from tests.benchmark.faults import kills

pytestmark = pytest.mark.slow
RUN = ("amos3", "--rigid", "all", "--no-estimate", "--checkpoint", "0.4")
ATTEMPTS = 5
"""On a busy machine a run may end before it is seen that there is a checkpoint."""


def killed(cut):
    """The file of a run that was killed as soon as it had a checkpoint."""
    for _ in range(ATTEMPTS):
        with kills._started(cut.parent, "run", *RUN, "--output", str(cut)) as process:
            while process.poll() is None and not checkpoint_file(cut).exists():
                sleep(0.001)
            process.kill()
        if checkpoint_file(cut).exists():
            return cut
    raise AssertionError("every run ended before it was killed")


@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
def test_killed_runs_are_readable_and_go_on(tmp_path):
    """Identity of every bit after a kill, from its checkpoint; the file can be read before."""
    whole, cut = tmp_path / "whole.h5", killed(tmp_path / "cut.h5")
    assert kills._left(cut) == ("rows", "")
    fanfold.resume(cut)
    fanfold.simulate("amos3", rigid="all", estimate=False, checkpoint=0.4, save=whole)
    assert kills.differences(whole, cut) == ""
