"""Simulation of a scene from start to end: fidelities, accuracy, master, estimated errors, warnings."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path

from components.cache.disk import unwritable_cache
from fmus import Backend, native_library

from ..assembly import Assembly
from ..assembly.assemble import assemble
from ..assembly.statics.start import static_start
from ..cosim.ports import Order
from ..cosim.settings import Settings
from ..messages import coded, is_note, message
from ..results.attitude import turned_over
from ..results.earlier import SETTINGS, WAY_OUT, settings_text
from ..results.earlier import refuse_to_lose as refuse_to_lose_result
from ..results.result_file import refuse_to_replace, with_messages
from ..scene import PlacedScene, read_scene
from ..scene.component_connections import WrenchMode
from ..scene.digests import digests
from ..scene.schema import SMALLEST_STEP, TOLERANCES
from ..validity.axial_load import axial_load_warnings
from ..validity.before_run import warnings_before_run
from ..validity.centrifugal_stiffening import unstiffened_spins
from ..validity.creep import creep_warnings
from ..validity.events import event_warnings
from ..validity.linear_range import linear_range_warnings
from ..validity.opened_joints import opened_joint_warnings
from ..validity.sampled_loops import sampled_loop_warnings
from ..validity.signal_fmus import order_of_fmus
from ..validity.travel import travel_warnings
from .checkpoint import Checkpoint, checkpoint_file
from .error_estimate import with_estimates
from .load_energy import with_energy_of_loads
from .preload import let_go_at_start, lost_preloads, moved_starts
from .progress import Progress, followed, silent
from .recording import Recording
from .run import Loader, MasterKind, Outcome, RunError, as_fmus, kept_fmus, run
from .verify import Verified, verify

Warn = Callable[[str], None]
_NAMES = ("rigid", "flexible", "large_deformation", "signals")
_DAMPED, _TIMES_DAMPED = 0.05, 3.0
"""Part of critical damping, and times what was asked, beyond which a latch shows another peak."""


@dataclass(frozen=True, slots=True)
class Options:
    """How to run a scene; None is the value of the scene, or the best one.

    rigid, flexible, large_deformation: names of bodies, "all" for every one. until: end time, s. tolerance: relative
    accuracy. step: constant communication step size, s. order: of the coupling. checkpoint: simulated time between
    checkpoints, s.
    refine: repeat a run that is likely to miss its tolerance at a smaller one. isolate: every FMU in its own process.
    record: time between rows of the result in addition to those of events and peaks, s; by default all rows.
    signals: patterns of signals in addition to those of headline numbers. RunError for invalid values.
    """

    rigid: Collection[str] = ()
    flexible: Collection[str] = ()
    large_deformation: Collection[str] = ()
    until: float | None = None
    tolerance: float | None = None
    step: float | None = None
    order: Order | None = None
    master: MasterKind = "implicit"
    backend: Backend | None = None
    checkpoint: float | None = None
    refine: bool = True
    isolate: bool = False
    record: float | None = None
    signals: Collection[str] = ()

    def __post_init__(self) -> None:
        low, high = TOLERANCES
        if self.until is not None and not 0.0 < self.until < float("inf"):
            raise RunError(f"the end time is {self.until:g} s; it must be positive and finite")
        if self.tolerance is not None and not low <= self.tolerance <= high:
            raise RunError(f"the tolerance is {self.tolerance:g}; it must be between {low:g} and {high:g}")
        if self.step is not None and not SMALLEST_STEP <= self.step < float("inf"):
            raise RunError(
                f"the step is {self.step:g} s; it must be finite, and {SMALLEST_STEP:g} s at least"
            )
        if self.order not in (None, 2, 4):
            raise RunError(f"the order of the coupling is {self.order!r}; it must be 2 or 4")
        if self.master not in ("implicit", "jacobi", "gauss-seidel"):
            raise RunError(f"there is no master {self.master!r}; masters are implicit, jacobi, gauss-seidel")
        if self.master != "implicit" and self.step is None:
            raise RunError("an explicit master needs a step that is stable; for rigid wings try 2e-5 s")
        if self.backend not in (None, "native", "python"):
            raise RunError(f"there is no back end {self.backend!r}; back ends are native and python")
        if self.backend == "native" and native_library() is None:
            raise RunError("there is no native library here; install Fanfold again")
        _refuse_spacing("recorded rows", self.record)
        _refuse_spacing("checkpoints", self.checkpoint)
        if self.checkpoint is not None and self.master != "implicit":
            raise RunError("only runs of the implicit master have checkpoints; leave one of both out")

    def assemble(self, scene: PlacedScene) -> Assembly:
        """A scene at these fidelities, for this master."""
        mode: WrenchMode = "mean" if self.master == "implicit" else "endpoint"
        return assemble(scene, self.rigid, self.flexible, mode, self.large_deformation)

    def settings(self, assembly: Assembly) -> Settings:
        """Numbers of the master for an assembly."""
        return Settings(
            tolerance=self.tolerance or assembly.tolerance,
            largest_step=assembly.largest_step,
            fixed_step=self.step,
            order=self.order,
            snapshot_every=self.checkpoint,
        )

    def asked(self, scene: PlacedScene, estimate: bool) -> dict[str, object]:
        """Settings of a run for its checkpoint, as JSON."""
        return {"file": scene.file, "tree": scene.tree, "options": self._plain(), "estimate": estimate}

    def made_with(self, scene: PlacedScene, estimate: bool) -> dict[str, object]:
        """All settings that determine a result, apart from its scene, as JSON; processes do not change it."""
        options = self._plain()
        del options["isolate"]
        options["until"] = self.until or scene.header.until
        options["tolerance"] = self.tolerance or scene.header.tolerance
        return {**options, "estimate": estimate, "files": digests(scene)}

    def _plain(self) -> dict[str, object]:
        """Every option by its name, as JSON."""
        names = {name: sorted(getattr(self, name)) for name in _NAMES}
        return {one.name: getattr(self, one.name) for one in fields(self)} | names


@dataclass(frozen=True, slots=True)
class Simulation:
    """A finished run, and what it takes to repeat it."""

    assembly: Assembly
    settings: Settings
    until: float
    load: Loader
    outcome: Outcome

    def verify(self, progress: Progress = silent) -> list[Verified]:
        """Run twice more with every step halved and quartered; results go next to the first, if it has a file."""
        with followed(progress, self.assembly.name, self.until) as watch:
            return verify(self.assembly, self.outcome, self.settings, self.until, watch, self.load)


def simulate(
    scene: PlacedScene,
    options: Options,
    output: Path | None = None,
    *,
    estimate: bool = True,
    progress: Progress = silent,
    warn: Warn = lambda sentence: None,
    checks: bool = True,
    start: Checkpoint | None = None,
    fmus: Loader | None = None,
) -> Simulation:
    """Run a scene into a file or, without one, into memory; RunError or SceneError where that cannot be.

    estimate: find the errors of headline numbers by a coarser run, at half the cost. warn: called with every warning.
    checks: whether the scene before the run and the result after it are searched for what to warn of.
    start: the checkpoint to go on from. fmus: a loader of `kept_fmus` to share between runs, by default one of its own.
    """
    _refuse_output(options, output)
    messages: list[str] = []

    def tell(sentence: str) -> None:
        messages.append(sentence)
        if not is_note(sentence):
            warn(sentence)

    assembly = options.assemble(scene)
    for sentence in (*_missing_parts(options), *_before(scene, options, assembly)) if checks else ():
        tell(sentence)
    at_rest = static_start(assembly)
    for sentence in coded("W-preload", let_go_at_start(at_rest)):
        tell(sentence)
    settings, end = options.settings(assembly), options.until or assembly.until
    asked = options.asked(scene, estimate) | {SETTINGS: settings_text(options.made_with(scene, estimate))}
    own = kept_fmus(options.backend, isolate=options.isolate) if fmus is None else nullcontext(fmus)
    with own as load:
        resting = with_energy_of_loads(at_rest.assembly, settings, end, options.master, progress, load)
        with followed(progress, assembly.name, end) as watch:
            outcome = run(resting, output, settings, end, options.master, watch, tell, load, asked, start)
        settings = replace(settings, snapshot_every=None)
        if estimate:
            outcome, settings = with_estimates(
                resting,
                outcome,
                settings,
                end,
                refine=options.refine,
                progress=progress,
                note=tell,
                load=load,
            )
    for sentence in _after(scene, options, assembly, outcome) if checks else ():
        tell(sentence)
    kept = Recording(options.record, options.signals).applied(outcome.result, tell)
    outcome = replace(outcome, result=with_messages(kept, messages))
    for sentence in outcome.headline.warnings:
        warn(sentence)
    load_again = partial(as_fmus, backend=options.backend, isolate=options.isolate)
    return Simulation(resting, settings, end, load_again, outcome)


def _refuse_output(options: Options, output: Path | None) -> None:
    """RunError or ResultError where the result cannot be in this file, or in memory for None."""
    if output is not None:
        refuse_to_replace(output)
    elif options.checkpoint is not None:
        raise RunError("a run that keeps its result in memory has no checkpoints; give it a file")


def _missing_parts(options: Options) -> Iterator[str]:
    """Warnings of what the installation lacks."""
    sentences = {
        "W-backend": missing_backend(options.backend),
        "W-cache": unwritable_cache(),
    }
    yield from (message(code, sentence) for code, sentence in sentences.items() if sentence)


def _before(scene: PlacedScene, options: Options, assembly: Assembly) -> Iterator[str]:
    """Warnings about a scene before it is run."""
    bending = {*assembly.flexible, *assembly.large_deformation}
    yield from warnings_before_run(scene, assembly, bending, options.until)
    yield from coded(
        "W-held-body", _held_sentences(assembly, {*options.flexible, *options.large_deformation})
    )
    yield from coded("W-spin", unstiffened_spins(scene, assembly))
    yield from coded("N-fmu-order", order_of_fmus(assembly))


def _after(scene: PlacedScene, options: Options, assembly: Assembly, outcome: Outcome) -> Iterator[str]:
    """Warnings about a run."""
    if options.step is not None and outcome.costs.rejected:
        yield message("W-step-divided", _divided(assembly, options.step, outcome))
    yield from coded("W-fmu-loop", sampled_loop_warnings(assembly, outcome.result))
    yield from travel_warnings(outcome.result, outcome.headline)
    yield from coded("W-preload", lost_preloads(assembly, outcome.result))
    yield from coded("W-preload", moved_starts(assembly, outcome.result))
    yield from coded("W-event", event_warnings(assembly, outcome.result, options.until or assembly.until))
    yield from coded("W-joint-opened", opened_joint_warnings(scene, assembly, outcome.result))
    yield from linear_range_warnings(scene, assembly, outcome.result)
    yield from coded("W-compression", axial_load_warnings(scene, assembly, outcome.result))
    yield from coded("W-creep", creep_warnings(assembly, outcome.result))
    yield from coded("W-attitude", turned_over(outcome.result))


def _divided(assembly: Assembly, step: float, outcome: Outcome) -> str:
    """Warning about a constant step size (s) that was divided."""
    longest = max((max(segment, default=0.0) for segment in outcome.segments), default=0.0)
    return (
        f"{assembly.name}: {outcome.costs.rejected} steps of {step:g} s or less did not converge or gained energy "
        f"and were divided; the longest step is {longest:.3g} s. Use a smaller --step, or a tolerance."
    )


def resume(result: Path, progress: Progress = silent, warn: Warn = lambda sentence: None) -> Simulation:
    """Go on with an interrupted run from its checkpoint to its end; RunError where it cannot."""
    start = Checkpoint.read(result)
    asked = start.asked
    try:
        scene = read_scene(asked["file"], asked["tree"], of_result=True)
        options, estimate = Options(**asked["options"]), bool(asked["estimate"])
    except (KeyError, TypeError) as error:
        raise RunError(
            f"{checkpoint_file(result)}: the checkpoint is damaged and cannot be read ({error})"
        ) from None
    return simulate(scene, options, result, estimate=estimate, progress=progress, warn=warn, start=start)


def _refuse_spacing(what: str, seconds: float | None) -> None:
    if seconds is not None and not 0.0 < seconds < float("inf"):
        raise RunError(f"the time between {what} is {seconds:g} s; it must be positive and finite")


def missing_backend(backend: Backend | None) -> str:
    """Why PythonFMUs are used though no back end was chosen; empty if there is a native library."""
    if backend is not None or native_library() is not None:
        return ""
    return "there is no native library here, so slower PythonFMUs are used. Install Fanfold again."


def _held_sentences(assembly: Assembly, bending: Collection[str]) -> Iterator[str]:
    for name in sorted({*bending} - {"all", *assembly.flexible, *assembly.large_deformation}):
        yield (
            f"{assembly.name}: {name} stays rigid, because held hinge lines join it to a rigid group. Remove held "
            "= true from these lines if it should be flexible."
        )


def refuse_to_lose(path: Path, scene: PlacedScene, options: Options, estimate: bool) -> None:
    """ResultError or RunError where a file is no result of such a run, or is one to go on with, and would be lost."""
    refuse_to_replace(path)
    if path.is_file() and checkpoint_file(path).is_file():
        raise RunError(
            f"{path}: an interrupted run stands here. Go on with it by `fanfold resume {path}`, {WAY_OUT}"
        )
    refuse_to_lose_result(path, scene.tree, options.made_with(scene, estimate))


def fidelity_word(**kinds: Collection[str]) -> str:
    """What files are called by the bodies of each kind: rigid, ..., mixed; empty where all are as the scene says."""
    asked = {kind: frozenset(names) for kind, names in kinds.items() if names}
    if not asked:
        return ""
    kind = next(iter(asked))
    return kind if asked == {kind: {"all"}} else "mixed"


def result_file(name: str, variants: Sequence[str], fidelity: str = "", ending: str = "h5") -> Path:
    """File of the result of a scene with variants, at a fidelity, where none is named."""
    return Path(".".join(filter(None, (name, *variants, fidelity, ending))))


def phase_file(path: Path, phase: str) -> Path:
    """File of the result of one phase; the one named where the scene has no phases."""
    return path.with_suffix(f".{phase}{path.suffix}") if phase else path
