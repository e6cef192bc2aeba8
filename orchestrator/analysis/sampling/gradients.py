"""Derivatives of headline numbers by keys of a scene, through all steps and events of one deployment.

Every key has a neighbour of the run, in which it differs by a small part; the derivative is the difference of their
numbers over it. Both make the same steps with the same factors, so the errors of steps and iterations are not in it:
internal numerical differentiation (Bock 1981). Latch-ups come earlier or later in a neighbour, and are met there.
One neighbour more differs in all keys at once, to the other side: what its numbers miss of what the derivatives say
tells how far these can be trusted, which is nothing where peaks are those of chaotic ringing. It knows nothing of the
errors that all steps share, nor of those of single keys that are small beside others: a run at a smaller tolerance with
neighbours of its own does.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from math import nan
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector

from ...assembly import Assembly
from ...cosim.sensitivity.solvers import AstrayError
from ...records import short_repr
from ...results.key_figures import Number, headline
from ...results.result import Result
from ...results.round_off import noise_floor
from ...run.simulation import Options
from ...scene import SceneError
from ...scene.builder import Scene
from ...scene.layers import Tree
from ...scene.schema import TOLERANCES
from .distributions import StudyError
from .neighbours import Followed, run_beside
from .varied import Settings, keys_of, meant, multiplied, own_value, value_at, written_to

PART = 5e-6
"""Of a key: what it differs by. The second derivative errs with it, the rounding of stiff joints against it."""
CENTRAL_PART = 5e-5
_SMALLER = (1.0, 0.1, 0.01)
"""Of these parts, one after the other, where neighbours cannot follow: an event comes within a tiny step of the run."""
_OF_ZERO = 1.0
"""In its unit: what a key of zero is taken for, as it has no part."""
_NO_NUMBERS = ("end time", "energy residual", "numerical energy loss")
_LOADS = ("N", "N.m")
_MOVED = 1e-12
"""Of a number, beside its like: changes below it are rounding, of what no key moves."""
_FINER = 0.1
"""Tolerance of a run that verifies, over that of the run."""
_DOUBTFUL = 0.1
"""Of a gradient: an estimated error beyond which it is told of."""


@short_repr
@dataclass(frozen=True, slots=True)
class Gradients:
    """Derivatives of the headline numbers of a scene with respect to its keys.

    keys, values, units (P): of the keys, 1 for factors. numbers (N): of the nominal run. derivatives (N, P): in the
    unit of the number over that of the key. errors (N): of each gradient relative to its size; NaN if it is zero.
    single_errors (N, P): of single derivatives, in their units; NaN without verification. unverified: why verification
    failed, if it did.
    """

    scene: str
    keys: tuple[str, ...]
    values: tuple[float, ...]
    units: tuple[str, ...]
    numbers: tuple[Number, ...]
    derivatives: Vector
    errors: Vector
    single_errors: Vector
    unverified: str = ""

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
        """Names of numbers without meaningful derivatives: effects of small changes of the keys are not additive."""
        return tuple(name for name, error in zip(self.names, self.errors, strict=True) if error > _DOUBTFUL)

    @property
    def warning(self) -> str:
        """Warning about unreliable derivatives and unknown errors; empty if there are none."""
        sentences = []
        if self.unverified:
            sentences.append(
                f"{self.scene}: the errors do not include step-size errors, because no neighbouring run could follow a "
                f"run at a tenth of the tolerance: {self.unverified}"
            )
        if unreliable := ", ".join(self.unreliable):
            sentences.append(
                f"{self.scene}: derivatives of {unreliable} are unreliable: the effect of all keys together is not the "
                "sum of their single effects. Try a smaller tolerance, or latches with springs."
            )
        return "\n".join(sentences)

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


class PerturbedValue(NamedTuple):
    """A value of a parameter beside its own, and what it makes of the scene."""

    value: float
    assembly: Assembly


class Together(NamedTuple):
    """A neighbour in all parameters at once. steps (P): what each of them differs by."""

    steps: Vector
    assembly: Assembly


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
    central: bool = False,
    verify: bool = False,
    watch: Callable[[float, float], None] = lambda time, h: None,
) -> Gradients:
    """Deploy a scene and its neighbours; FanfoldError where one of them cannot, or where there is no derivative.

    central: two neighbours a key, with differences whose error goes with the square of the part. verify: a run at a
    tenth of the tolerance, with one neighbour a key and one in all, for errors that those of the steps are part of.
    """
    _refuse(keys, options)
    assembly = options.assemble(scene.check_one_run())
    parameters = [parameter(scene.tree, key) for key in keys]
    astray = ""
    for smaller in _SMALLER:
        part = smaller * (CENTRAL_PART if central else PART)
        beside = [_neighbours(scene, options, one, part, central=central) for one in parameters]
        together = _together(scene, options, parameters, beside, central=central)
        try:
            followed = _follow(assembly, options, parameters, beside, together, watch)
        except AstrayError as error:
            astray = str(error)
            continue
        finer, unverified = None, ""
        try:
            finer = _follow_finer(assembly, options, parameters, beside, together, watch) if verify else None
        except AstrayError as error:
            unverified = str(error)
        found = _told(assembly, parameters, beside, together, followed, finer)
        return replace(found, unverified=unverified)
    raise StudyError(f"{assembly.name}: {astray}; derivatives cannot be computed")


def _follow(
    assembly: Assembly,
    options: Options,
    parameters: Sequence[Parameter],
    beside: Sequence[Sequence[PerturbedValue]],
    together: Sequence[Together],
    watch: Callable[[float, float], None],
) -> Followed:
    others = _named(parameters, beside)
    others |= {f"all of them {way}": one.assembly for one, way in zip(together, "-+", strict=False)}
    return run_beside(assembly, others, options.settings(assembly), options.until or assembly.until, watch)


def _named(
    parameters: Sequence[Parameter], beside: Sequence[Sequence[PerturbedValue]]
) -> dict[str, Assembly]:
    """Neighbours by what they are called, in order."""
    return {
        f"{one.name} {'+' if side.value > one.value else '-'}": side.assembly
        for one, sides in zip(parameters, beside, strict=True)
        for side in sides
    }


def _follow_finer(
    assembly: Assembly,
    options: Options,
    parameters: Sequence[Parameter],
    beside: Sequence[Sequence[PerturbedValue]],
    together: Sequence[Together],
    watch: Callable[[float, float], None],
) -> Followed:
    """A run at a smaller tolerance, with the first neighbour of every key and that in all of them.

    Its largest step is half as long: smooth motion takes the largest at any tolerance.
    """
    settings = options.settings(assembly)
    finer = max(_FINER * settings.tolerance, TOLERANCES[0])
    settings = replace(settings, tolerance=finer, largest_step=0.5 * settings.largest_step)
    others = _named(parameters, [sides[:1] for sides in beside]) | {"all of them": together[0].assembly}
    return run_beside(assembly, others, settings, options.until or assembly.until, watch)


def _told(
    assembly: Assembly,
    parameters: Sequence[Parameter],
    beside: Sequence[Sequence[PerturbedValue]],
    together: Sequence[Together],
    followed: Followed,
    finer: Followed | None,
) -> Gradients:
    numbers = [one for one in headline(followed.result).numbers() if one.quantity not in _NO_NUMBERS]
    here = np.array([one.value for one in numbers])
    others = iter([_values(numbers, result) for result in followed.neighbours])
    ends = [[(side.value - one.value, next(others)) for side in sides]
            for one, sides in zip(parameters, beside, strict=True)]  # fmt: skip
    slopes = np.column_stack([_slope(here, sides) for sides in ends])
    steps, change = together[0].steps, next(others) - here
    for one in together[1:]:
        steps, change = 0.5 * (steps - one.steps), 0.5 * (change - (next(others) - here))
    off, single = np.abs(change - slopes @ steps), np.full(slopes.shape, nan)
    if finer is not None:
        there, *apart, neighbour = (_values(numbers, result) for result in (finer.result, *finer.neighbours))
        off = np.fmax(off, np.abs(neighbour - there - slopes @ together[0].steps))
        finer_slopes = np.column_stack(
            [(value - there) / sides[0][0] for value, sides in zip(apart, ends, strict=True)]
        )
        single = np.abs(slopes - finer_slopes)
        # those of single keys may cancel in the neighbour in all of them
        off = np.fmax(off, np.linalg.norm(single * together[0].steps, axis=1))
    return Gradients(
        assembly.name,
        tuple(one.name for one in parameters),
        tuple(one.value for one in parameters),
        tuple(one.unit for one in parameters),
        tuple(numbers),
        slopes,
        _beside_locks(assembly, numbers, _shares(numbers, off, np.linalg.norm(slopes * steps, axis=1))),
        single,
    )


def _beside_locks(assembly: Assembly, numbers: Sequence[Number], errors: Vector) -> Vector:
    """Errors, of loads and impulses as large as the gradient where rigid bodies lock.

    The rates of stiff joints that an impulse meets are chance, and alike in neighbours: nothing else tells.
    """
    if not any(line.locks_rigid for line in assembly.hinge_lines):
        return errors
    loads = np.array([one.unit in (*_LOADS, "N.m.s") for one in numbers])
    return np.where(loads & (errors < 1.0), 1.0, errors)


def _values(numbers: Sequence[Number], result: Result) -> Vector:
    """(N,) the same numbers of another run; not a number for what it does not have."""
    found = {one.key: one.value for one in headline(result).numbers()}
    return np.array([found.get(one.key, nan) for one in numbers])


def _slope(here: Vector, sides: Sequence[tuple[float, Vector]]) -> Vector:
    """(N,) differences of numbers over that of the key, between the run and its neighbour, or its two."""
    (step, there), *other = sides
    before, value = other[0] if other else (0.0, here)
    return (there - value) / (step - before)


def _shares(numbers: Sequence[Number], off: Vector, whole: Vector) -> Vector:
    """(N,) errors over gradients; not a number where a number is round-off beside its like, or nothing moves it."""
    groups = _groups(numbers)
    least = _MOVED * np.array([max(map(abs, groups[_like(one)])) for one in numbers])
    size = np.where(~_round_off(numbers) & (whole > least), whole, nan)
    found: Vector = off / size
    return found


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


def _together(
    scene: Scene,
    options: Options,
    parameters: Sequence[Parameter],
    beside: Sequence[Sequence[PerturbedValue]],
    *,
    central: bool,
) -> list[Together]:
    """All parameters at once as far off as their neighbours: to the other side, and to this one where it is central."""
    steps = np.array([sides[0].value - one.value for one, sides in zip(parameters, beside, strict=True)])
    found = [_all_at_once(scene, options, parameters, -steps)]
    return [*found, _all_at_once(scene, options, parameters, steps)] if central else found


def _all_at_once(scene: Scene, options: Options, parameters: Sequence[Parameter], steps: Vector) -> Together:
    """All parameters changed by steps, or each to the side where it can be."""
    taken = steps
    try:
        found = _changed(scene, parameters, taken).check_one_run()
    except SceneError:
        ways = [_way(scene, one, step) for one, step in zip(parameters, steps.tolist(), strict=True)]
        taken = steps * ways
        found = _changed(scene, parameters, taken).check_one_run()
    return Together(taken, options.assemble(found))


def _way(scene: Scene, one: Parameter, step: float) -> float:
    """1 where a parameter can be a step further, else -1."""
    try:
        _changed(scene, [one], np.array([step])).check_one_run()
    except SceneError:
        return -1.0
    return 1.0


def _changed(scene: Scene, parameters: Sequence[Parameter], steps: Vector) -> Scene:
    """A scene whose parameters are steps further; factors after values, as they may be of the same keys."""
    for one, step in sorted(zip(parameters, steps.tolist(), strict=True), key=lambda pair: pair[0].factor):
        scene = scene.with_settings(one.settings(scene.tree, one.value + step))
    return scene


def _refuse(keys: Sequence[str], options: Options) -> None:
    if options.master != "implicit" or options.backend == "python" or options.order == 2 or options.isolate:
        raise StudyError(
            "derivatives come from native FMUs in this process, and the implicit master of order 4"
        )
    if not keys:
        raise StudyError("there is no key to differentiate by; give one, such as hinge_line.HL1.motor.stowed")
    if twice := sorted({key for key in keys if keys.count(key) > 1}):
        raise StudyError(f"{', '.join(twice)}: given twice; a key has one derivative")


def _neighbours(
    scene: Scene, options: Options, one: Parameter, part: float, *, central: bool
) -> list[PerturbedValue]:
    """On both sides of a parameter where both can be and are wanted, or on the first that can be."""
    step = part * (abs(one.value) or _OF_ZERO)
    found: list[PerturbedValue] = []
    refused: list[SceneError] = []
    for value in (one.value + step, one.value - step):
        try:
            other = scene.with_settings(one.settings(scene.tree, value)).check_one_run()
            found.append(PerturbedValue(value, options.assemble(other)))
        except SceneError as error:
            refused.append(error)
        if found and not central:
            break
    if not found:
        raise refused[0]
    return found
