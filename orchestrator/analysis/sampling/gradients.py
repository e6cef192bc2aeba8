"""Derivatives of headline numbers by keys of a scene, through all steps and events of one deployment.

Every key has a neighbour of the run, in which it differs by a small part; the derivative is the difference of their
numbers over it. Both make the same steps with the same factors, so the errors of steps and iterations are not in it:
internal numerical differentiation (Bock 1981). Latch-ups come earlier or later in a neighbour, and are met there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector

from ...assembly import Assembly
from ...cosim.neighbours.solvers import AstrayError
from ...results.key_figures import Number, headline
from ...run.simulation import Options
from ...scene import SceneError
from ...scene.builder import Scene
from ...scene.layers import Tree
from .distributions import StudyError
from .neighbours import Followed, run_beside
from .varied import Settings, keys_of, multiplied, own_value, value_at, written_to

PART = 5e-6
"""Of a key: what it differs by. The second derivative errs with it, the rounding of stiff joints against it."""
CENTRAL_PART = 5e-5
_SMALLER = (1.0, 0.1, 0.01)
"""Of these parts, one after the other, where neighbours cannot follow: an event comes within a tiny step of the run."""
_OF_ZERO = 1e-4
_NO_NUMBERS = ("end time", "energy residual")


@dataclass(frozen=True, slots=True)
class Gradients:
    """What a scene's headline numbers do when its keys change, each by a little.

    keys: as they were given. values, units (P): of the keys, a factor being 1. numbers (N): those of the run.
    derivatives (N, P): in the unit of the number over that of the key.
    """

    scene: str
    keys: tuple[str, ...]
    values: tuple[float, ...]
    units: tuple[str, ...]
    numbers: tuple[Number, ...]
    derivatives: Vector

    @property
    def names(self) -> tuple[str, ...]:
        """Of the numbers, as in studies: "latch time HL1"."""
        return tuple(" ".join(filter(None, one.key)) for one in self.numbers)

    @property
    def relative(self) -> Vector:
        """(N, P) relative change of a number over that of a key; not a number where the number is zero."""
        sizes = np.array([abs(one.value) or nan for one in self.numbers])
        found: Vector = self.derivatives * np.array(self.values) / sizes[:, None]
        return found

    def of(self, number: str, key: str) -> float:
        """Derivative of a number, such as "latch time HL1", by a key."""
        return float(self.derivatives[self.names.index(number), self.keys.index(key)])


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


class Beside(NamedTuple):
    """A value of a parameter beside its own, and what it makes of the scene."""

    value: float
    assembly: Assembly


def parameter(tree: Tree, text: str) -> Parameter:
    """What KEY, KEY,KEY or KEY* means in a scene; StudyError where that is no number."""
    keys, factor = keys_of(text)
    found = {key: value_at(tree, key) for key in keys}
    for key, value in found.items():
        if value is None:
            raise StudyError(f"{key}: the scene has no value there; give it one, such as with --set")
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
    watch: Callable[[float, float], None] = lambda time, h: None,
) -> Gradients:
    """Deploy a scene and its neighbours; FanfoldError where one of them cannot, or where there is no derivative.

    central: two neighbours a key, with differences whose error goes with the square of the part.
    """
    _refuse(keys, options)
    assembly = options.assemble(scene.check_one_run())
    parameters = [parameter(scene.tree, key) for key in keys]
    astray = ""
    for smaller in _SMALLER:
        part = smaller * (CENTRAL_PART if central else PART)
        beside = [_neighbours(scene, options, one, part, central=central) for one in parameters]
        try:
            followed = _follow(assembly, options, parameters, beside, watch)
        except AstrayError as error:
            astray = str(error)
        else:
            return _told(assembly, parameters, beside, followed)
    raise StudyError(f"{assembly.name}: {astray}; its numbers have no derivative that can be told")


def _follow(
    assembly: Assembly,
    options: Options,
    parameters: Sequence[Parameter],
    beside: Sequence[Sequence[Beside]],
    watch: Callable[[float, float], None],
) -> Followed:
    others = {
        f"{one.name} {'+' if side.value > one.value else '-'}": side.assembly
        for one, sides in zip(parameters, beside, strict=True)
        for side in sides
    }
    return run_beside(assembly, others, options.settings(assembly), options.until or assembly.until, watch)


def _told(
    assembly: Assembly,
    parameters: Sequence[Parameter],
    beside: Sequence[Sequence[Beside]],
    followed: Followed,
) -> Gradients:
    numbers = [one for one in headline(followed.result).numbers() if one.quantity not in _NO_NUMBERS]
    here = {one.key: one.value for one in numbers}
    results = iter(followed.neighbours)
    columns = []
    for one, sides in zip(parameters, beside, strict=True):
        ends = [(side.value, {n.key: n.value for n in headline(next(results)).numbers()}) for side in sides]
        columns.append(_quotients(numbers, ends if len(ends) > 1 else [*ends, (one.value, here)]))
    return Gradients(
        assembly.name,
        tuple(one.name for one in parameters),
        tuple(one.value for one in parameters),
        tuple(one.unit for one in parameters),
        tuple(numbers),
        np.column_stack(columns),
    )


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
) -> list[Beside]:
    """On both sides of a parameter where both can be and are wanted, or on the first that can be."""
    step = part * abs(one.value) or _OF_ZERO
    found: list[Beside] = []
    refused: list[SceneError] = []
    for value in (one.value + step, one.value - step):
        try:
            other = scene.with_settings(one.settings(scene.tree, value)).check_one_run()
            found.append(Beside(value, options.assemble(other)))
        except SceneError as error:
            refused.append(error)
        if found and not central:
            break
    if not found:
        raise refused[0]
    return found


def _quotients(
    numbers: Sequence[Number], ends: Sequence[tuple[float, dict[tuple[str, str], float]]]
) -> Vector:
    """(N,) differences of numbers over that of the key; not a number for what only one of both runs has."""
    (value, there), (before, here) = ends
    return np.array(
        [(there.get(one.key, nan) - here.get(one.key, nan)) / (value - before) for one in numbers]
    )
