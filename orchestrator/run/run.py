"""From an assembly to a finished result, in a file or in memory: load participants, couple, record, sum up."""

from __future__ import annotations

import json
import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import TYPE_CHECKING, Any, Literal

import fmus
from components import ComponentError, Layout
from components.cache.temporary import process_folder
from fmus.archive import content_digest
from fmus.compiled import native_backend

from ..assembly import Assembly, Part
from ..assembly.second_order import second_order_modes
from ..assembly.statics.start import static_start
from ..cosim.compiled import CompiledParticipant
from ..cosim.coupling import StepError
from ..cosim.explicit import ExplicitMaster
from ..cosim.fmi_participant import FmiParticipant
from ..cosim.master import Master
from ..cosim.network import Network, NetworkError
from ..cosim.participant import Participant, ParticipantError
from ..cosim.ports import Order
from ..cosim.rows import SCENE_CHANNELS, Recorder, recorded_layout
from ..cosim.settings import Settings
from ..cosim.snapshot import Snapshot
from ..messages import message
from ..results.earlier import SETTINGS
from ..results.key_figures import Headline, headline
from ..results.recorder import MemoryRecorder, SignalGroup
from ..results.result import Result
from ..results.result_file import ResultWriter
from ..scene.table import SceneError
from .checkpoint import Checkpoint, checkpoint_file
from .errors import InterruptedRunError
from .errors import RunError as RunError
from .free_space import FreeSpace

if TYPE_CHECKING:
    from fmus import About, Backend, Experiment, FmiVersion

    from ..cosim.signals.process import SignalProcess

MasterKind = Literal["implicit", "jacobi", "gauss-seidel"]
Loader = Callable[[Assembly], AbstractContextManager[Sequence[Participant]]]
"""Makes the participants of an assembly and frees them afterwards."""
_PACKAGES = ("fanfold", "numpy", "scipy", "fmpy", "pythonfmu")


@dataclass(frozen=True, slots=True)
class Costs:
    """What a run cost: steps, sweeps over all participants, rejected steps, wall time (s), share of it in FMUs."""

    steps: int
    iterations: int
    rejected: int
    wall_time: float
    fmu_time_share: float

    def as_dict(self, end_time: float) -> dict[str, float]:
        """By the names that results and JSON have."""
        return {
            "steps": self.steps,
            "iterations": self.iterations,
            "rejected_steps": self.rejected,
            "wall_time_s": self.wall_time,
            "real_time_factor": end_time / self.wall_time,
            "fmu_time_share": self.fmu_time_share,
        }


@dataclass(frozen=True, slots=True)
class Outcome:
    """A finished run: its result, which master made it at which order, headline, costs, step sizes taken."""

    result: Result
    master: MasterKind
    order: Order
    headline: Headline
    costs: Costs
    segments: tuple[tuple[float, ...], ...]

    @property
    def path(self) -> Path:
        """File of the result; RunError where it is in memory."""
        if self.result.path is None:
            raise RunError(f"{self.result.name}: the result is in memory and has no file")
        return self.result.path


def export(
    assembly: Assembly,
    directory: Path,
    backend: Backend | None = None,
    fmi: FmiVersion = "2.0",
    with_sources: bool = False,
    experiment: Experiment | None = None,
    compressed: bool = True,
    platforms: Sequence[str] = (),
    watch: Callable[[str], object] = lambda name: None,
    about: About | None = None,
) -> list[Path]:
    """Write every part of an assembly as an FMU into a directory (made if missing); native where possible.

    Not compressed: for temporary files. platforms: platforms of the libraries, by default this one; `watch` is called
    with each before its library is compiled for the first time.
    """
    try:
        for name in platforms:
            watch(name)
            fmus.cross_compiled(name)
    except fmus.CompileError as error:
        raise RunError(f"{assembly.name}: {error}") from None
    directory.mkdir(parents=True, exist_ok=True)
    paths = []
    for part in assembly.parts:
        with _refusals(assembly, part):
            paths.append(
                fmus.build_fmu(
                    part.component(),
                    part.name,
                    directory,
                    part.start,
                    backend,
                    fmi,
                    with_sources,
                    experiment,
                    compressed,
                    platforms,
                    about,
                )
            )
    return paths


