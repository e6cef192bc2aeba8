"""Does a broken FMU break its own process only? One FMU of a wing is broken, in one of many ways, by seed.

    python -m tests.benchmark.faults.fmus [COUNT] [FIRST_SEED]

A run with an FMU that fails must end with a sentence that names the FMU and what happened, keep finite rows up to there
and leave no process behind; one with an FMU that is only slow or talks much must end as it does with the sound FMU, in
every bit.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from random import Random
from typing import NamedTuple

import numpy as np

from fmus.native import suffix
from fmus.native.compile import compile_files
from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.settings import Settings
from orchestrator.results.result import Result
from orchestrator.run.run import Loader, RunError, export, run
from orchestrator.scene import load_scene
from tests.benchmark.faults.listing import Fault, main

SCENE = Path(__file__).parents[2] / "scenes" / "two_panels.toml"
UNTIL, LONGEST_CALL = 0.2, 0.6
SOUND = ("none", "much_talk", "odd_talk", "printing", "slow", "crash_in_fmi2FreeInstance")
"""What a run gets over."""
FAILING = {
    "crash_at_instantiation": "crashed during fmi2Instantiate, with signal 11",
    "exit_at_instantiation": "exit code 0 during fmi2Instantiate",
    "hang_at_instantiation": "it hangs, fmi2Instantiate",
    "no_instance": "licence server",
    "no_instance_no_word": "instantiate",
    "error_in_fmi2SetupExperiment": "refused by fmi2SetupExperiment",
    "error_in_fmi2EnterInitializationMode": "refused by fmi2EnterInitializationMode",
    "crash_in_fmi2EnterInitializationMode": "crashed during fmi2EnterInitializationMode",
    "crash_in_fmi2ExitInitializationMode": "crashed during fmi2ExitInitializationMode",
    "crash_in_fmi2GetFMUstate": "crashed during fmi2GetFMUstate",
    "error_in_fmi2GetFMUstate": "refused by fmi2GetFMUstate",
    "crash_in_fmi2SetFMUstate": "crashed during fmi2SetFMUstate",
    "error_in_fmi2SetFMUstate": "refused by fmi2SetFMUstate",
    "crash_in_fmi2GetDirectionalDerivative": "crashed during fmi2GetDirectionalDerivative",
    "error_in_fmi2GetDirectionalDerivative": "refused by fmi2GetDirectionalDerivative",
    "error_in_fmi2SetReal": "refused by fmi2SetReal",
    "crash_in_fmi2GetReal": "crashed during fmi2GetReal, with signal 11",
    "nan_in_outputs": "is nan",
    "infinite_outputs": "is -inf",
    "nan_in_observations": "observation",
    "crash": "crashed during fmi2DoStep, with signal 11",
    "abort": "crashed during fmi2DoStep, with signal 6",
    "division": "crashed during fmi2DoStep, with signal 8",
    "illegal": "crashed during fmi2DoStep, with signal 4",
    "stack": "crashed during fmi2DoStep, with signal 11",
    "heap": "crashed during fmi2",
    "thread": "crashed during fmi2DoStep, with signal 11",
    "exit": "exit code 0 during fmi2DoStep",
    "exit_at_once": "exit code 3 during fmi2DoStep",
    "fork_and_exit": "exit code 0 during fmi2DoStep",
    "killed": "crashed during fmi2DoStep, with signal 9",
    "hang": "it hangs, fmi2DoStep",
    "sleep": "it hangs, fmi2DoStep",
    "stopped": "it hangs, fmi2DoStep",
    "closed_files": "exit code 0 during fmi2",
    "error": "magnet",
    "error_no_word": "cannot do a step",
    "discard": "cannot do a step",
    "fatal": "cannot do a step",
    "pending": "cannot do a step",
    "odd_status": "cannot do a step",
}
"""What a run ends with, and what its sentence says."""
_HELD = 3
"""Rows that the step under way may cost, beside the one that is held back for the step after it."""
_AT_ONCE = ("instan", "fmi2Setup", "fmi2Enter", "fmi2Exit", "FMUstate", "Derivative")
"""Of kinds that do not wait for their time."""


class Broken(NamedTuple):
    """A kind of fault, of which FMU, and the time (s) from which on it has it."""

    kind: str
    owner: str
    time: float


@cache
def wing() -> Assembly:
    """Two panels on a fixed base."""
    return assemble(load_scene(SCENE))


@cache
def binary(folder: Path) -> bytes:
    """The binary that breaks, compiled once for a folder."""
    target = folder / f"faulty{suffix()}"
    compile_files([Path(__file__).with_name("faulty_fmu.c")], target, ("-O1", "-fPIC", "-pthread"))
    return target.read_bytes()


def broken_fmu(sound: Path, broken: Broken, folder: Path) -> Path:
    """A native FMU with a fault, in a file of the same name."""
    path = folder / "broken" / sound.name
    path.parent.mkdir(exist_ok=True)
    with zipfile.ZipFile(sound) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            is_binary = name.startswith("binaries/")
            new.writestr("resources/sound.so" if is_binary else name, old.read(name))
            if is_binary:
                new.writestr(name, binary(folder))
        new.writestr("resources/fault", f"{broken.kind} {broken.time!r}")
    return path


def loader(broken: Broken, folder: Path, longest_call: float = LONGEST_CALL) -> Loader:
    """The FMUs of an assembly, one of them broken."""

    @contextmanager
    def load(assembly: Assembly) -> Iterator[Sequence[FmuParticipant]]:
        with ExitStack() as stack:
            participants = []
            for path in export(assembly, folder / "sound"):
                chosen = broken_fmu(path, broken, folder) if path.stem == broken.owner else path
                participants.append(FmuParticipant(path.stem, chosen, longest_call=longest_call))
                stack.callback(participants[-1].close)
            yield participants

    return load


def faults(
    count: int, first: int, folder: Path, kinds: Sequence[str] = (*FAILING, *SOUND)
) -> Iterator[Fault]:
    """Faults of so many runs, whose kinds take turns."""
    for seed in range(first, first + count):
        dice = Random(seed)
        owner = dice.choice([part.name for part in wing().parts])
        broken = Broken(kinds[seed % len(kinds)], owner, dice.uniform(0.01, 0.9 * UNTIL))
        if what := answer(broken, folder):
            yield Fault(seed, f"{broken}: {what}")


def answer(broken: Broken, folder: Path) -> str:
    """What went wrong with a run; empty where it went as it should."""
    path = folder / "run.h5"
    path.unlink(missing_ok=True)
    try:
        run(wing(), path, Settings(), UNTIL, load=loader(broken, folder))
        sentence = ""
    except RunError as error:
        sentence = str(error)
    return _sentence_problem(broken, sentence) or _rows_problem(broken, path) or _left_behind()


def _sentence_problem(broken: Broken, sentence: str) -> str:
    if broken.kind in SOUND:
        return f"the run ended with: {sentence}" if sentence else ""
    if not sentence:
        # FMUs without directional derivatives of their own are never asked for them
        return "" if "Derivative" in broken.kind else "the run ended well"
    wanted = FAILING[broken.kind]
    named = sentence.startswith(f"two_panels: {broken.owner}: ") and "\n" not in sentence
    return "" if named and wanted in sentence else f"the sentence is: {sentence}"


def _rows_problem(broken: Broken, path: Path) -> str:
    if broken.kind in FAILING and any(text in broken.kind for text in _AT_ONCE):
        return ""
    found = Result.open(path)
    signals = {key: found.signal(*key) for key in _keys(found)}
    if not all(np.isfinite(values).all() for values in signals.values()):
        return "there are rows that are not finite"
    if broken.kind in SOUND:
        unlike = [key for key in signals if not np.array_equal(signals[key], _sound_run().signal(*key))]
        return f"{unlike[0]} differs from the run of the sound FMU" if unlike else ""
    before = [time for time in _sound_run().time if time < broken.time]
    if found.complete:
        return "the result counts as complete"
    return "" if len(before) - found.time.size <= _HELD else f"rows end at {found.time[-1]:g} s"


@cache
def _sound_run() -> Result:
    return run(wing(), None, Settings(), UNTIL).result


def _keys(result: Result) -> list[tuple[str, str]]:
    return [(component, name) for component in result.components for name in result.variables(component)]


def _left_behind() -> str:
    """Processes of FMUs that this one still has, where the system lists them."""
    lists = Path("/proc/self/task").glob("*/children")
    commands = [Path(f"/proc/{child}/cmdline") for one in lists for child in one.read_text().split()]
    left = [one for one in commands if one.exists() and b"child.py" in one.read_bytes()]
    return f"{len(left)} processes were left behind" if left else ""


if __name__ == "__main__":
    main(faults, "broken FMUs", len(FAILING) + len(SOUND))
