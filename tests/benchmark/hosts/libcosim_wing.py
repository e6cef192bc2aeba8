"""The FMUs of a scene under libcosim: exported for other tools (end-point wrenches), fixed-step algorithm.

    python -m tests.benchmark.hosts.libcosim_wing [SCENE] [--until SECONDS] [--backend native|python]

Beside our master's runs of the same scene on the same kind of FMUs. With rigid bodies libcosim runs the whole
deployment. With flexible ones that takes hours: there the largest step of 1, 2, 5 times a power of ten that
stays stable over a short window is searched, its steps are timed, and the whole is estimated from them.
The bodies start in static equilibrium, as in every export.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Literal, NamedTuple, get_args

import numpy as np

from fmus import Backend
from orchestrator.assembly import Assembly
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.start import started_at_rest
from orchestrator.cosim.ports import MOTION, WRENCH
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus, export
from orchestrator.scene import find_scene, load_scene
from orchestrator.scene.component_connections import WrenchMode
from tests.benchmark.models.one_panel import Trial, couple, crest, line_torque

try:
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave
except ImportError:
    raise SystemExit("libcosimpy is missing; install it with: pip install '.[benchmark]'") from None

Fidelity = Literal["rigid", "flexible"]
_NANO = 1e9
WINDOW = 20000
"""Steps of a trial that decides on stability and measures the cost of a step."""
STEPS = tuple(m * 10.0**-e for e in range(4, 9) for m in (10.0, 5.0, 2.0))
RIGID_STEPS = (2e-4, 1e-4, 5e-5, 2e-5)


class CoSimulation:
    """FMUs of an assembly, loaded and connected in libcosim; `watch` are signals kept in memory."""

    def __init__(self, assembly: Assembly, paths: Sequence[Path], h: float, until: float) -> None:
        log_output_level(CosimLogLevel.FATAL)
        self._until, self._samples = until, int(until / h) + 10
        self._execution = CosimExecution.from_step_size(round(h * _NANO))
        self._slaves = {
            path.stem: self._execution.add_local_slave(CosimLocalSlave(str(path), path.stem))
            for path in paths
        }
        self._references = {
            name: {v.name.decode(): v.reference for v in self._execution.slave_variables(index)}
            for name, index in self._slaves.items()
        }
        for link in assembly.links:
            self._connect(link.body, link.connection, MOTION)
            self._connect(link.connection, link.body, WRENCH)
        self._observer = CosimObserver.create_time_series(self._samples)
        self._execution.add_observer(self._observer)

    def _connect(self, source: tuple[str, str], target: tuple[str, str], names: Sequence[str]) -> None:
        """Connect all scalars of the named quantities of two ports; a scalar that fails is an error."""
        (slave, port), (other, side) = source, target
        for name in names:
            prefix = f"{port}.{name}["
            for scalar, reference in self._references[slave].items():
                if scalar.startswith(prefix):
                    to = self._references[other][f"{side}.{name}[{scalar.removeprefix(prefix)}"]
                    places = (self._slaves[slave], reference, self._slaves[other], to)
                    if self._execution.connect_real_variables(*places) != 0:
                        raise RuntimeError(f"libcosim does not connect {slave}.{scalar} with {other}")

    def watch(self, slave: str, name: str) -> None:
        """Keep a signal in memory."""
        place = self._slaves[slave], self._references[slave][name]
        if not self._observer.start_time_series(*place, CosimVariableType.REAL):
            raise RuntimeError(f"libcosim does not observe {slave}.{name}")

    def run(self) -> tuple[bool, float]:
        """Whether the end was reached, and the wall time (s)."""
        start = perf_counter()
        reached = self._execution.simulate_until(round(self._until * _NANO))
        return bool(reached), perf_counter() - start

    def signal(self, slave: str, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Times and values of a signal that was watched."""
        place = self._slaves[slave], self._references[slave][name]
        times, _, values = self._observer.time_series_real_samples(*place, 1, self._samples)
        return np.array(times) / _NANO, np.array(values)


@contextmanager
def loaded(
    assembly: Assembly, backend: Backend, h: float, until: float
) -> Iterator[tuple[CoSimulation, list[str]]]:
    """The co-simulation of an assembly, and the hinges whose latches it watches; loading is not timed."""
    hinges = [hinge for line in assembly.hinge_lines for hinge in line.hinges]
    with TemporaryDirectory(prefix="fanfold_") as folder:
        simulation = CoSimulation(assembly, export(assembly, Path(folder), backend), h, until)
        for hinge in hinges:
            for name in ("latch_torque", "latch_distance"):
                simulation.watch(hinge, name)
        yield simulation, hinges


class Lines(NamedTuple):
    """What a run gives of every hinge line, and its wall time (s); None where it did not reach the end."""

    trials: list[Trial] | None
    wall: float


Attempt = Callable[[float, float], Lines]
"""A run with a step size (s) to an end time (s)."""


def co_simulate(assembly: Assembly, backend: Backend, h: float, until: float) -> Lines:
    """One run of an assembly in end-point mode."""
    with loaded(assembly, backend, h, until) as (simulation, _):
        reached, wall = simulation.run()
        if not reached:
            return Lines(None, wall)
        trials = [_of_line(simulation, line.hinges, wall, round(until / h)) for line in assembly.hinge_lines]
    return Lines(trials, wall)


def _of_line(simulation: CoSimulation, hinges: Sequence[str], wall: float, steps: int) -> Trial:
    times, distance = simulation.signal(hinges[0], "latch_distance")
    reached = distance <= 0.0
    torque = np.abs(sum(simulation.signal(hinge, "latch_torque")[1] for hinge in hinges))
    if not reached.any():
        return Trial(np.nan, np.nan, wall, steps)
    return Trial(float(times[reached.argmax()]), crest(times, torque), wall, steps)