@contextmanager
def _refusals(assembly: Assembly, part: Part) -> Iterator[None]:
    """RunError that names the part where a component is refused."""
    try:
        yield
    except ComponentError as error:
        raise RunError(f"{assembly.name}: {part.name}: {error}") from None


@contextmanager
def as_fmus(
    assembly: Assembly, backend: Backend | None = None, *, isolate: bool = False, files: bool = True
) -> Iterator[Sequence[FmiParticipant]]:
    """Every part of an assembly as an instance of its FMU; freed in the end, whatever happens.

    isolate: each FMU in a process of its own. files: whether native FMUs in this process are loaded from files.
    Otherwise they are instances in the library that their files carry, for studies of many runs, in which writing and
    unpacking files takes as long as a run.
    """
    from_files = files or isolate or backend == "python"
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory(dir=process_folder())))
        participants: list[FmiParticipant] = []
        for part in assembly.parts:
            with _refusals(assembly, part):
                if from_files or not native_backend(part.component()):
                    one = _from_file(part, folder, backend, isolate=isolate)
                else:
                    one = CompiledParticipant(part)
            stack.callback(one.close)
            participants.append(one)
        yield participants


def _from_file(part: Part, folder: Path, backend: Backend | None, *, isolate: bool) -> FmiParticipant:
    """An instance of the FMU of a part, which is written into a folder."""
    from ..cosim.fmu import FmuParticipant  # FMPy takes its time, which studies need not

    path = fmus.build_fmu(part.component(), part.name, folder, part.start, backend, compressed=False)
    return FmuParticipant(path.stem, path, isolate=isolate)


@contextmanager
def kept_fmus(
    backend: Backend | None = None, *, isolate: bool = False, files: bool = True
) -> Iterator[Loader]:
    """A loader for runs one after the other: it makes the FMUs once, a later run has them reset.

    An assembly with other parts, or other start values that are given, has its FMUs made anew. files: as for `as_fmus`.
    """
    with ExitStack() as stack:
        kept: list[FmiParticipant] = []
        made: Sequence[Part] = ()

        @contextmanager
        def load(assembly: Assembly) -> Iterator[Sequence[Participant]]:
            nonlocal made
            if alike(made, assembly.parts):
                for participant, part in zip(kept, assembly.parts, strict=True):
                    participant.reset(part.start)
            else:
                stack.close()
                kept[:] = stack.enter_context(as_fmus(assembly, backend, isolate=isolate, files=files))
                made = assembly.parts
            yield kept

        yield load


def alike(parts: Sequence[Part], others: Sequence[Part]) -> bool:
    """Whether parts are the same but for the start values of what both are given."""
    return len(parts) == len(others) and all(
        (a.name, a.kind, a.start.keys()) == (b.name, b.kind, b.start.keys())
        and a.component() is b.component()
        for a, b in zip(parts, others, strict=True)
    )


def run(
    assembly: Assembly,
    output: Path | None,
    settings: Settings,
    until: float | None = None,
    master: MasterKind = "implicit",
    watch: Callable[[float, float], None] = lambda time, h: None,
    warn: Callable[[str], None] = lambda sentence: None,
    load: Loader = as_fmus,
    asked: Mapping[str, Any] | None = None,
    start: Checkpoint | None = None,
) -> Outcome:
    """Run an assembly, with its result in a file or in memory; RunError if it does not finish.

    With participants that cannot restore states, the explicit Gauss-Seidel master replaces the implicit one. asked:
    settings for the checkpoint, and the text of `SETTINGS`. start: the checkpoint to continue from.
    """
    try:
        assembly = static_start(assembly).assembly
    except SceneError as error:
        raise RunError(str(error)) from None
    end = assembly.until if until is None else until
    if output is not None:
        watch = FreeSpace(output, end, warn, watch)
    settings = replace(settings, progress=watch, driving=assembly.driving)
    with ExitStack() as stack:
        try:
            participants = stack.enter_context(load(assembly))
            fixed = ", ".join(p.name for p in participants if not p.can_restore)
            if fixed and master == "implicit":
                master = "gauss-seidel"
                warn(
                    message(
                        "W-backend",
                        f"{assembly.name}: {fixed} cannot restore a saved state, which the implicit master needs. "
                        "The explicit Gauss-Seidel master is used instead.",
                    )
                )
            network = Network.ordered(
                participants, assembly.links, settings.order if master == "implicit" else 2
            )
        except ParticipantError as error:
            raise RunError(f"{assembly.name}: {error}") from None
        except NetworkError as error:
            raise RunError("\n".join(f"{assembly.name}: {problem}" for problem in error.problems)) from None
        if assembly.signal_fmus and (settings.snapshot_every is not None or start is not None):
            names = ", ".join(fmu.name for fmu in assembly.signal_fmus)
            raise RunError(
                f"{assembly.name}: a run with FMUs that have signals ({names}) has no checkpoints, as their state "
                "is not kept; leave checkpoint out"
            )
        return _follow(assembly, network, output, settings, end, master, warn, asked or {}, start)


