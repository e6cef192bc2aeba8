"""Run time of the AMOS-3 deployment over 12 s against its error, rigid and flexible, by back end and tolerance.

    python -m tests.benchmark.deployment [--python] [--error]

Prints wall time, steps, iterations and the share of FMU calls, for native FMUs and with --python for PythonFMUs
as well; --error adds the relative errors of latch times and latch torque peaks against a run of native FMUs at
a hundredth of the default tolerance.
"""

from __future__ import annotations

import sys
from functools import partial
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

from fmus import Backend
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import Outcome, as_fmus, run
from orchestrator.scene import find_scene, load_scene

UNTIL = 12.0
TOLERANCES = {"rigid": (1e-3, 1e-4), "flexible": (4e-3, 2e-3, 1e-3, 1e-4)}


def deploy(fidelity: str, tolerance: float, folder: Path, backend: Backend = "native") -> Outcome:
    """One deployment of AMOS-3, all bodies "rigid" or "flexible"."""
    scene = load_scene(find_scene("amos3"))
    everything = {"all"}
    assembly = assemble(
        scene, everything if fidelity == "rigid" else (), everything if fidelity == "flexible" else ()
    )
    settings = Settings(tolerance=tolerance, largest_step=assembly.largest_step)
    path = folder / f"{fidelity}-{tolerance:g}-{backend}.h5"
    return run(assembly, path, settings, UNTIL, load=partial(as_fmus, backend=backend))


def errors(found: Outcome, reference: Outcome) -> dict[str, float]:
    """Relative errors of latch times and latch torque peaks, by name."""
    pairs = {
        f"{line} {what}": (getattr(found.headline, name)[line], getattr(reference.headline, name)[line])
        for name, what in (("latch_times", "time"), ("latch_torque_peaks", "peak"))
        for line in reference.headline.latch_times
    }
    return {name: abs(a / b - 1.0) for name, (a, b) in pairs.items()}


def row(fidelity: str, backend: Backend, tolerance: float, folder: Path) -> Outcome:
    """Print one line of the table."""
    found = deploy(fidelity, tolerance, folder, backend)
    costs = found.costs
    print(
        f"{fidelity:9} {backend:7} {tolerance:9.0e} {costs.wall_time:8.2f} {UNTIL / costs.wall_time:8.2f} "
        f"{costs.steps:8d} {costs.rejected:9d} {costs.iterations:11d} {costs.fmu_time_share:10.0%}",
        flush=True,
    )
    return found


def main() -> None:
    """Print the table."""
    backends: list[Backend] = ["native", "python"] if "--python" in sys.argv[1:] else ["native"]
    heads = ("wall s", "x real", "steps", "rejected", "iterations", "FMU share")
    print(
        f"{'bodies':9} {'FMUs':7} {'tolerance':>9} " + " ".join(f"{h:>{max(8, len(h) + 1)}}" for h in heads)
    )
    with TemporaryDirectory() as name:
        folder = Path(name)
        for fidelity in ("rigid", "flexible"):
            reference = deploy(fidelity, 1e-6, folder) if "--error" in sys.argv[1:] else None
            for backend, tolerance in product(backends, TOLERANCES[fidelity]):
                found = row(fidelity, backend, tolerance, folder)
                if reference is not None:
                    table = errors(found, reference)
                    print("   " + ", ".join(f"{what} {error:.1e}" for what, error in table.items()))


if __name__ == "__main__":
    main()
