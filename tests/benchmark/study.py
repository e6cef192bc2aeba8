"""A thousand samples of flexible AMOS-3: samples a second beside the time of one run, memory of a worker.

    python -m tests.benchmark.study [--runs 1000] [--workers 2] [--tolerance 2e-3]

First how far the peaks of a run at the tolerance are off one at 1e-6, which is to be less than a percent, and the time
of one run, the median of several in a process that has made one before, as a user would count it. Then the study.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from threading import Event, Thread
from time import perf_counter

import orchestrator as fanfold

SCENE, UNTIL = "amos3", 14.0
VARY = {
    "friction.coefficient": "uniform(0.05, 0.2)",
    "hinge_line.HL1.motor.stowed,hinge_line.HL1.motor.deployed*": "normal(1, 0.03)",
    "damper.damper.damping_coefficient*": "uniform(0.8, 1.2)",
}
REFERENCE, REPEATS = 1e-6, 5
PEAKS = ("latch torque peak", "interface force peak", "interface torque peak")


def simulate(tolerance: float) -> fanfold.Result:
    """One run in memory."""
    return fanfold.simulate(SCENE, until=UNTIL, tolerance=tolerance, estimate=False)


def peak_error(found: fanfold.Result, reference: fanfold.Result) -> float:
    """The largest error of a peak: of latch torques over themselves, of loads over the largest component."""
    here, true = (
        {n.key: n.value for n in one.headline.numbers() if n.quantity in PEAKS} for one in (found, reference)
    )
    sizes = {
        key: value if key[0] == PEAKS[0] else max(v for other, v in true.items() if other[0] == key[0])
        for key, value in true.items()
    }
    return max(abs(here[key] - true[key]) / sizes[key] for key in true)


def one_run(tolerance: float) -> float:
    """Wall time of a run, s."""
    found = []
    for _ in range(REPEATS):
        start = perf_counter()
        simulate(tolerance)
        found.append(perf_counter() - start)
    return median(found)


def descendants(process: int) -> Iterator[int]:
    """Processes that a process has started, and those that these have."""
    for children in Path(f"/proc/{process}/task").glob("*/children"):
        for child in map(int, children.read_text().split()):
            yield child
            yield from descendants(child)


class Memory:
    """Watches the largest memory (MB) that any process below this one takes; Linux only."""

    def __init__(self) -> None:
        self.largest = 0.0
        self._done = Event()
        self._thread = Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Memory:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join()

    def _watch(self) -> None:
        own = int(Path("/proc/self/stat").read_text().split()[0])
        while not self._done.wait(1.0):
            for process in descendants(own):
                try:
                    rows = Path(f"/proc/{process}/status").read_text().splitlines()
                except OSError:
                    continue
                high = [int(row.split()[1]) / 1024.0 for row in rows if row.startswith("VmHWM")]
                self.largest = max([self.largest, *high])


def main() -> None:
    """Print the figures."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--tolerance", type=float, default=2e-3)
    chosen = parser.parse_args()
    error = peak_error(simulate(chosen.tolerance), simulate(REFERENCE))
    print(f"tolerance {chosen.tolerance:g}: peaks are off by {error:.2%}")
    before = one_run(chosen.tolerance)
    with Memory() as memory:
        start = perf_counter()
        found = fanfold.study(
            SCENE, VARY, runs=chosen.runs, workers=chosen.workers, until=UNTIL, tolerance=chosen.tolerance
        )
        seconds = perf_counter() - start
    after = one_run(chosen.tolerance)
    run = 0.5 * (before + after)
    rate = chosen.runs / seconds
    failed = sum(bool(message) for message in found.messages)
    print(
        f"one run {before:.2f} s before, {after:.2f} s after; "
        f"{chosen.runs} samples in {seconds:.0f} s, {failed} failed: "
        f"{rate:.2f} a second, {rate * run / chosen.workers:.2f} x {chosen.workers} / (time of one run); "
        f"{memory.largest:.0f} MB the largest worker"
    )


if __name__ == "__main__":
    main()
