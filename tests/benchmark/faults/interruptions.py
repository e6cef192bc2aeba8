"""Does an interrupted run go on as if nothing had been? Runs of all built-in scenes are interrupted by seed.

    python -m tests.benchmark.faults.interruptions [COUNT] [FIRST_SEED]

Rigid and flexible, on fixed and free bases, with latch-ups, contact, friction that sticks, joints that fail and motors
that stop: each run is ended as by Ctrl-C at a random time between its first and last event, or after the first where
it has one, resumed, by chance interrupted again, and compared with the run that was not interrupted: times, events,
statistics and every signal, bit by bit.
Without COUNT there are 50 interruptions, which take turns among the runs.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import orchestrator as fanfold
from orchestrator.results.result import Result
from tests.benchmark.faults.kills import differences

_SCENES = Path(__file__).parents[2] / "scenes"
_RESUMED = 0.6
"""Probability that a resumed run is not interrupted again."""


class Run(NamedTuple):
    """A run to interrupt: what is laid over a scene, its variant, and the options of `simulate`.

    until, checkpoint: s.
    """

    scene: str
    until: float
    checkpoint: float
    over: str = ""
    variant: str = ""
    options: Mapping[str, Any] = {"rigid": "all", "estimate": False}


FLEXIBLE = {"estimate": False}
_STICKING = "".join(
    f"[[hinge_line]]\nname = 'HL{n}'\npresliding = {{ stiffness = '2e4 N.m/rad' }}\n" for n in (1, 2, 3)
)
_MOTOR_STOPS = """
[[event]]
name = "motor_stops"
when = { component = "HL1", variable = "angle", above = "60 deg" }
set = { HL2 = { motor_stiffness = 0 } }
"""
_JOINT_FAILS = """
[[event]]
name = "joint_fails"
time = "0.8 s"
release = ["x_mid_1"]
"""
_HINGE_FAILS = """
[[event]]
name = "slows"
time = "2 s"
set = { HL = { friction_preload = "0.3 N.m" } }
[[event]]
name = "hinge_fails"
time = "4.5 s"
release = ["hinge_left"]
"""
WITH_EVENTS = Run("workbench", 5.0, 0.35, _HINGE_FAILS, options=FLEXIBLE)
_SOONER = "[[connection]]\nname = 'sadm'\nparameters.duration = '20 s'\n"
RUNS = (
    Run("amos3", 12.3, 0.7),
    Run("amos3", 12.0, 1.3, options=FLEXIBLE),
    Run("amos3", 12.3, 0.9, _STICKING, "spring_latch", {"rigid": "all"}),
    Run("amos3", 12.0, 1.1, _STICKING + _MOTOR_STOPS, "free"),
    Run("amos3", 11.8, 1.7, variant="free", options=FLEXIBLE),
    Run("amos3-ground", 14.8, 1.2),
    Run(
        "bepicolombo", 5.0, 0.4, "[[hinge_line]]\nname = 'HL1'\npresliding = { stiffness = '4e3 N.m/rad' }\n"
    ),
    Run("bepicolombo", 4.9, 0.6, variant="impact"),
    Run("bepicolombo", 4.8, 0.9, options=FLEXIBLE),
    Run("arabsat", 11.0, 1.0, variant="phase1", options=FLEXIBLE),
    Run("arabsat", 22.0, 1.5, _SOONER, "phase2", FLEXIBLE),
    Run("antenna-unit", 1.4, 0.3, _JOINT_FAILS),
    WITH_EVENTS,
    Run(str(_SCENES / "four_panels_free.toml"), 22.0, 2.1),
)
"""Their ends leave some time after the last latch-up or event."""


class Interruption(NamedTuple):
    """The seed that repeats it, the run, when (s) and between how many events, and what was wrong if anything."""

    seed: int
    run: Run
    times: tuple[float, ...]
    before: int
    after: int
    fault: str


def interruptions(count: int, first: int, folder: Path, runs: Sequence[Run] = RUNS) -> Iterator[Interruption]:
    """So many interruptions, whose runs take turns; of each one the first is not interrupted."""
    wholes: dict[int, Path] = {}
    for seed in range(first, first + count):
        number = seed % len(runs)
        run = runs[number]
        if number not in wholes:
            wholes[number] = folder / f"whole{number}.h5"
            _start(run, folder, wholes[number], None)
        yield _interrupted(seed, run, wholes[number], folder)


def _interrupted(seed: int, run: Run, whole: Path, folder: Path) -> Interruption:
    """One run that is interrupted, resumed, and by chance interrupted again later."""
    dice, path = Random(seed), folder / "cut.h5"
    events = [time for time, _, _ in Result.open(whole).events]
    times = [dice.uniform(max(run.checkpoint, events[0]), events[-1] if len(events) > 1 else run.until)]
    begun = _start(run, folder, path, times[0])
    while not begun and dice.random() > _RESUMED:
        times.append(dice.uniform(times[-1], run.until))
        begun = _resume(path, times[-1])
    if not begun:
        _resume(path, None)
    before = sum(time < times[0] for time in events)
    return Interruption(seed, run, tuple(times), before, len(events) - before, differences(whole, path))


def _start(run: Run, folder: Path, path: Path, stop: float | None) -> bool:
    """Begin a run, stopped at a time; whether it came to its end."""
    scene = folder / "scene.toml"
    scene.write_text(f"extends = '{run.scene}'\n{run.over}", encoding="utf-8")
    loaded = fanfold.load(scene, run.variant or ())
    path.unlink(missing_ok=True)
    return _ended(
        lambda: fanfold.simulate(
            loaded,
            until=run.until, checkpoint=run.checkpoint, save=path, progress=_stopping(stop), **run.options,
        )
    )  # fmt: skip


def _resume(path: Path, stop: float | None) -> bool:
    return _ended(lambda: fanfold.resume(path, progress=_stopping(stop)))


def _ended(what: Callable[[], object]) -> bool:
    """Do it; False where it was interrupted, and any other error as it is."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fanfold.FanfoldWarning)
        try:
            what()
        except fanfold.FanfoldError as error:
            if "interrupted at" not in str(error):
                raise
            return False
    return True


def _stopping(stop: float | None) -> Callable[[str, float], Any]:
    """A display that ends the run, but not the one that shows errors, at a time as Ctrl-C does."""

    @contextmanager
    def display(name: str, end: float) -> Iterator[Callable[[float, float], None]]:
        def watch(time: float, h: float) -> None:
            if stop is not None and time >= stop and not name.endswith("errors"):
                raise KeyboardInterrupt

        yield watch

    return display


if __name__ == "__main__":
    number, start_seed = map(int, (*sys.argv[1:], *("50", "0")[len(sys.argv) - 1 :])[:2])
    with tempfile.TemporaryDirectory() as place:
        found = []
        for one in interruptions(number, start_seed, Path(place)):
            found.append(one)
            at = ", ".join(f"{time:.3f}" for time in one.times)
            print(
                f"seed {one.seed}: {Path(one.run.scene).stem} {one.run.variant} at {at} s, "
                f"{one.before} events before, {one.after} after: {one.fault or 'every bit the same'}",
                flush=True,
            )
    between = sum(one.before > 0 and one.after > 0 for one in found)
    faults = sum(bool(one.fault) for one in found)
    print(f"{number} interruptions from seed {start_seed}, {between} between events: {faults} faults")
    sys.exit(bool(faults))