def _follow(
    assembly: Assembly,
    network: Network,
    output: Path | None,
    settings: Settings,
    end: float,
    kind: MasterKind,
    warn: Callable[[str], None],
    asked: Mapping[str, Any],
    resumed: Checkpoint | None,
) -> Outcome:
    """Step a network through time into a result."""
    participants: list[Participant] = [*network.bodies, *network.connections]
    groups = signal_groups(network)
    groups += [
        SignalGroup.of(fmu.name, Layout(fmu.recorded().values()), "FMU") for fmu in assembly.signal_fmus
    ]
    provenance = _provenance(assembly, participants) | _settings(settings, end, kind, network.order)
    provenance |= {SETTINGS: str(asked[SETTINGS])} if SETTINGS in asked else {}
    same = {name: text for name, text in provenance.items() if name in _PACKAGES or name.startswith("fmu.")}
    start = perf_counter() - (resumed.wall_time if resumed else 0.0)
    if resumed is not None:
        resumed.refuse_other(assembly.name, same)
    recorder = _recorder(assembly, output, groups, provenance, resumed)
    with recorder as writer, ExitStack() as stack:
        signals = _signal_processes(assembly, settings.tolerance, end, stack, warn)
        try:
            runner = _runner(assembly, network, writer, settings, kind, signals)
        except ParticipantError as error:
            raise RunError(f"{assembly.name}: {error}") from None

        def keep(snapshot: Snapshot) -> None:
            if isinstance(writer, ResultWriter):
                spent = perf_counter() - start
                Checkpoint(snapshot, writer.place(), asked, same, spent).write(writer.path)

        try:
            if isinstance(runner, Master):
                runner.keep = keep
            if isinstance(runner, Master) and resumed is not None:
                runner.resume(resumed.snapshot)
            else:
                runner.initialize(preload=assembly.preload)
            runner.run(end)
        except (ParticipantError, StepError) as error:
            raise _broken_off(f"{assembly.name}: {error}", writer) from None
        except KeyboardInterrupt:
            sentence = f"{assembly.name}: interrupted at t = {runner.time:.6g} s"
            raise _broken_off(sentence, writer, InterruptedRunError) from None
        wall = perf_counter() - start
        statistics = runner.statistics
        fmu_time = statistics.fmu_time + sum(s.seconds for s in signals)
        costs = Costs(statistics.steps, statistics.sweeps, statistics.rejected, wall, fmu_time / wall)
        writer.statistics(costs.as_dict(end))
    if output is not None:
        checkpoint_file(output).unlink(missing_ok=True)
    segments = tuple(tuple(segment) for segment in runner.segments)
    result = recorder.result()
    return Outcome(result, kind, network.order, headline(result), costs, segments)


def _runner(
    assembly: Assembly,
    network: Network,
    writer: Recorder,
    settings: Settings,
    kind: MasterKind,
    signals: Sequence[SignalProcess],
) -> Master | ExplicitMaster:
    """The master of a kind."""
    lines, events = assembly.hinge_lines, assembly.events
    if kind != "implicit":
        return ExplicitMaster(network, lines, writer, settings, kind, events, signals)
    return Master(network, lines, writer, settings, events, signals)


