"""Does a killed run leave a result that can be read, and does it go on as if nothing had been? Runs are killed by seed.

    python -m tests.benchmark.faults.kills [COUNT] [FIRST_SEED]

Runs of the command line are killed (SIGKILL) at a random moment between their start and their end, every other one
between its first checkpoint and its end; resumed where they left a checkpoint, by chance killed again, and compared bit
by bit with the run that was not interrupted. A file that cannot be read, a resumption that fails or another bit is
printed with its seed, and the exit code is 1.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random
from time import monotonic, sleep
from typing import NamedTuple

import numpy as np

from orchestrator.results.result import Result, ResultError
from orchestrator.run.checkpoint import checkpoint_file

RUNS: tuple[tuple[str, ...], ...] = (
    ("amos3", "--rigid", "all", "--checkpoint", "0.4"),
    ("amos3", "--variant", "spring_latch", "--rigid", "all", "--no-estimate", "--checkpoint", "1"),
    ("amos3", "--no-estimate", "--checkpoint", "0.6"),
    ("amos3-ground", "--rigid", "all", "--no-estimate", "--checkpoint", "0.5"),
    ("bepicolombo", "--rigid", "all", "--no-estimate", "--checkpoint", "0.3"),
    ("workbench", "--no-estimate", "--checkpoint", "0.02"),
)
_FIRST_ROW = "before its first communication point"
_LONGEST = 600
_RESUMED = 0.7
"""Probability that a resumed run is not killed again."""
_SAME = ("steps", "iterations", "rejected_steps")
"""Statistics that do not tell of times."""
_FANFOLD = (sys.executable, "-c", "from orchestrator.cli.main import main; main()")


class Kill(NamedTuple):
    """One killed run: the seed that repeats it, the run, what it left, and what was wrong, empty for nothing."""

    seed: int
    command: tuple[str, ...]
    left: str
    fault: str


class Whole(NamedTuple):
    """A run that was not interrupted: its result, how long it took, and its first checkpoint (s)."""

    result: Path
    seconds: float
    checkpoint: float


def kills(count: int, first: int, folder: Path, runs: Sequence[tuple[str, ...]] = RUNS) -> Iterator[Kill]:
    """So many kills, each of one of the runs."""
    wholes: dict[tuple[str, ...], Whole] = {}
    for seed in range(first, first + count):
        dice = Random(seed)
        command = dice.choice(runs)
        if command not in wholes:
            wholes[command] = _whole(folder, folder / f"whole{len(wholes)}.h5", command)
        whole = wholes[command]
        after = dice.uniform(whole.checkpoint if seed % 2 else 0.0, whole.seconds)
        yield Kill(seed, command, *_kill_and_go_on(dice, command, whole, after, folder))


def _whole(folder: Path, path: Path, command: tuple[str, ...]) -> Whole:
    start = monotonic()
    with _started(folder, "run", *command, "--output", str(path)) as process:
        while process.poll() is None and not checkpoint_file(path).exists():
            sleep(0.01)
        checkpoint = monotonic() - start
        _, said = process.communicate(timeout=_LONGEST)
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)}: {said}")
    return Whole(path, monotonic() - start, checkpoint)


def _kill_and_go_on(
    dice: Random, command: tuple[str, ...], whole: Whole, after: float, folder: Path
) -> tuple[str, str]:
    """What the run left that was killed after so many seconds, and what was wrong."""
    path = folder / "cut.h5"
    for old in folder.glob("cut.h5*"):
        old.unlink()
    start: tuple[str, ...] = ("run", *command, "--output", str(path))
    while True:
        _kill(folder, after, *start)
        left, fault = _left(path)
        if fault or not checkpoint_file(path).exists():
            return left, fault
        start, after = ("resume", str(path)), dice.uniform(0.0, whole.seconds)
        if dice.random() < _RESUMED:
            return "a checkpoint", _run(folder, *start) or differences(whole.result, path)


def _environment(folder: Path) -> dict[str, str]:
    return {**os.environ, "TMPDIR": str(folder), "OMP_NUM_THREADS": "1"}


def _run(folder: Path, *arguments: str) -> str:
    """Run a command; what it said where it did not end well."""
    done = subprocess.run(
        [*_FANFOLD, *arguments],
        env=_environment(folder), capture_output=True, text=True, timeout=_LONGEST,
    )  # fmt: skip
    return "" if done.returncode == 0 and "Traceback" not in done.stderr else done.stderr[-500:] or "no word"


def _kill(folder: Path, after: float, *arguments: str) -> None:
    """Run a command and kill it after some time (s), if it has not ended by then."""
    with _started(folder, *arguments) as process:
        try:
            process.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()


def _started(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*_FANFOLD, *arguments],
        env=_environment(folder), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def _left(path: Path) -> tuple[str, str]:
    """What there is of a result, and why it cannot be read; no row may be there yet, and no file."""
    if not path.exists():
        return "nothing", ""
    try:
        result = Result.open(path)
        for component in result.components:
            for variable in result.variables(component):
                result.signal(component, variable)
    except ResultError as error:
        return "no row", "" if _FIRST_ROW in str(error) else str(error)
    return "everything" if result.complete else "rows", ""


def differences(one: Path, other: Path) -> str:
    """The first signal in which two results differ, or what they tell of their runs."""
    a, b = Result.open(one), Result.open(other)
    if not b.complete or not np.array_equal(a.time, b.time) or a.events != b.events:
        return (
            f"complete {b.complete}, {a.time.size} and {b.time.size} rows, events {a.events} and {b.events}"
        )
    for component in a.components:
        for variable in a.variables(component):
            if not np.array_equal(a.signal(component, variable), b.signal(component, variable)):
                return f"{component}.{variable} differs"
    told = [name for name in _SAME if a.statistics.get(name) != b.statistics.get(name)]
    return f"{told[0]}: {a.statistics.get(told[0])} and {b.statistics.get(told[0])}" if told else ""


if __name__ == "__main__":
    number, start_seed = map(int, (*sys.argv[1:], *("100", "0")[len(sys.argv) - 1 :])[:2])
    with tempfile.TemporaryDirectory() as place:
        listed = []
        for kill in kills(number, start_seed, Path(place)):
            listed.append(kill)
            if kill.fault:
                print(f"seed {kill.seed}, {' '.join(kill.command)}: {kill.fault}", flush=True)
    left = Counter(kill.left for kill in listed)
    print(
        f"{number} kills from seed {start_seed}; left: {', '.join(f'{what} {n}' for what, n in left.items())}"
    )
    sys.exit(any(kill.fault for kill in listed))
