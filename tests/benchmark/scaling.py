"""Cost of a step against the number of panels: our master beside monolithic Exudyn models of the same chains.

    python -m tests.benchmark.scaling [--largest 128] [--steps 200] [--rounds 3]

Chains of 2 to 128 panels, folded like an accordion, opened by their springs; every model takes the same number of
steps of 5 ms, its iteration converged to 1e-6 (relative). Ours and "bushings" have the same six-axis bushings
and, flexible, the same 28 modes a panel; "tree" has ideal joints in minimal coordinates, rigid panels, and either
the implicit solver or the classical Runge-Kutta of order 4 with the same step. Wall times are the best of the
interleaved rounds (one if it takes over a second), without building, loading and assembling. The angles of the
outermost line at the end show that all compute the same motion.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Sequence
from time import perf_counter
from typing import NamedTuple

import numpy as np

from fmus import Backend, native_library
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.settings import Settings
from tests.benchmark.models.chain import Chain, as_instances, panel
from tests.benchmark.models.exudyn_chain import Outcome, bushings, tree
from tests.references.record import Record

STEP, TOLERANCE = 5e-3, 1e-6
PYTHON_LARGEST = 8
SLOW = 1.0


class Cell(NamedTuple):
    """One measurement: cost of a step (s), sweeps per step where there are any, angle at the end (rad)."""

    cost: float
    sweeps: float
    angle: float


def ours(chain: Chain, steps: int, backend: Backend) -> Cell:
    """Our master at a fixed step; its iteration tolerance is 1e-6 at the default tolerance of 1e-4."""
    parts, links = chain.parts()
    with as_instances(parts, backend) as participants:
        network = Network(participants, links, 4)
        record = Record(network)
        master = Master(network, [], record, Settings(fixed_step=STEP))
        master.initialize(preload=False)
        start = perf_counter()
        master.run(steps * STEP)
        wall = perf_counter() - start
    count = master.statistics.steps
    angle = float(record.signal(f"panel{chain.count - 1}_left", "angle")[-1])
    return Cell(wall / count, master.statistics.sweeps / count, angle)


def theirs(outcome: Outcome, steps: int) -> Cell:
    """A run of Exudyn."""
    return Cell(outcome.wall / steps, float("nan"), outcome.angle)


def series(steps: int) -> dict[str, Callable[[int], Cell | None]]:
    """What is measured for a number of panels; None where it would take too long."""
    rigid, flexible = panel(flexible=False), panel(flexible=True)

    def exact(solver: str) -> Callable[[int], Cell]:
        kind = "implicit" if solver == "implicit" else "explicit"
        return lambda n: theirs(tree(Chain(n, rigid), STEP, steps, TOLERANCE, kind), steps)

    def python(n: int) -> Cell | None:
        return ours(Chain(n, flexible), steps, "python") if n <= PYTHON_LARGEST else None

    found: dict[str, Callable[[int], Cell | None]] = {}
    if native_library():
        found["ours rigid"] = lambda n: ours(Chain(n, rigid), steps, "native")
    found["tree implicit"] = exact("implicit")
    found["tree RK4"] = exact("explicit")
    found["bushings rigid"] = lambda n: theirs(bushings(Chain(n, rigid), STEP, steps, TOLERANCE), steps)
    if native_library():
        found["ours flexible"] = lambda n: ours(Chain(n, flexible), steps, "native")
    found["bushings flexible"] = lambda n: theirs(bushings(Chain(n, flexible), STEP, steps, TOLERANCE), steps)
    found["PythonFMUs flexible"] = python
    return found


def measure(measured: dict[str, Callable[[int], Cell | None]], n: int, steps: int, rounds: int) -> list[Cell]:
    """All series for one number of panels, in interleaved rounds."""
    missing = Cell(np.nan, np.nan, np.nan)
    best = [run(n) or missing for run in measured.values()]
    for _ in range(rounds - 1):
        for i, run in enumerate(measured.values()):
            if best[i].cost * steps < SLOW:
                again = run(n) or missing
                best[i] = min(best[i], again, key=lambda cell: cell.cost)
    return best


def table(results: dict[int, list[Cell]], names: Sequence[str]) -> None:
    """Costs, sweeps and angles."""
    for title, entry, form in (
        ("cost of a step, us", lambda c: 1e6 * c.cost, ",.1f"),
        ("sweeps per step", lambda c: c.sweeps, ".2f"),
        ("angle of the outermost line at the end, rad", lambda c: c.angle, ".6f"),
    ):
        print(f"\n{title}\n{'panels':>8}" + "".join(f"{name:>21}" for name in names))
        for n, cells in results.items():
            texts = ["-" if np.isnan(entry(c)) else format(entry(c), form) for c in cells]
            print(f"{n:>8}" + "".join(f"{text:>21}" for text in texts))
    print(f"\n{'growth':>8}" + "".join(f"{f'n^{slope(results, i):.2f}':>21}" for i in range(len(names))))
    print("exponent of the cost between the two largest chains of each series")


def slope(results: dict[int, list[Cell]], i: int) -> float:
    """Exponent of growth at the large end."""
    known = [(n, cells[i].cost) for n, cells in results.items() if not np.isnan(cells[i].cost)][-2:]
    if len(known) < 2:
        return float("nan")
    (a, cost_a), (b, cost_b) = known
    return float(np.log(cost_b / cost_a) / np.log(b / a))


def main() -> None:
    """Command line."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--largest", type=int, default=128)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=3)
    chosen = parser.parse_args()
    measured = series(chosen.steps)
    results: dict[int, list[Cell]] = {}
    n = 2
    while n <= chosen.largest:
        results[n] = measure(measured, n, chosen.steps, chosen.rounds)
        print(f"{n} panels measured", flush=True)
        n *= 2
    table(results, list(measured))


if __name__ == "__main__":
    main()
