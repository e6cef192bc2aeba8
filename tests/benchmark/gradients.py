"""What derivatives by ten parameters cost, and what they err by: AMOS-3.

    python -m tests.benchmark.gradients [--flexible] [--until T] [--tolerance T] [--rounds N]

First the processor time of a run, of one with its derivatives by ten keys, and of these with verification, in turns;
the least of each counts. Then the error of every gradient, over the gradient as a whole.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from time import process_time

import orchestrator as fanfold
from orchestrator.results.estimated_errors import PROMISED

KEYS = (
    "hinge_line.HL1.motor.stowed",
    "hinge_line.HL2.motor.stowed",
    "hinge_line.HL3.motor.stowed",
    "hinge_line.HL1.motor.deployed",
    "friction.coefficient",
    "hinge_line.HL2.friction_preload",
    "hinge_line.HL1.latch.stiffness,hinge_line.HL1.latch.outboard_stiffness",
    "ccl.yoke_loop.preload",
    "ccl.panel_loop.strand_stiffness",
    "damper.damper.damping_coefficient",
)
"""Of motors, friction, latch, cable loops and damper."""


def seconds(work: Callable[[], object]) -> float:
    """Processor time (s) of some work."""
    start = process_time()
    work()
    return process_time() - start


def main() -> None:
    """Print the table."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--flexible", action="store_true")
    parser.add_argument("--until", type=float, default=12.5)
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--rounds", type=int, default=3)
    chosen = parser.parse_args()
    scene, rigid = fanfold.load("amos3"), () if chosen.flexible else "all"
    common = {"until": chosen.until, "tolerance": chosen.tolerance, "rigid": rigid}
    works: dict[str, Callable[[], object]] = {
        "a run": lambda: fanfold.simulate(scene, estimate=False, **common),
        "with derivatives": lambda: fanfold.gradients(scene, KEYS, verify=False, **common),
        "and verification": lambda: fanfold.gradients(scene, KEYS, **common),
    }
    rounds = [[seconds(work) for work in works.values()] for _ in range(chosen.rounds)]
    least = [min(times) for times in zip(*rounds, strict=True)]
    for name, time in zip(works, least, strict=True):
        print(f"{name:18} {time:7.3f} s {time / least[0]:6.2f} runs")
    found = fanfold.gradients(scene, KEYS, **common)
    for number, error in zip(found.numbers, found.errors.tolist(), strict=True):
        if number.quantity in PROMISED:
            print(f"  {' '.join(number.key):26} {error:8.1e}")


if __name__ == "__main__":
    main()
