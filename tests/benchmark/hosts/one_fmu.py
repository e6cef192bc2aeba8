"""A scene as one FMU in hosts that know nothing of it: FMPy's calls and, where they are installed, libcosim and Ecos.

    python -m tests.benchmark.hosts.one_fmu [SCENE] [--rigid] [--until SECONDS] [--rounds N]

Beside runs of the scene by its own master, in turn; prints the largest difference of a latch time, of a peak of the
latch torque, and processor time over that of a run (the least of all rounds), at several communication steps.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import NamedTuple

import orchestrator as fanfold
from orchestrator.run.run import kept_fmus, run
from orchestrator.run.simulation import Options
from tests.benchmark.hosts.ecos import load_tbb, simulation
from tests.unit.run.as_one.host import Host as Instance

STEPS = (1e-3, 1e-2, 1e-1)
_NANO = 1e9


class Found(NamedTuple):
    """Latch times (s) and torque peaks (N.m) by line, and processor time (s)."""

    times: dict[str, float]
    peaks: dict[str, float]
    cost: float


Host = Callable[[Path, float, float, list[str]], Found]
"""What takes an FMU, a communication step (s), an end time (s) and names of lines."""


def in_fmpy(path: Path, step: float, until: float, lines: list[str]) -> Found:
    """FMI's functions called one by one from Python."""
    host = Instance(path).start()
    begin = process_time()
    host.to(until, step)
    cost = process_time() - begin
    times, peaks = ({n: host[f"{n}.{what}"] for n in lines} for what in ("latch_time", "latch_torque_peak"))
    return Found(times, peaks, cost)


def in_libcosim(path: Path, step: float, until: float, lines: list[str]) -> Found:
    """Its fixed-step algorithm; series of a few outputs in place of all cost as much, some 40 us a step."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.FATAL)
    execution = CosimExecution.from_step_size(round(step * _NANO))
    slave = execution.add_local_slave(CosimLocalSlave(str(path), "wing"))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    begin = process_time()
    execution.simulate_until(round(until * _NANO))
    cost = process_time() - begin
    references = Instance(path).references

    def read(what: str) -> dict[str, float]:
        wanted = [references[f"{name}.{what}"] for name in lines]
        return dict(zip(lines, observer.last_real_values(slave, wanted), strict=True))

    return Found(read("latch_time"), read("latch_torque_peak"), cost)


def in_ecos(path: Path, step: float, until: float, lines: list[str]) -> Found:
    """Its fixed-step algorithm."""
    with simulation(path, step) as running:
        begin = process_time()
        running.step_until(until)
        cost = process_time() - begin
        times, peaks = (
            {name: running.get_real(f"wing::{name}.{what}") for name in lines}
            for what in ("latch_time", "latch_torque_peak")
        )
    return Found(times, peaks, cost)


def hosts_here() -> dict[str, Host]:
    """By name, those that are installed."""
    found: dict[str, Host] = {"FMPy": in_fmpy}
    try:
        import libcosimpy  # noqa: F401

        found["libcosim"] = in_libcosim
    except ImportError:
        print("libcosim is not installed: pip install '.[benchmark]'")
    try:
        load_tbb()
        import ecospy  # noqa: F401

        found["Ecos"] = in_ecos
    except (ImportError, OSError) as error:
        print(f"Ecos is not installed ({error}): pip install '.[benchmark]'")
    return found


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("scene", nargs="?", default="amos3")
    parser.add_argument("--rigid", action="store_true")
    parser.add_argument("--until", type=float, default=14.0)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    fidelity = {"rigid" if given.rigid else "flexible": ["all"]}
    hosts = hosts_here()
    options = Options(**fidelity)
    scene = fanfold.load(given.scene).check_one_run()
    assembly = options.assemble(scene)
    settings = options.settings(assembly)
    with TemporaryDirectory() as folder, kept_fmus() as load:
        (path,) = fanfold.export(given.scene, folder, as_one=True, **fidelity)
        costs: dict[tuple[str, float], list[float]] = {}
        runs = []
        for _ in range(given.rounds):
            begin = process_time()
            outcome = run(assembly, None, settings, given.until, load=load)
            runs.append(process_time() - begin)
            times, peaks = outcome.headline.latch_times, outcome.headline.latch_torque_peaks
            for name, host in hosts.items():
                for step in STEPS:
                    found = host(path, step, given.until, list(times))
                    costs.setdefault((name, step), []).append(found.cost)
                    apart = max(abs(found.times[n] / times[n] - 1.0) for n in times)
                    higher = max(abs(found.peaks[n] / peaks[n] - 1.0) for n in times)
                    print(f"{name:9} {step:6g} s  latch times {apart:.1e}  peaks {higher:.1e}", flush=True)
    print(f"\nrun: {min(runs):.2f} s of processor time, {outcome.costs.steps} steps")
    for (name, step), spent in costs.items():
        print(f"{name:9} {step:6g} s  {min(spent) / min(runs):.2f} of it")


if __name__ == "__main__":
    main()
