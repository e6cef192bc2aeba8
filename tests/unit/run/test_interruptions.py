"""A sample of the runs that `python -m tests.benchmark.faults.interruptions` interrupts."""

import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.cli.main import main
from orchestrator.run import error_estimate
from orchestrator.run.errors import RunError
from tests.benchmark.faults.interruptions import WITH_EVENTS, interruptions
from tests.benchmark.faults.kills import differences

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.filterwarnings("ignore::orchestrator.FanfoldWarning")


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

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(error_estimate, "run", interrupted)
    file = tmp_path / "run.h5"
    with pytest.raises(fanfold.FanfoldError, match=r"workbench: .*run\.h5") as told:
        fanfold.simulate(fanfold.load("workbench"), rigid="all", until=0.01, save=file)
    assert "were estimated" in str(told.value)
    assert fanfold.Result.open(file).time[-1] == 0.01


REPEATED = ("run", "workbench", "--rigid", "all", "--until", "0.02", "--output")
ALWAYS = "orchestrator.run.error_estimate._LIKELY"
"""With a large value, every run is repeated."""


class Moments:
    """Progress calls of a run, its estimates and its repetitions, of which one may send a signal."""

    def __init__(self, number=None, at=None):
        self.names, self._number, self._at = [], number, at

    @contextmanager
    def __call__(self, name, end):
        def show(time, h):
            self.names.append(name)
            if len(self.names) - 1 == self._at:
                signal.raise_signal(self._number)

        yield show


def run_with(monkeypatch, moments, path):
    monkeypatch.setattr(ALWAYS, 1e9)
    monkeypatch.setattr("orchestrator.cli.run.progress", moments)
    return CliRunner().invoke(main, [*REPEATED, str(path), "--verify"])


@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.thorough), signal.SIGTERM])
def test_interruptions_after_a_run_end_the_command(monkeypatch, tmp_path, number):
    """Regression: while it was repeated they were swallowed, exit code 0, and --verify or the next phase went on."""
    plain = Moments()
    assert run_with(monkeypatch, plain, tmp_path / "whole.h5").exit_code == 3
    after = [k for k, name in enumerate(plain.names) if name != "workbench"]
    assert {plain.names[k] for k in after} >= {
        "workbench: errors",
        "workbench: at 1e-05",
        "workbench: at 1e-06",
    }
    for at in np.linspace(after[0], after[-1], 4).astype(int).tolist():
        path = tmp_path / "run.h5"
        found = run_with(monkeypatch, Moments(number, at), path)
        assert found.exit_code == 1, at
        assert "Traceback" not in found.stderr
        assert str(path) in found.stderr
        result = fanfold.Result.open(path)
        assert result.complete
        assert result.time[-1] == 0.02
        assert [one.name for one in tmp_path.glob("run.*")] == ["run.h5"]


@pytest.mark.parametrize("repeated", [False, True])
def test_a_repetition_interrupted_in_python_keeps_the_result(monkeypatch, repeated):
    """As a run that is interrupted: an error that holds the result, here the whole earlier one, with its errors."""

    @contextmanager
    def interrupting(name, end):
        def show(time, h):
            if (": at " if repeated else ": errors") in name:
                raise KeyboardInterrupt

        yield show

    monkeypatch.setattr(ALWAYS, 1e9)

    with pytest.raises(RunError, match="is whole") as caught:
        fanfold.simulate("workbench", rigid="all", until=0.02, progress=interrupting)
    result = caught.value.result
    assert result.complete
    assert result.time[-1] == 0.02
    assert (result.estimated_errors is not None) == repeated


TELLING = """
import sys, time
from contextlib import contextmanager
import orchestrator.cli.run as command
import orchestrator.run.error_estimate as estimate
from orchestrator.cli.main import main

@contextmanager
def progress(name, end):
    print(name, flush=True)
    yield lambda at, h: time.sleep(0.02)

command.progress = progress
estimate._LIKELY = 1e9
main()
"""


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_repetition(tmp_path, number):
    """The same with a signal from outside."""
    path = tmp_path / "run.h5"
    command = [sys.executable, "-c", TELLING, *REPEATED, str(path)]
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        while ": at " not in (line := process.stdout.readline()):
            assert line
        process.send_signal(number)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "repeated" in said
    assert fanfold.Result.open(path).complete
    assert [one.name for one in tmp_path.iterdir()] == ["run.h5"]


def test_an_interruption_before_the_first_row_says_that_nothing_is_kept(monkeypatch, tmp_path):
    """Regression: "results up to there are in run.h5", which nobody could read."""

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("orchestrator.cosim.master.Master.initialize", interrupted)
    path = tmp_path / "run.h5"
    with pytest.raises(RunError, match=r"t = 0 s.*run\.h5"):
        fanfold.simulate("workbench", rigid="all", until=0.01, save=path)
    monkeypatch.undo()
    fanfold.simulate("workbench", rigid="all", until=0.01, save=path, replace=False, estimate=False)
