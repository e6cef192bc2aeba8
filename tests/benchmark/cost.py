"""Where the time of a deployment goes: kernels, FMI calls, linear algebra, bookkeeping; native FMUs of AMOS-3.

    python -m tests.benchmark.cost [--rigid]

Kernels are timed inside C (`call_times`); FMUs as a whole by the engine, around its calls; the rest by clocks
around the master's own functions. The last column is microseconds per FMU and iteration.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

from orchestrator import coupling, result
from orchestrator.engine import Engine
from orchestrator.master import Settings
from orchestrator.run import run
from orchestrator.scene import assemble, find_scene, load_scene
from tests.benchmark.call_times import build, measure

UNTIL, TOLERANCE, REPEATS = 12.0, 3e-3, 3


class Clock:
    """Adds up the time inside functions that it replaces."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def around(self, owner: Any, name: str, label: str) -> Callable[[], None]:
        """Replace a function of a class or module; the result puts it back."""
        original = getattr(owner, name)

        def timed(*args: Any, **kwargs: Any) -> Any:
            start = perf_counter()
            try:
                return original(*args, **kwargs)
            finally:
                self.seconds[label] = self.seconds.get(label, 0.0) + perf_counter() - start

        setattr(owner, name, timed)
        return lambda: setattr(owner, name, original)


def kernels_of_a_sweep(scene: Any) -> float:
    """Seconds that the equations of all FMUs take in one sweep."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = build(folder)
        times = [measure(program, part, folder) for part in scene.parts]
    return 1e-9 * sum(t.step + t.outputs for t in times)


def main(arguments: list[str]) -> None:
    """Print the table."""
    loaded = load_scene(find_scene("amos3"))
    fidelity = {"rigid" if "--rigid" in arguments else "flexible": {"all"}}
    assembly = assemble(loaded, **fidelity)
    settings = Settings(tolerance=TOLERANCE, largest_step=assembly.largest_step)
    kernels = kernels_of_a_sweep(assembly)
    with tempfile.TemporaryDirectory() as name:
        outcomes = [run(assembly, Path(name) / "run.h5", settings, UNTIL) for _ in range(REPEATS)]
        best = min(outcomes, key=lambda o: o.costs.wall_time).costs
        clock = Clock()
        back = [
            clock.around(Engine, "iterate", "iteration"),
            clock.around(Engine, "resume", "iteration"),
            clock.around(coupling.Coupling, "_probed", "interface Jacobian"),
            clock.around(Engine, "save", "states and observations"),
            clock.around(Engine, "observe", "states and observations"),
            clock.around(result.ResultWriter, "append", "recording"),
        ]
        run(assembly, Path(name) / "run.h5", settings, UNTIL)
        for undo in back:
            undo()
    calls = best.iterations * len(assembly.parts)
    inside = best.fmu_time_share * best.wall_time
    found = {
        "kernels": kernels * best.iterations,
        "FMI calls": inside - kernels * best.iterations,
        "linear algebra, convergence": clock.seconds.pop("iteration") - inside,
        **clock.seconds,
    }
    found["time stepping in Python"] = best.wall_time - sum(found.values())
    kind = next(iter(fidelity))
    print(
        f"amos3 {kind}, {UNTIL:g} s, tolerance {TOLERANCE:g}: {best.wall_time:.2f} s, "
        f"{UNTIL / best.wall_time:.1f} times real time"
    )
    print(f"{best.steps} steps, {best.iterations} iterations, {len(assembly.parts)} FMUs")
    print(f"{'':30} {'s':>7} {'share':>6} {'us per FMU and iteration':>26}")
    for label, seconds in found.items():
        print(f"{label:30} {seconds:7.3f} {seconds / best.wall_time:6.0%} {1e6 * seconds / calls:26.2f}")
    master = best.wall_time - found["kernels"]
    print(
        f"{'master: all but kernels':30} {master:7.3f} {master / best.wall_time:6.0%} {1e6 * master / calls:26.2f}"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
