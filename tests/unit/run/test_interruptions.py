"""A sample of the runs that `python -m tests.benchmark.faults.interruptions` interrupts."""

import h5py
import pytest

import orchestrator as fanfold
from orchestrator.run import simulation
from tests.benchmark.faults.interruptions import WITH_EVENTS, interruptions
from tests.benchmark.faults.kills import differences


def test_interrupted_run_goes_on_in_every_bit(tmp_path):
    """Identity: a latch-up and events on either side of the interruption; control: the last bit of one value."""
    (found,) = interruptions(
        1, 0, tmp_path, [WITH_EVENTS._replace(options={"rigid": "all", "estimate": False})]
    )
    assert found.fault == ""
    assert found.before > 0
    assert found.after > 0
    with h5py.File(tmp_path / "cut.h5", "r+") as file:
        values = file["signals/hinge_right/angle"]
        values[-1] += 1e-15
    assert differences(tmp_path / "whole0.h5", tmp_path / "cut.h5") == "hinge_right.angle differs"


def test_an_interrupted_estimate_leaves_the_run_as_it_was(monkeypatch, tmp_path):
    """Regression: nothing said that the result was whole, and that there was no checkpoint to go on from."""

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(simulation, "with_estimates", interrupted)
    file = tmp_path / "run.h5"
    with pytest.raises(fanfold.FanfoldError, match=r"workbench: .*run\.h5 is whole but for these") as told:
        fanfold.simulate(fanfold.load("workbench"), rigid="all", until=0.01, save=file)
    assert "interrupted while its errors were estimated" in str(told.value)
    assert fanfold.Result.open(file).time[-1] == 0.01