def _signal_processes(
    assembly: Assembly, tolerance: float, until: float, stack: ExitStack, warn: Callable[[str], None]
) -> list[SignalProcess]:
    """A process for each FMU with signals; RunError if one cannot be started. Their warnings are issued at its end."""
    if not assembly.signal_fmus:
        return []
    from ..cosim.signals.process import (
        SignalProcess,  # takes its time, which scenes without such FMUs need not
    )

    try:
        found = [stack.enter_context(SignalProcess(fmu, tolerance, until)) for fmu in assembly.signal_fmus]
    except ParticipantError as error:
        raise RunError(f"{assembly.name}: {error}") from None

    def tell() -> None:
        for sentence in (sentence for one in found for sentence in one.warned()):
            warn(message("W-fmu", f"{assembly.name}: {sentence}"))

    stack.callback(tell)
    return found


def _recorder(
    assembly: Assembly,
    output: Path | None,
    groups: Sequence[SignalGroup],
    provenance: Mapping[str, str],
    resumed: Checkpoint | None,
) -> MemoryRecorder | ResultWriter:
    """In memory where no file is named; a new file, or that of the run to go on with."""
    if output is not None and resumed is not None:
        return ResultWriter.resumed(output, groups, resumed.place)
    around = (groups, provenance, assembly.geometry, assembly.hinge_lines)
    if output is None:
        return MemoryRecorder(*around)
    writer = ResultWriter(output, *around)
    checkpoint_file(output).unlink(missing_ok=True)  # of an earlier run
    return writer


def _broken_off(
    sentence: str, recorder: ResultWriter | MemoryRecorder, kind: type[RunError] = RunError
) -> RunError:
    """What to raise where a run ends early, and where its result up to there is."""
    if isinstance(recorder, ResultWriter) and recorder.is_empty:
        return kind(f"{sentence}; {recorder.path} holds nothing yet", reason=sentence)
    if isinstance(recorder, ResultWriter):
        going_on = (
            ", from whose checkpoint it can be resumed" if checkpoint_file(recorder.path).exists() else ""
        )
        where = f"results up to there are in {recorder.path}{going_on}"
        return kind(f"{sentence}; {where}", reason=sentence)
    where = "the error's attribute `result` is what it did up to there"
    return kind(f"{sentence}; {where}", recorder.result(), sentence)


def signal_groups(network: Network) -> list[SignalGroup]:
    """Of all participants in the order of the network, then of the scene."""
    groups = [
        SignalGroup.of(p.name, recorded_layout(p.observation_layout), p.noun) for p in network.participants
    ]
    names, units, descriptions = zip(*SCENE_CHANNELS, strict=True)
    return [*groups, SignalGroup("scene", names, units, (1,) * len(names), descriptions)]


def _provenance(assembly: Assembly, participants: Sequence[Participant]) -> dict[str, str]:
    """The scene with its layers merged, flexible bodies, versions and the digest of every FMU's content."""
    found = {
        "scene": assembly.name,
        "scene_tree": json.dumps(assembly.scene_tree),
        "flexible": json.dumps(assembly.flexible),
        "large_deformation": json.dumps(assembly.large_deformation),
        "second_order_modes": json.dumps(
            {part.name: second_order_modes(part) for part in assembly.parts if part.name in assembly.flexible}
        ),
        "python": platform.python_version(),
    }
    found.update(_versions())
    for participant in participants:
        if isinstance(participant, FmiParticipant):
            found[f"fmu.{participant.name}"] = participant.digest
    found.update({f"fmu.{fmu.name}": content_digest(fmu.path) for fmu in assembly.signal_fmus})
    return found


@cache
def _versions() -> Mapping[str, str]:
    """Of the packages that a result depends on."""
    return {name: version(name) for name in _PACKAGES}


def _settings(settings: Settings, end: float, kind: MasterKind, order: Order) -> dict[str, str]:
    """What this run was asked for, which its scene may not say, and when."""
    found = {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "master": kind,
        "order": str(order),
        "until": f"{end:g} s",
        "tolerance": f"{settings.asked_tolerance or settings.tolerance:g}",
    }
    if settings.asked_tolerance is not None:
        found["refined_tolerance"] = f"{settings.tolerance:g}"
    if settings.fixed_step is not None:
        found["step"] = f"{settings.fixed_step:g} s"
    return found
