"""Where the time of a deployment goes: kernels, FMI calls, linear algebra, bookkeeping; native FMUs of AMOS-3.

    python -m tests.benchmark.cost [--rigid]

Kernels are timed inside C (`call_times`); FMUs as a whole by the native solver, around its calls; the rest by clocks
around the master's own functions. Of several runs the fastest counts. The last column is microseconds per FMU
and iteration.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.cosim.implicit.interface_jacobian import InterfaceJacobian
from orchestrator.cosim.implicit.native_solver import NativeSolver
from orchestrator.cosim.ports import PortPlaces, Width
from orchestrator.cosim.settings import Settings
from orchestrator.results import result_file
from orchestrator.run.run import Costs, run
from orchestrator.scene import find_scene, load_scene
from tests.benchmark.call_times import Times, build, measure

UNTIL, TOLERANCE, REPEATS = 12.0, 3e-3, 5


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


def kernel_times(assembly: Assembly) -> dict[str, Times]:
    """Nanoseconds that the equations of every FMU take, call by call."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = build(folder)
        return {part.name: measure(program, part, folder) for part in assembly.parts}


def derivatives_taken(follow: Callable[[], object]) -> Counter[str]:
    """How many directional derivatives of every FMU a run asks for."""
    taken: Counter[str] = Counter()
    original = FmuParticipant.interface_jacobian

    def counted(participant: FmuParticipant, places: PortPlaces, width: Width) -> Any:
        taken[participant.name] += width.jacobian(places)[1]
        return original(participant, places, width)

    FmuParticipant.interface_jacobian = counted  # type: ignore[method-assign]
    try:
        follow()
    finally:
        FmuParticipant.interface_jacobian = original  # type: ignore[method-assign]
    return taken


def clocked(follow: Callable[[], Costs]) -> tuple[Costs, dict[str, float]]:
    """What a run cost, and its seconds inside the master's functions."""
    clock = Clock()
    back = [
        clock.around(NativeSolver, "_iterate", "iteration"),
        clock.around(InterfaceJacobian, "matrices", "interface Jacobian"),
        clock.around(NativeSolver, "accept", "states and observations"),
        clock.around(NativeSolver, "observe", "states and observations"),
        clock.around(result_file.ResultWriter, "append", "recording"),
        clock.around(result_file.ResultWriter, "__init__", "making the result file"),
    ]
    costs = follow()
    for undo in back:
        undo()
    return costs, clock.seconds


def report(found: Mapping[str, float], wall: float, calls: int) -> None:
    """Print the parts and what the master's make together."""
    print(f"{'':30} {'s':>7} {'share':>6} {'us per FMU and iteration':>26}")
    master = sum(seconds for label, seconds in found.items() if "kernels" not in label)
    for label, seconds in (*found.items(), ("master: all but kernels", master)):
        print(f"{label:30} {seconds:7.3f} {seconds / wall:6.0%} {1e6 * seconds / calls:26.2f}")


def main(arguments: list[str]) -> None:
    """Print the table."""
    kind = "rigid" if "--rigid" in arguments else "flexible"
    assembly = assemble(load_scene(find_scene("amos3")), **{kind: {"all"}})
    settings = Settings(tolerance=TOLERANCE, largest_step=assembly.largest_step, compiled=False)
    kernels = kernel_times(assembly)
    with tempfile.TemporaryDirectory() as name:

        def follow() -> Costs:
            return run(assembly, Path(name) / "run.h5", settings, UNTIL).costs

        runs = [clocked(follow) for _ in range(REPEATS)]
        best, seconds = min(runs, key=lambda found: found[0].wall_time)
        taken = derivatives_taken(follow)
    stepping = 1e-9 * best.iterations * sum(times.step + times.outputs for times in kernels.values())
    derivatives = 1e-9 * sum(count * kernels[name].derivative for name, count in taken.items())
    inside = best.fmu_time_share * best.wall_time
    found = {
        "kernels: steps": stepping,
        "kernels: derivatives": derivatives,
        "FMI calls": inside - stepping,
        "linear algebra, convergence": seconds.pop("iteration") - inside - seconds["interface Jacobian"],
        "interface Jacobian": seconds.pop("interface Jacobian") - derivatives,
        **seconds,
    }
    found["time stepping in Python"] = best.wall_time - sum(found.values())
    speed = UNTIL / best.wall_time
    print(
        f"amos3 {kind}, {UNTIL:g} s, tolerance {TOLERANCE:g}: {best.wall_time:.2f} s, {speed:.1f} times real time"
    )
    print(f"{best.steps} steps, {best.iterations} iterations, {len(assembly.parts)} FMUs")
    report(found, best.wall_time, best.iterations * len(assembly.parts))


if __name__ == "__main__":
    main(sys.argv[1:])
