"""What a process of its own costs an FMU: every FMU of a scene stepped here and there in turns, and the whole run.

python -m tests.benchmark.faults.cost [SCENE]
"""

from __future__ import annotations

import sys
import tempfile
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus, export, run
from orchestrator.scene import find_scene, load_scene

ROUNDS, STEPS, STEP = 21, 200, 1e-4


class Times(NamedTuple):
    """Microseconds a step: here, and more in a process of its own, by the shortest of rounds taken in turns.

    Whatever else a machine does makes a round longer, never shorter.
    """

    here: float
    more: float


def seconds(participant: FmuParticipant) -> float:
    """Of some steps as the master makes them."""
    begin = perf_counter()
    for _ in range(STEPS):
        participant.restore()
        participant.write()
        participant.do_step(0.0, STEP)
        participant.read()
    return perf_counter() - begin


def measure(path: Path) -> Times:
    """One FMU twice, in turns."""
    pair = [FmuParticipant(path.stem, path, isolate=isolate) for isolate in (False, True)]
    for participant in pair:
        participant.initialize(0.0)
        participant.save()
    rounds = [(seconds(pair[0]), seconds(pair[1])) for _ in range(ROUNDS)]
    for participant in pair:
        participant.close()
    here, apart = map(min, zip(*rounds, strict=True))
    return Times(1e6 * here / STEPS, 1e6 * (apart - here) / STEPS)


def whole_run(assembly: Assembly) -> str:
    """Wall time of the steps of a run, here and isolated, and the difference by sweep and FMU."""
    here, apart = (
        run(assembly, None, Settings(assembly.tolerance), load=partial(as_fmus, isolate=isolate)).costs
        for isolate in (False, True)
    )
    more = 1e6 * (apart.wall_time - here.wall_time) / (here.iterations * len(assembly.parts))
    times = f"{here.wall_time:.2f} s here, {apart.wall_time:.2f} s with all isolated"
    return f"run: {times}, {more:.1f} us more for a step of an FMU"


def main(arguments: list[str]) -> None:
    """Print the table."""
    assembly = assemble(load_scene(find_scene(arguments[0] if arguments else "amos3")))
    print(f"{'FMU':<14} {'us a step here':>16} {'more if isolated':>18}")
    with tempfile.TemporaryDirectory() as folder:
        for path in export(assembly, Path(folder)):
            times = measure(path)
            print(f"{path.stem:<14} {times.here:16.2f} {times.more:18.2f}", flush=True)
    print(whole_run(assembly))


if __name__ == "__main__":
    main(sys.argv[1:])
