"""Hinge lines that cable loops and gears couple, so that they turn together, with one degree of freedom.

A loop keeps r1 (w1 - w2) = r2 (w3 - w2) about its axis, to the elongation of its strands: r1, r2 the radii (m) of its
pulleys, w1, w3 the rates of their bodies, w2 that of the body along which the strands run. This is the one with the
guide, or the one between the two lines on which the pulleys sit. A gear keeps w1 - w2 = r (w3 - w2) likewise, to its
elasticity: each about its own axis, r its ratio, w2 of its carrier.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from components import REGISTRY, SUPPLIED_ENERGY, Instance
from components.ccl import CableLoop
from components.contract.frames import Vector3, dot
from components.gear import Gear

from ..component_connections import component_values
from ..connection_tables import Connection
from ..hinge_line_tables import HingeLine
from ..schema import SceneTables

_NOTHING = 1e-3
"""Of the largest coefficient or rate: lines that turn about another axis than the loop, or stand still."""
_DEPENDENT = 1e-2
"""Singular values, of loops as rows of unit length, up to which two say the same, as twins with rounded radii."""
_CUT = 0.5


class CoupledLines(NamedTuple):
    """Lines that turn together.

    rates: of every line, over that of the first, negative where it closes as that one opens; in the scene's order.
    loops: names of the cable loops and gears that couple them. drives: names of what supplies energy and turns one.
    """

    rates: Mapping[str, float]
    loops: tuple[str, ...]
    drives: tuple[str, ...]


class Coupling(NamedTuple):
    """A cable loop: its pulleys' axes, bodies, radii (m), body along which its strands are led, if any, preload (N).

    A gear has axes of its own, the radii 1 and its ratio, and its carrier as guide.
    """

    name: str
    axes: tuple[Vector3, Vector3]
    bodies: tuple[str, str]
    radii: tuple[float, float]
    guide: str | None
    preload: float


class Strands(NamedTuple):
    """Both strands of a cable loop: the body that they run along, the preload of each (N), radii of the pulleys (m)."""

    along: str
    preload: float
    radii: tuple[float, float]


def strands(scene: SceneTables) -> Iterator[Strands]:
    """Strands of all cable loops whose way along a body is known."""
    for loop in _loops(scene):
        along = _carrier(scene, loop)
        if along is not None:
            yield Strands(along, loop.preload, loop.radii)


def coupled_lines(scene: SceneTables) -> tuple[CoupledLines, ...]:
    """Groups of two or more lines that move and whose rates are in fixed ratios; held lines do not move."""
    rows = {one.name: row for one in (*_loops(scene), *gears(scene)) if (row := _row(scene, one))}
    names = [line.name for line in scene.hinge_lines]
    groups = []
    for loops in _connected(rows):
        touched = {name for loop in loops for name in rows[loop]}
        among = [name for name in names if name in touched]
        rates = _rates(among, [rows[loop] for loop in loops])
        if len(rates) > 1:
            drives = tuple(_drives(scene, rates))
            groups.append(
                CoupledLines(
                    rates, tuple(loop for loop in loops if rows[loop].keys() <= rates.keys()), drives
                )
            )
    return tuple(sorted(groups, key=lambda group: names.index(next(iter(group.rates)))))


def rates_with(groups: Iterable[CoupledLines], name: str) -> tuple[tuple[str, float], ...]:
    """Lines that a line turns with, itself included, and their rates over its own; empty where it turns alone."""
    rates = next((group.rates for group in groups if name in group.rates), {})
    return tuple((other, rate / rates[name]) for other, rate in rates.items())


def _loops(scene: SceneTables) -> Iterator[Coupling]:
    """Cable loops, among them those that are connections along the axes of their bodies, and are not cut."""
    for loop in scene.loops:
        bodies, radii = zip(*((one.body, one.radius) for one in (loop.pulley_1, loop.pulley_2)), strict=True)
        led = None if loop.guide is None else loop.guide.body
        yield Coupling(loop.name, (loop.axis, loop.axis), bodies, radii, led, loop.preload)
    for one, structure, values in _connections(scene, CableLoop.kind):
        if values.parameter("cut") < _CUT:
            bodies = (one.ports["pulley_1"].body, one.ports["pulley_2"].body)
            guide = one.ports["guide"].body if "guide" in one.ports else None
            radii = (values.parameter("radius_1"), values.parameter("radius_2"))
            axis = structure["axis"]
            yield Coupling(one.name, (axis, axis), bodies, radii, guide, values.parameter("preload"))


def gears(scene: SceneTables) -> Iterator[Coupling]:
    """Gears between rotations, along the axes of their bodies."""
    for one, _, values in _connections(scene, Gear.kind):
        structure = values.component.structure
        if structure["second_motion"] == "rotation":
            bodies = (one.ports["first"].body, one.ports["second"].body)
            axes = (structure["first_axis"], structure["second_axis"])
            radii = (1.0, values.parameter("ratio"))
            yield Coupling(one.name, axes, bodies, radii, one.ports["carrier"].body, 0.0)


def _connections(scene: SceneTables, kind: str) -> Iterator[tuple[Connection, Mapping[str, Any], Instance]]:
    """Connections of a kind along the axes of their bodies, their structures and components."""
    for one in scene.connections:
        if one.kind == kind and one.axes is None:
            structure, start = component_values(one, "mean")
            yield one, structure, Instance(REGISTRY[kind](**structure), start)


def _row(scene: SceneTables, loop: Coupling) -> dict[str, float]:
    """Coefficients (m) by line of the sum of rates that the loop keeps at zero; empty where it is not known."""
    carrier = _carrier(scene, loop)
    if carrier is None or not all(is_carried(scene, body) for body in (*loop.bodies, carrier)):
        return {}
    row: dict[str, float] = {}
    for body, axis, radius in zip(loop.bodies, loop.axes, (loop.radii[0], -loop.radii[1]), strict=True):
        for end, sign in ((body, radius), (carrier, -radius)):
            for name, rate in turning(scene, end, axis).items():
                row[name] = row.get(name, 0.0) + sign * rate
    return _without_nothing(row, max(map(abs, loop.radii)))


def _carrier(scene: SceneTables, loop: Coupling) -> str | None:
    return loop.guide or body_between(scene, loop.bodies)


def body_between(scene: SceneTables, bodies: tuple[str, str]) -> str | None:
    """The body that two lines join to two others; None where there is none."""
    ways = [list(scene.lines_inward(body)) for body in bodies]
    lines = [line for way, other in (ways, ways[::-1]) for line in way if line not in other]
    if len(lines) != 2:
        return None
    shared = {lines[0].inboard, lines[0].outboard} & {lines[1].inboard, lines[1].outboard}
    return next(iter(shared - set(bodies)), None)


def is_carried(scene: SceneTables, body: str) -> bool:
    """Whether hinge lines alone tell how the body turns against the base."""
    lines = list(scene.lines_inward(body))
    return (lines[-1].inboard if lines else body) == scene.base.name


def turning(scene: SceneTables, body: str, axis: Vector3) -> dict[str, float]:
    """Rate of a body about an axis against the base, for a rate of one of each line that carries it and moves."""
    return {line.name: dot(line.axis, axis) for line in scene.lines_inward(body) if not line.held}


def _without_nothing(values: Mapping[str, float], largest: float) -> dict[str, float]:
    return {name: value for name, value in values.items() if abs(value) > _NOTHING * largest}


def _connected(rows: Mapping[str, Mapping[str, float]]) -> list[list[str]]:
    """Names of loops, together where lines lead from one to the other."""
    groups: list[list[str]] = []
    for loop, row in rows.items():
        joined = [group for group in groups if any(rows[other].keys() & row.keys() for other in group)]
        groups = [group for group in groups if group not in joined]
        groups.append([*(other for group in joined for other in group), loop])
    return groups


def _rates(names: Sequence[str], rows: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Rates of lines over that of the first that moves; empty unless they have just one degree of freedom."""
    matrix = np.array([[row.get(name, 0.0) for name in names] for row in rows])
    _, sizes, modes = np.linalg.svd(matrix / np.linalg.norm(matrix, axis=1, keepdims=True))
    if len(names) - np.count_nonzero(sizes > _DEPENDENT) != 1:
        return {}
    rates = dict(zip(names, modes[-1].tolist(), strict=True))
    moving = _without_nothing(rates, max(map(abs, rates.values())))
    first = next(iter(moving.values()))
    return {name: round(rate / first, 12) for name, rate in moving.items()}


def _drives(scene: SceneTables, names: Collection[str]) -> Iterator[str]:
    """Names of connections that supply energy and turn one of these lines."""
    lines = [line for line in scene.hinge_lines if line.name in names]
    for one in scene.connections:
        bodies = [seat.body for seat in one.ports.values()]
        if supplies_energy(one) and any(acts_across(scene, line, bodies) for line in lines):
            yield one.name


def observed_names(connection: Connection) -> set[str]:
    """Names of what a connection's component observes."""
    structure, _ = component_values(connection, "mean")
    component = REGISTRY[connection.kind](**structure)
    return {quantity.name for quantity in component.observation_layout.quantities}


def supplies_energy(connection: Connection) -> bool:
    """Whether its component supplies energy, as a drive does."""
    return SUPPLIED_ENERGY.name in observed_names(connection)


def acts_across(scene: SceneTables, line: HingeLine, bodies: Iterable[str]) -> bool:
    """Whether the line is on the way from one of the bodies to another."""
    carried = [line in scene.lines_inward(body) for body in bodies]
    return any(carried) and not all(carried)