class Cost(NamedTuple):
    """The largest stable step of those tried (s), what a step costs (s), and what a whole run would (s)."""

    h: float
    per_step: float
    total: float


def largest_step(attempt: Attempt, until: float) -> Cost:
    """Search downwards; stable means `WINDOW` steps without failure and without a latch that cannot be."""
    for h in STEPS:
        found = cost_of_step(attempt, h, until)
        if found is not None:
            return found
    return Cost(np.nan, np.nan, np.nan)


def cost_of_step(attempt: Attempt, h: float, until: float, count: int = WINDOW) -> Cost | None:
    """Cost of steps of a size, from so many of them; None where they are not stable."""
    window = min(count * h, until)
    found = attempt(h, window)
    if found.trials is None or not _plausible(found.trials):
        return None
    per_step = found.wall / (window / h)
    return Cost(h, per_step, per_step * until / h)


def _plausible(trials: Sequence[Trial]) -> bool:
    """A wing does not latch in the first half second, and never with more than 10 kN.m."""
    return not any(trial.latch < 0.5 or trial.peak > 1e4 for trial in trials)


def ours(assembly: Assembly, backend: Backend, tolerance: float, until: float) -> Lines:
    """Our master on the same kind of FMUs, in mean mode."""
    settings = Settings(tolerance=tolerance, largest_step=assembly.largest_step)
    record, trial = couple(as_fmus(assembly, backend), assembly, settings, until=until)
    latches = {text.split()[0]: time for time, _, text in record.events}
    trials = [
        trial._replace(
            latch=latches.get(line.name, np.nan), peak=crest(record.times, line_torque(record, assembly, i))
        )
        for i, line in enumerate(assembly.hinge_lines)
    ]
    return Lines(trials, trial.wall)


def worst(kind: str, found: Sequence[Trial], reference: Sequence[Trial]) -> float:
    """Largest relative error of "latch" or "peak" over the lines."""
    pairs = [(getattr(a, kind), getattr(b, kind)) for a, b in zip(found, reference, strict=True)]
    return float(np.max([abs(a / b - 1.0) if b > 0.0 else np.nan for a, b in pairs]))


class Point(NamedTuple):
    """One run of a series: relative errors, the largest of all lines, NaN without an answer; wall time (s).

    estimated: a wall time that is known without a run.
    """

    series: str
    setting: str
    time_error: float
    peak_error: float
    wall: float
    estimated: bool = False


def error_texts(point: Point) -> list[str]:
    """Both errors for a table."""
    missing = "estimated" if point.estimated else "diverged"
    return [missing if np.isnan(e) else f"{e:.1e}" for e in (point.time_error, point.peak_error)]


def compare(scene: str, fidelity: Fidelity, until: float, backend: Backend) -> Iterator[Point]:
    """A scene with all bodies rigid or flexible: our master, then libcosim."""
    both = {"rigid": {"all"}, "flexible": ()} if fidelity == "rigid" else {"rigid": (), "flexible": {"all"}}
    modes: tuple[WrenchMode, ...] = ("mean", "endpoint")
    mean, endpoint = (assemble(load_scene(find_scene(scene)), **both, wrench_mode=mode) for mode in modes)
    if fidelity == "rigid":
        endpoint = started_at_rest(endpoint)
    reference = ours(mean, backend, 1e-5, until).trials or []
    for tolerance in (1e-2, 1e-3, 1e-4):
        yield _point("fanfold", f"tol {tolerance:g}", ours(mean, backend, tolerance, until), reference)
    if fidelity == "rigid":
        for h in RIGID_STEPS:
            yield _point("libcosim", f"H {h:g} s", co_simulate(endpoint, backend, h, until), reference)
        return
    cost = largest_step(lambda h, end: co_simulate(endpoint, backend, h, end), until)
    yield Point("libcosim", f"H {cost.h:g} s", np.nan, np.nan, cost.total, estimated=True)


def _point(series: str, setting: str, lines: Lines, reference: Sequence[Trial]) -> Point:
    late = peak = np.nan
    if lines.trials is not None:
        late, peak = (worst(kind, lines.trials, reference) for kind in ("latch", "peak"))
    return Point(series, setting, late, peak, lines.wall)


def print_points(title: str, points: Sequence[Point]) -> None:
    """The table of a scene; ratios are to the quickest run that has an answer."""
    quickest = min(point.wall for point in points if not np.isnan(point.time_error))
    print(f"\n{title}; errors against our run at 1e-5")
    print(f"{'master':<12}{'setting':<14}{'latch time':>12}{'latch peak':>12}{'wall, s':>12}{'ratio':>10}")
    for point in points:
        late, peak = error_texts(point)
        wall = f"{point.wall:>12.2f}{point.wall / quickest:>10.1f}"
        print(f"{point.series:<12}{point.setting:<14}{late:>12}{peak:>12}{wall}", flush=True)
    if points[-1].estimated:
        print(f"  estimated from {WINDOW} steps of the largest stable size of those from {STEPS[0]:g} s down")


def main() -> None:
    """Command line."""
    parser = ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("scene", nargs="?", default="amos3")
    parser.add_argument("--until", type=float, default=12.0)
    parser.add_argument("--backend", choices=("native", "python"), default="native")
    chosen = parser.parse_args()
    for fidelity in get_args(Fidelity):
        points = list(compare(chosen.scene, fidelity, chosen.until, chosen.backend))
        title = f"{chosen.scene}, all bodies {fidelity}, {chosen.until:g} s, {chosen.backend} FMUs"
        print_points(title, points)


if __name__ == "__main__":
    main()
