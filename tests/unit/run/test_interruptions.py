"""A sample of the runs that `python -m tests.benchmark.faults.interruptions` interrupts."""

import h5py

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
