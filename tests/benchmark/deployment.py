"""Run time of the AMOS-3 deployment over 12 s against its error, rigid and flexible, as FMUs.

`python tests/benchmark/deployment.py` prints wall time, steps, iterations and the share of FMU steps; with
`--error` it also makes tight runs (a tenth of the tolerance, minutes) and prints the relative errors of
latch times and latch torque peaks against them.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from orchestrator.master import Settings
from orchestrator.run import Outcome, run
from orchestrator.scene import assemble, find_scene, load_scene

UNTIL = 12.0


def deploy(fidelity: str, tolerance: float, folder: Path) -> Outcome:
    """One deployment of AMOS-3, all bodies "rigid" or "flexible"."""
    scene = load_scene(find_scene("amos3"))
    everything = {"all"}
    assembly = assemble(
        scene, everything if fidelity == "rigid" else (), everything if fidelity == "flexible" else ()
    )
    settings = Settings(tolerance=tolerance, largest_step=assembly.largest_step)
    return run(assembly, folder / f"{fidelity}-{tolerance:g}.h5", settings, UNTIL)


def errors(found: Outcome, reference: Outcome) -> dict[str, float]:
    """Relative errors of latch times and latch torque peaks, by name."""
    pairs = {
        f"{line} {what}": (getattr(found.headline, name)[line], getattr(reference.headline, name)[line])
        for name, what in (("latch_times", "time"), ("latch_torque_peaks", "peak"))
        for line in reference.headline.latch_times
    }
    return {name: abs(a / b - 1.0) for name, (a, b) in pairs.items()}


def main() -> None:
    """Print the table."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        print(
            f"{'':10}{'wall s':>8}{'x real':>8}{'steps':>8}{'rejected':>9}{'iterations':>11}{'FMU share':>10}"
        )
        for fidelity in ("rigid", "flexible"):
            found = deploy(fidelity, 1e-4, folder)
            print(
                f"{fidelity:10}{found.wall_time:8.1f}{UNTIL / found.wall_time:8.2f}{found.steps:8d}{found.rejected:9d}"
                f"{found.iterations:11d}{found.fmu_time_share:10.0%}"
            )
            if "--error" in sys.argv[1:]:
                table = errors(found, deploy(fidelity, 1e-5, folder))
                print("   " + ", ".join(f"{what} {error:.1e}" for what, error in table.items()))


if __name__ == "__main__":
    main()
