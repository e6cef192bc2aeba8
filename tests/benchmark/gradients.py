"""What derivatives by ten parameters cost, and how far they are from differences of runs: AMOS-3.

    python -m tests.benchmark.gradients [--flexible] [--central] [--until T] [--tolerance T] [--rounds N]
        [--differences]

First the processor time of a run, and of one with its ten neighbours, in turns; the least of each counts. Then, with
--differences, the gradient of every latch time, peak and interface load beside central differences of two runs of
their own for each key: along the steps of the run at the parameters, so that step control is not in the difference,
each ending its steps at its own events, iterated to round-off. Gradients are relative, percent by percent; errors are
over the gradient as a whole.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from time import process_time
from typing import Any
from unittest.mock import patch

import numpy as np

import orchestrator as fanfold
from orchestrator.analysis.sampling.gradients import CENTRAL_PART, Gradients, Parameter, gradients, parameter
from orchestrator.analysis.sampling.neighbours import Followed, run_beside
from orchestrator.cosim import stepping
from orchestrator.cosim.events import crossings
from orchestrator.results.estimated_errors import PROMISED
from orchestrator.run.run import Outcome, run
from orchestrator.run.simulation import Options
from orchestrator.scene.builder import Scene

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
ITERATED = 1e-8
"""Tolerance whose iterations end above round-off, where they would wander, and divide steps; steps are given."""
DIFFERENCE = CENTRAL_PART
"""Of a key, to each side: that of the gradients, as kinks of laws between two parts are in both differences."""
MET = 1e-14
"""Distance at which runs of their own meet events; what it leaves, a lock of 1e8 N.m/rad makes a torque of."""


def least(times: int, work: Callable[[], object]) -> float:
    """Processor time (s) of some work, the least of several times."""
    found = []
    for _ in range(times):
        start = process_time()
        work()
        found.append(process_time() - start)
    return min(found)


def beside(
    scene: Scene, options: Options, one: Parameter, value: float, plan: Sequence[Sequence[float]]
) -> Outcome:
    """A run of its own with another value of a parameter."""
    assembly = options.assemble(scene.with_settings(one.settings(scene.tree, value)).check_one_run())
    settings = replace(options.settings(assembly), tolerance=ITERATED, step_plan=plan)
    return run(assembly, None, settings, options.until)


def values(outcome: Outcome) -> dict[tuple[str, str], float]:
    """Headline numbers that a run promises."""
    return {one.key: one.value for one in outcome.headline.numbers() if one.quantity in PROMISED}


def differences(
    scene: Scene, options: Options, one: Parameter, plan: Sequence[Sequence[float]]
) -> Mapping[tuple[str, str], float]:
    """Central differences by a parameter, of runs along the steps of one at its value."""
    step = DIFFERENCE * abs(one.value)
    high, low = (values(beside(scene, options, one, one.value + way * step, plan)) for way in (1.0, -1.0))
    return {key: (high[key] - low[key]) / (2.0 * step) for key in high}


def followed(
    scene: Scene, options: Options, keys: Sequence[str], *, central: bool
) -> tuple[Gradients, Sequence[Sequence[float]]]:
    """Gradients by some keys, and the steps (s) of their run as a plan: other neighbours have it make other steps."""
    runs: list[Followed] = []

    def kept(*arguments: Any, **named: Any) -> Followed:
        runs.append(run_beside(*arguments, **named))
        return runs[-1]

    with patch("orchestrator.analysis.sampling.gradients.run_beside", kept):
        found = gradients(scene, options, keys, central=central)
    return found, stepping.to_own_events(runs[-1].segments)


def compare(scene: Scene, options: Options, found: Gradients, plan: Sequence[Sequence[float]]) -> None:
    """Print the error of every number's gradient, whose parts are its changes by the whole of each key."""
    sizes = np.array(found.values)
    true = [differences(scene, options, parameter(scene.tree, key), plan) for key in found.keys]
    for row, number in zip(found.derivatives, found.numbers, strict=True):
        if number.quantity in PROMISED:
            reference = np.array([one[number.key] for one in true]) * sizes
            error = np.abs(row * sizes - reference)
            worst = found.keys[int(np.argmax(error))].partition(",")[0]
            whole = float(np.linalg.norm(reference))
            print(
                f"  {' '.join(number.key):26} {whole / number.value:8.2g} {np.linalg.norm(error) / whole:8.1e}  {worst}"
            )


def main() -> None:
    """Print the table."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--flexible", action="store_true")
    parser.add_argument("--central", action="store_true")
    parser.add_argument("--differences", action="store_true")
    parser.add_argument("--until", type=float, default=12.5)
    parser.add_argument("--tolerance", type=float, default=1e-4)
    parser.add_argument("--rounds", type=int, default=3)
    chosen = parser.parse_args()
    scene = fanfold.load("amos3")
    fidelity: dict[str, object] = {} if chosen.flexible else {"rigid": "all"}
    common = {"until": chosen.until, "tolerance": chosen.tolerance, **fidelity}
    runs = beside_keys = np.inf
    for _ in range(chosen.rounds):
        runs = min(runs, least(1, lambda: fanfold.simulate(scene, estimate=False, **common)))
        beside_keys = min(
            beside_keys,
            least(1, lambda: fanfold.gradients(scene, KEYS, central=chosen.central, verify=False, **common)),
        )
    print(
        f"a run {runs:.3f} s, with derivatives by {len(KEYS)} keys {beside_keys:.3f} s: {beside_keys / runs:.2f} runs"
    )
    if chosen.differences:
        crossings.EVENT_TOLERANCE = MET
        options = Options(
            until=chosen.until, tolerance=chosen.tolerance, **{k: frozenset({v}) for k, v in fidelity.items()}
        )
        print(f"  {'number':26} {'gradient':>8} {'error':>8}  most in")
        compare(scene, options, *followed(scene, options, KEYS, central=chosen.central))


if __name__ == "__main__":
    main()
