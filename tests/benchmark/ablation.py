"""What each part of the model, and each thing not computed, costs and gives: AMOS-3 flexible, native FMUs, 12 s.

    python -m tests.benchmark.ablation [--plot FILE]

Every row changes one thing of the first. Errors are against a tight run of the full model, so that those of a
reduced model are its modelling error; repeats are interleaved, the shortest counts.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import matplotlib as mpl

from orchestrator.assembly import Assembly
from orchestrator.fmu import FmuParticipant
from orchestrator.master import Master, Settings
from orchestrator.network import Network
from orchestrator.participant import Participant
from orchestrator.run import Outcome, as_fmus, run
from orchestrator.scene import assemble, find_scene, load_scene

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter

UNTIL, TOLERANCE, TIGHT, REPEATS = 12.0, 3e-3, 1e-5, 3
TEXT = Path(find_scene("amos3")).read_text(encoding="utf-8")
MODES = "fixed_interface_modes = 10"
Loading = Callable[[Assembly], AbstractContextManager[Sequence[Participant]]]


class Unrecorded:
    """A recorder that keeps nothing."""

    def append(self, time: float, values: object) -> None:
        """Drop a communication point."""

    def event(self, time: float, component: str, text: str) -> None:
        """Drop an event."""


@contextmanager
def without_derivatives(assembly: Assembly) -> Iterator[Sequence[Participant]]:
    """Native FMUs as if they gave no derivatives, so that the interface Jacobian is probed by steps."""
    with as_fmus(assembly, "native") as participants:
        for participant in participants:
            if isinstance(participant, FmuParticipant):
                participant.directional_derivatives = False
        yield participants


@dataclass
class Variant:
    """One row: what is changed, and what came of it."""

    name: str
    text: str = TEXT
    rigid: tuple[str, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)
    load: Loading = as_fmus
    recorded: bool = True
    wall: float = float("inf")
    outcome: Outcome | None = None

    def assembly(self, folder: Path) -> Assembly:
        """Parts and links of the changed scene."""
        path = folder / "amos3.toml"
        path.write_text(self.text, encoding="utf-8")
        return assemble(load_scene(path), rigid=self.rigid)

    def measure(self, folder: Path) -> None:
        """Run once more; keep the shortest time."""
        assembly = self.assembly(folder)
        settings = Settings(
            **{"tolerance": TOLERANCE, "largest_step": assembly.largest_step, **self.settings}
        )
        if self.recorded:
            self.outcome = run(assembly, folder / "run.h5", settings, UNTIL, load=self.load)
            self.wall = min(self.wall, self.outcome.costs.wall_time)
            return
        with as_fmus(assembly) as participants:
            master = Master(
                Network(participants, assembly.links), assembly.hinge_lines, Unrecorded(), settings
            )
            start = perf_counter()
            master.initialize(preload=assembly.preload)
            master.run(UNTIL)
            self.wall = min(self.wall, perf_counter() - start)


def with_modes(count: int) -> str:
    """The scene with another number of fixed-interface modes."""
    return TEXT.replace(MODES, f"fixed_interface_modes = {count}")


def with_coupling(level: str) -> str:
    """The scene with another level of inertia coupling."""
    return TEXT.replace(MODES, f'{MODES}, inertia_coupling = "{level}"')


def variants() -> list[Variant]:
    """All rows; the first is what the others change."""
    return [
        Variant("full model"),
        *(Variant(f"{n} fixed-interface modes", with_modes(n)) for n in (5, 2, 0)),
        *(Variant(f"inertia coupling {level}", with_coupling(level)) for level in ("partial", "constant")),
        Variant("yoke rigid", rigid=("yoke",)),
        Variant("all bodies rigid", rigid=("all",)),
        *(Variant(f"fixed step {h:g} s", settings={"fixed_step": h}) for h in (2e-3, 5e-4)),
        Variant("Jacobian probed by steps", load=without_derivatives),
        Variant("nothing recorded", recorded=False),
    ]


def error(outcome: Outcome, reference: Outcome) -> tuple[float, float]:
    """Largest error of a latch time (s), largest relative error of a latch torque peak."""
    found, true = outcome.headline, reference.headline
    times = [abs(found.latch_times.get(k, float("nan")) - v) for k, v in true.latch_times.items()]
    peaks = [
        abs(found.latch_torque_peaks.get(k, float("nan")) / v - 1.0)
        for k, v in true.latch_torque_peaks.items()
    ]
    return max(times), max(peaks)


def draw(rows: Sequence[Variant], reference: Outcome, path: Path) -> None:
    """Wall time against the error in latch torque peaks."""
    figure, axes = plt.subplots(figsize=(7, 4.5), layout="constrained")
    for number, row in enumerate(rows):
        if row.outcome is not None:
            _, peak = error(row.outcome, reference)
            axes.loglog(row.wall, peak, "os^vDPX*<>hp"[number % 12], label=row.name)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("wall time, s")
    axes.set_ylabel("largest relative error of a latch torque peak")
    axes.grid(which="both", alpha=0.3)
    axes.legend(fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.savefig(path, dpi=120)


def main(arguments: Sequence[str]) -> None:
    """Print the table; with --plot also draw it."""
    rows = variants()
    with TemporaryDirectory() as name:
        folder = Path(name)
        reference = Variant("reference", settings={"tolerance": TIGHT})
        reference.measure(folder)
        assert reference.outcome is not None
        for _ in range(REPEATS):
            for row in rows:
                row.measure(folder)
        print(f"amos3 flexible, {UNTIL:g} s, tolerance {TOLERANCE:g}; errors against tolerance {TIGHT:g}")
        print(
            f"{'':28} {'wall s':>7} {'of full':>8} {'steps':>7} {'iterations':>11} {'time, ms':>9} {'peak':>8}"
        )
        for row in rows:
            line = f"{row.name:28} {row.wall:7.2f} {row.wall / rows[0].wall:8.2f}"
            if row.outcome is not None:
                late, peak = error(row.outcome, reference.outcome)
                costs = row.outcome.costs
                line += f" {costs.steps:7d} {costs.iterations:11d} {1e3 * late:9.3f} {peak:8.1e}"
            print(line)
        if "--plot" in arguments:
            draw(rows, reference.outcome, Path(arguments[arguments.index("--plot") + 1]))


if __name__ == "__main__":
    main(sys.argv[1:])
