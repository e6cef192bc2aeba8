"""Requirements against the headline numbers of a run: met or not, by how much, and how certain that is."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from components.contract.errors import unknown
from components.contract.roles import LOAD
from components.numerics.port_loads import PortLoads

from ..assembly import Part
from ..assembly.assemble import connection_parts, groups_with_sites
from ..scene.placed_scene import PlacedScene
from ..scene.requirement_tables import Limit, limit
from ..scene.table import SceneError
from ..scene.units import QUANTITY, UNITS, in_unit
from .identifiers import BY_OWNER, OF_A_LATCH_UP, in_order, unit_of
from .number import Number
from .parts import json_of
from .result import ResultError

State = Literal["met", "not met", "within the error", "no such number"]
_AXES = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class Judged:
    """A requirement on one number of a run.

    text: the requirement, of this number. value, error: of the number, None where the run has none. margin: what is
    left up to the limit, negative where it is passed. All three are in `unit`, that of the limit. share: of the limit.
    """

    text: str
    value: float | None
    error: float | None
    margin: float | None
    share: float | None
    unit: str

    @property
    def state(self) -> State:
        """Whether it is met; within the error where the estimated error is larger than the margin."""
        if self.margin is None:
            return "no such number"
        if abs(self.margin) < (self.error or 0.0):
            return "within the error"
        return "met" if self.margin > 0.0 else "not met"

    @property
    def met(self) -> bool:
        """Whether it is met for certain."""
        return self.state == "met"


_MARGIN = "margin of "


def margin_of(requirement: str) -> str:
    """Name of the margin of a requirement among the numbers of a sample."""
    return f"{_MARGIN}{requirement}"


def requirement_of(number: str) -> str:
    """The requirement whose margin a number is; empty for any other."""
    return number.removeprefix(_MARGIN) if number.startswith(_MARGIN) else ""


def limits_of(scene_tree: str) -> tuple[str, ...]:
    """Limits in the scene that a result holds, as JSON; none in one that is damaged."""
    tree = json_of(scene_tree)
    table = tree.get("requirements") if isinstance(tree, Mapping) else None
    limits = table.get("limits") if isinstance(table, Mapping) else None
    return tuple(one for one in limits if _problem(one) is None) if isinstance(limits, list) else ()


def judged(
    limits: Iterable[str], numbers: Collection[Number], unlatched: Collection[str]
) -> tuple[Judged, ...]:
    """Each requirement on each number that it is about; unlatched: lines that have no numbers of a latch-up."""
    by_id = {number.id: number for number in numbers}
    found = []
    for text in limits:
        one = limit(text)
        for name in _meant(in_order(one.number), by_id, unlatched):
            found.append(_judged(one, name, by_id.get(name)))
    return tuple(found)


def _meant(name: str, known: Collection[str], unlatched: Collection[str]) -> list[str]:
    """Identifiers of the numbers that a name means: itself, or those of all components."""
    if name in known:
        return [name]
    every = [one for one in known if one.partition(".")[0] == name]
    if name in OF_A_LATCH_UP:
        every += [f"{name}.{line}" for line in unlatched]
    return every or [name]


def _judged(one: Limit, name: str, number: Number | None) -> Judged:
    unit = unit_of(name)
    written = QUANTITY.fullmatch(one.value)
    shown = (written[2] if written else "") or unit
    size = 1.0 / UNITS.get(unit, {}).get(shown, 1.0)
    text = f"{name} {one.sign} {one.value}"
    if number is None:
        return Judged(text, None, None, None, None, shown)
    most = in_unit(one.value, unit)
    margin = most - number.value if one.sign == "<" else number.value - most
    error = None if number.error is None else size * number.error
    return Judged(
        text, size * number.value, error, size * margin, margin / abs(most) if most else None, shown
    )


def requirements_sentence(found: Collection[Judged]) -> str:
    """How many requirements are met, and which are not; empty without any."""
    missed = [one for one in found if not one.met]
    if not found:
        return ""
    if not missed:
        return "The requirement is met." if len(found) == 1 else f"All {len(found)} requirements are met."
    verb = "is" if len(missed) == 1 else "are"
    named = ", ".join(
        f"{one.text} ({one.state if one.value is None else f'{one.value:.4g}'})" for one in missed[:3]
    )
    more = f" and {len(missed) - 3} more" if len(missed) > 3 else ""
    return f"{len(missed)} of {len(found)} requirements {verb} not met: {named}{more}."


def checked_limits(limits: Iterable[str]) -> tuple[str, ...]:
    """The limits; ResultError for one that means nothing."""
    found = tuple(limits)
    if problems := [problem for one in found if (problem := _problem(one))]:
        raise ResultError("\n".join(problems))
    return found


def refuse_unknown(scene: PlacedScene) -> None:
    """SceneError for requirements on numbers or components that there are none of, and units that do not fit."""
    if problems := list(_problems(scene)):
        raise SceneError([f"{scene.file}: requirements: {problem}" for problem in problems])


def _problems(scene: PlacedScene) -> Iterator[str]:
    known = _possible(scene) if scene.limits else {}
    for text in scene.limits:
        if problem := _problem(text):
            yield problem
            continue
        name, _, of = in_order(limit(text).number).partition(".")
        if not (names := known.get(name)):
            others = ", ".join(one for one, owners in known.items() if owners)
            yield f"{text!r}: no run of this scene has the number {name}; its numbers are {others}"
        elif of not in ("", *names):
            kind = (
                "hinge line" if name in (*BY_OWNER["latch"], *BY_OWNER["line without latch"]) else "component"
            )
            yield f"{text!r}: {of} {unknown(of, list(filter(None, names)), kind)}"


def _possible(scene: PlacedScene) -> dict[str, tuple[str, ...]]:
    """Names of components, lines, ports and axes that runs of a scene may have a number of, by quantity.

    A number of the whole has the name "". Whether a line latches, how and when, is known after a run only.
    """
    groups = groups_with_sites(scene)
    acting = {site.connection[0] for group in groups.values() for site in group.sites}
    rigid = {body.name: False for body in scene.bodies}
    parts = [part for part in connection_parts(scene, rigid, "mean") if part.name in acting]
    lines = [line for line in scene.hinge_lines if not line.held]
    at_base = tuple(site.name for site in groups[scene.base.name].sites)
    owners = {
        "run": ("",),
        "latch": tuple(line.name for line in lines if line.latch is not None),
        "line without latch": tuple(line.name for line in lines if line.latch is None),
        "free base": _AXES if scene.base.free is not None else (),
        "base": ("", *_AXES),
        "port": at_base,
        "hinge": tuple(hinge.name for line in lines for hinge in line.hinges if hinge.name not in at_base),
    }
    found = {quantity: owners[kind] for kind, quantities in BY_OWNER.items() for quantity in quantities}
    for quantity, component in _loads(scene, parts):
        found[quantity] = (*found.get(quantity, ()), component)
    return found


def _loads(scene: PlacedScene, parts: Iterable[Part]) -> Iterator[tuple[str, str]]:
    """Quantities of the loads of connections, and of bodies that follow laws, and the components."""
    signals = [
        (part.name, quantity)
        for part in parts
        for quantity in part.component().observation_layout.quantities
        if quantity.role == LOAD
    ]
    reactions = PortLoads((), np.zeros((0, 3)), is_base=False).observations[:2]
    signals += [(name, one) for name in scene.motions if name != scene.base.name for one in reactions]
    for name, quantity in signals:
        ends = ("peak",) if quantity.unit == "N.m" else ("min", "max")
        for axis in ("",) if quantity.size == 1 else _AXES:
            for end in ends:
                yield "_".join(filter(None, (quantity.name, axis, end))), name


def _problem(text: object) -> str | None:
    """What is wrong with a limit on its own."""
    if not isinstance(text, str):
        return f"is {text!r}; it must be a text"
    try:
        one = limit(text)
        in_unit(one.value, unit_of(in_order(one.number)))
    except ValueError as error:
        return f"{text!r}: {error}"
    return None
