"""Derivatives of headline numbers by keys of a scene, through all steps and events of a deployment.

A run chooses its steps. They are replayed once as they are, and once for every key with a slightly different value; the
derivative is the difference of the headline numbers over that of the key. All replays make the same steps, so the
difference has no error of step control (internal numerical differentiation, Bock 1981). Each replay ends its steps at
its own latch-ups and events. What the steps themselves err by is measured: the runs are repeated at a tenth of the
tolerance, with every key changed to the other side. The derivatives are those of the smaller tolerance, and their
errors the differences from those of the larger one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import zip_longest
from math import inf, nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector

from ...assembly import Assembly
from ...assembly.statics.start import static_start
from ...cosim.settings import Settings as MasterSettings
from ...cosim.step_plan import to_own_events
from ...records import short_repr
from ...results.number import Number
from ...results.round_off import noise_floor
from ...run.load_energy import with_energy_of_loads
from ...run.progress import silent
from ...run.run import Loader, Outcome, kept_fmus, run
from ...run.simulation import Options
from ...scene import SceneError
from ...scene.builder import Scene
from ...scene.layers import Tree
from ...scene.schema import TOLERANCES
from .distributions import StudyError
from .varied import Settings, keys_of, meant, multiplied, own_value, value_at, written_to

PART = 5e-6
"""Relative change of a key. The second derivative errs with it, rounding against it."""
_OF_ZERO = 1.0
"""In its unit: what a key of zero is taken for, as it has no part."""
REPLAYED = 1e-6
"""Tolerance of replays, which sets that of their iterations: at 1e-7 round-off keeps some steps from converging, and
derivatives differ by 1e-5."""
_NO_NUMBERS = ("end time", "energy residual", "numerical energy loss")
_LOADS = ("N", "N.m")
_MOVED = 1e-12
"""Of a number, relative to the largest of its kind: smaller changes are rounding."""
_FINER = 0.1
"""Tolerance of the second pass, over that of the first."""
_DOUBTFUL = 0.1
"""Relative error of a gradient from which on it is called unreliable."""


@short_repr
@dataclass(frozen=True, slots=True)
class Gradients:
    """Derivatives of the headline numbers of a scene with respect to its keys.

    keys, values, units (P): of the keys, 1 for factors. numbers (N): of the run without changes. derivatives (N, P): in
    the unit of the number over that of the key. errors (N): of each gradient relative to its size; single_errors (N,
    P): of single derivatives, in their units; both NaN where nothing moves a number, and without verification.
    """

    scene: str
    keys: tuple[str, ...]
    values: tuple[float, ...]
    units: tuple[str, ...]
    numbers: tuple[Number, ...]
    derivatives: Vector
    errors: Vector
    single_errors: Vector

    @property
    def names(self) -> tuple[str, ...]:
        """Identifiers of the numbers, such as `latch_time.HL1`."""
        return tuple(one.id for one in self.numbers)

    @property
    def round_off(self) -> NDArray[np.bool_]:
        """(N,) whether a number is round-off relative to its kind, such as a load across a symmetric wing."""
        return _round_off(self.numbers)

    @property
    def relative(self) -> Vector:
        """(N, P) relative change of a number over that of a key; not a number where the number is zero."""
        sizes = np.array([abs(one.value) or nan for one in self.numbers])
        found: Vector = self.derivatives * np.array(self.values) / sizes[:, None]
        return found

    @property
    def unreliable(self) -> tuple[str, ...]:
        """Names of numbers without meaningful derivatives, whose error is more than a tenth of the gradient."""
        return tuple(name for name, error in zip(self.names, self.errors, strict=True) if error > _DOUBTFUL)

    @property
    def warning(self) -> str:
        """Warning about unreliable derivatives; empty if there are none."""
        if not self.unreliable:
            return ""
        return (
            f"{self.scene}: derivatives of {', '.join(self.unreliable)} are unreliable: those at ten times the "
            "tolerance differ by more than a tenth. Try a smaller tolerance, or latches with springs."
        )

    def plain(self) -> dict[str, object]:
        """For JSON, with None for NaN; numbers by identifier, in the order of the rows."""
        arrays = {
            "derivatives": self.derivatives,
            "relative": self.relative,
            "errors": self.errors,
            "single_errors": self.single_errors,
        }
        numbers = {one.id: one.as_dict() for one in self.numbers}
        listed = {name: _listed(array) for name, array in arrays.items()}
        return {**asdict(self), "numbers": numbers, **listed}

    def of(self, number: str, key: str) -> float:
        """Derivative of a number, such as `latch_time.HL1`, by a key; StudyError where there is none."""
        for one, known, what in ((number, self.names, "number"), (key, self.keys, "key")):
            if one not in known:
                raise StudyError(f"{self.scene}: there is no {what} {one!r}; those are {', '.join(known)}")
        return float(self.derivatives[self.names.index(number), self.keys.index(key)])


def _listed(numbers: Vector) -> object:
    found = numbers.astype(object)
    found[~np.isfinite(numbers)] = None
    return found.tolist()


class Parameter(NamedTuple):
    """Keys of a scene that change together: to a value in a unit, or by a factor of what each has."""

    name: str
    keys: tuple[str, ...]
    value: float
    unit: str
    factor: bool

    def settings(self, tree: Tree, value: float) -> Settings:
        """Settings with which it has another value."""
        if not self.factor:
            return written_to(self.keys, value, self.unit)
        return multiplied(tree, self.keys, value)


class _Slopes(NamedTuple):
    """Headline numbers (N) of a run, and their derivatives by the parameters (N, P)."""

    numbers: tuple[Number, ...]
    derivatives: Vector


def parameter(tree: Tree, text: str) -> Parameter:
    """What KEY, KEY,KEY or KEY* means in a scene; StudyError where that is no number."""
    keys, factor = keys_of(text)
    found = {key: value_at(tree, key) for key in keys}
    for key, value in found.items():
        if value is None:
            raise StudyError(
                f"{key}: the scene has no value there{meant(tree, key)}; give it one, such as with --set"
            )
    if factor:
        return Parameter(text, keys, 1.0, "", True)
    own = {key: own_value(value) for key, value in found.items()}
    for key, number in own.items():
        if number is None:
            raise StudyError(
                f"{key}: {found[key]!r} is no number; name the numbers within it, or write {key}*"
            )
    if len(set(own.values())) > 1:
        raise StudyError(f"{text}: values differ; write {text}* for a factor of all of them")
    value, unit = own[keys[0]] or (0.0, "")
    return Parameter(text, keys, value, unit, False)


def gradients(
    scene: Scene,
    options: Options,
    keys: Sequence[str],
    *,
    verify: bool = False,
    watch: Callable[[float, float], None] = lambda time, h: None,
) -> Gradients:
    """Deploy a scene and replay it with slightly different keys.

    verify: once more at a tenth of the tolerance, for smaller errors that are known. FanfoldError where one of the runs
    does not reach its end, or where a small change makes other events happen.
    """
    _refuse(keys, options)
    parameters = [parameter(scene.tree, key) for key in keys]
    assembly = static_start(options.assemble(scene.check_one_run())).assembly
    settings, end = options.settings(assembly), options.until or assembly.until
    with kept_fmus(options.backend, isolate=options.isolate, files=False) as load:
        assembly = with_energy_of_loads(assembly, settings, end, options.master, silent, load)
        replays = _Replays(scene, options, parameters, assembly, end, load, watch)
        found = replays.slopes(settings, 1.0)
        off = np.full(found.derivatives.shape, nan)
        if verify:
            tolerance = max(_FINER * settings.tolerance, TOLERANCES[0])
            # smooth motion takes the largest steps at any tolerance
            finer = replace(settings, tolerance=tolerance, largest_step=0.5 * settings.largest_step)
            coarse, found = found, replays.slopes(finer, -1.0)
            off = np.abs(_aligned(coarse, found) - found.derivatives)
    return Gradients(
        assembly.name,
        tuple(one.name for one in parameters),
        tuple(one.value for one in parameters),
        tuple(one.unit for one in parameters),
        found.numbers,
        found.derivatives,
        _shares(found, off, np.array([_size(one) for one in parameters])),
        off,
    )


class _Replays(NamedTuple):
    """Runs of a scene on the same steps, with and without slightly different parameters, to an end time (s)."""

    scene: Scene
    options: Options
    parameters: Sequence[Parameter]
    assembly: Assembly
    end: float
    load: Loader
    watch: Callable[[float, float], None]

    def slopes(self, settings: MasterSettings, way: float) -> _Slopes:
        """Derivatives on the steps of a run with these settings; way: 1.0 for larger values, -1.0 for smaller ones."""
        steps = to_own_events(self._run(self.assembly, settings).segments)
        replayed = replace(settings, tolerance=REPLAYED, fixed_step=None, step_plan=steps)
        here = self._run(self.assembly, replayed)
        # steps that do not converge to this tolerance are divided, in all replays alike
        replayed = replace(replayed, step_plan=to_own_events(here.segments))
        numbers = tuple(one for one in here.headline.numbers() if one.quantity not in _NO_NUMBERS)
        columns = []
        for one in self.parameters:
            step, changed = self._changed(one, way)
            there = self._run(changed, replayed)
            self._refuse_other_events(here, there, one)
            values = {number.key: number.value for number in there.headline.numbers()}
            columns.append([(values.get(number.key, nan) - number.value) / step for number in numbers])
        return _Slopes(numbers, np.array(columns).T)

    def _run(self, assembly: Assembly, settings: MasterSettings) -> Outcome:
        return run(assembly, None, settings, self.end, watch=self.watch, load=self.load)

    def _changed(self, one: Parameter, way: float) -> tuple[float, Assembly]:
        """A small step of a parameter, and the scene with it; to the other side where it can only go there."""
        refused: list[SceneError] = []
        for step in (way * PART * _size(one), -way * PART * _size(one)):
            try:
                other = self.scene.with_settings(one.settings(self.scene.tree, one.value + step))
                return step, self.options.assemble(other.check_one_run())
            except SceneError as error:
                refused.append(error)
        raise refused[0]

    def _refuse_other_events(self, here: Outcome, there: Outcome, one: Parameter) -> None:
        """StudyError where the replay has other events, or other steps between them."""
        nothing = (self.end, "", "")
        events = zip_longest(here.result.events, there.result.events, fillvalue=nothing)
        times = [min(ours[0], theirs[0]) for ours, theirs in events if ours[1:] != theirs[1:]]
        steps = zip_longest(map(len, here.segments), map(len, there.segments))
        times += [
            sum(map(sum, here.segments[: k + 1])) for k, (ours, theirs) in enumerate(steps) if ours != theirs
        ]
        if not times:
            return
        time = min(times)
        raise StudyError(
            f"{self.assembly.name}: with {one.name} changed by {PART:g} of its value, other events come near "
            f"t = {time:.6g} s, or in another order; numbers have no derivatives there"
        )


def _size(one: Parameter) -> float:
    """What small steps of a parameter are relative to."""
    return abs(one.value) or _OF_ZERO


def _aligned(other: _Slopes, found: _Slopes) -> Vector:
    """(N, P) derivatives of the numbers of another run; infinite for those that it does not have."""
    rows = {number.key: row for number, row in zip(other.numbers, other.derivatives, strict=True)}
    missing = np.full(found.derivatives.shape[1], inf)
    return np.array([rows.get(number.key, missing) for number in found.numbers])


def _shares(found: _Slopes, off: Vector, sizes: Vector) -> Vector:
    """(N,) errors over gradients; NaN where a number is round-off relative to its kind, or nothing moves it."""
    groups = _groups(found.numbers)
    least = _MOVED / PART * np.array([max(map(abs, groups[_like(one)])) for one in found.numbers])
    whole, error = (np.linalg.norm(of * sizes, axis=1) for of in (found.derivatives, off))
    shares: Vector = error / np.where(~_round_off(found.numbers) & (whole > least), whole, nan)
    return shares


def _groups(numbers: Sequence[Number]) -> dict[str, list[float]]:
    """Values of numbers that are judged beside each other."""
    groups: dict[str, list[float]] = {}
    for one in numbers:
        groups.setdefault(_like(one), []).append(one.value)
    return groups


def _round_off(numbers: Sequence[Number]) -> NDArray[np.bool_]:
    """(N,) whether numbers are nothing beside their like."""
    groups = _groups(numbers)
    return np.array([abs(one.value) <= noise_floor(groups[_like(one)]) for one in numbers], dtype=bool)


def _like(number: Number) -> str:
    """What a number is judged beside: forces beside torques, whose noise they carry in a wing without forces."""
    return "load" if number.unit in _LOADS else number.quantity


def _refuse(keys: Sequence[str], options: Options) -> None:
    if options.master != "implicit":
        raise StudyError(f"derivatives need the implicit master; this is {options.master}")
    if not keys:
        raise StudyError("there is no key to differentiate by; give one, such as hinge_line.HL1.motor.stowed")
    if twice := sorted({key for key in keys if keys.count(key) > 1}):
        raise StudyError(f"{', '.join(twice)}: given twice; a key has one derivative")
