"""Start-up: what passes before the first step of AMOS-3, with an empty cache and with a full one.

    python -m tests.benchmark.startup [--plot PLOT.png]

Every line is a process of its own: imports, the scene's bodies (finite elements and their reduction, or the
cache), its FMUs (built, or from the cache), and loading them into the master. Native FMUs and PythonFMUs, rigid and
flexible.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from argparse import ArgumentParser
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fmus import native_library

PHASES = ("imports", "bodies", "export", "load")
_CHILD = """
import json, sys, tempfile
from pathlib import Path
from time import perf_counter
marks = [perf_counter()]
from orchestrator.cosim.fmu import FmuParticipant
from orchestrator.run.run import export
from orchestrator.assembly.assemble import assemble
from orchestrator.scene import find_scene, load_scene
marks.append(perf_counter())
scene = load_scene(find_scene("amos3"))
everything = {"all"}
assembly = assemble(scene, rigid=everything) if sys.argv[1] == "rigid" else assemble(scene, flexible=everything)
marks.append(perf_counter())
with tempfile.TemporaryDirectory() as folder:
    paths = export(assembly, Path(folder), sys.argv[2])
    marks.append(perf_counter())
    participants = [FmuParticipant(path.stem, path, isolate=False) for path in paths]
    marks.append(perf_counter())
    for participant in participants:
        participant.close()
print(json.dumps([b - a for a, b in zip(marks, marks[1:])]))
"""


def start(fidelity: str, backend: str, cache: Path) -> list[float]:
    """Seconds of every phase in a fresh process."""
    environment = {**os.environ, "FANFOLD_CACHE": str(cache)}
    command = [sys.executable, "-c", _CHILD, fidelity, backend]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    times: list[float] = json.loads(done.stdout.strip().splitlines()[-1])
    return times


def measure() -> dict[str, list[float]]:
    """All cases, the warm ones as the best of three."""
    found: dict[str, list[float]] = {}
    backends = ("native", "python") if native_library() else ("python",)
    for fidelity, backend in product(("rigid", "flexible"), backends):
        with TemporaryDirectory() as folder:
            found[f"{fidelity}, {backend}, cold"] = start(fidelity, backend, Path(folder))
            runs = [start(fidelity, backend, Path(folder)) for _ in range(3)]
            found[f"{fidelity}, {backend}, warm"] = min(runs, key=sum)
    return found


def plot(found: dict[str, list[float]], path: Path) -> None:
    """Stacked bars."""
    figure = Figure(figsize=(8.0, 4.0), layout="constrained")
    axis = figure.subplots()
    names = list(found)
    left = [0.0] * len(names)
    for i, phase in enumerate(PHASES):
        widths = [times[i] for times in found.values()]
        axis.barh(names, widths, left=left, label=phase)
        left = [a + b for a, b in zip(left, widths, strict=True)]
    axis.invert_yaxis()
    axis.set(xlabel="time, s", title="Start-up of AMOS-3")
    axis.legend()
    FigureCanvasAgg(figure)
    figure.savefig(path, dpi=120)


def main() -> None:
    """Command line."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--plot", type=Path, default=Path("startup.png"))
    chosen = parser.parse_args()
    found = measure()
    print(f"{'seconds':<26}" + "".join(f"{phase:>10}" for phase in (*PHASES, "sum")))
    for name, times in found.items():
        print(f"{name:<26}" + "".join(f"{t:>10.3f}" for t in (*times, sum(times))))
    plot(found, chosen.plot)
    print(f"\n{chosen.plot}")


if __name__ == "__main__":
    main()
