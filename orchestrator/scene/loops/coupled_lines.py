"""Hinge lines that cable loops and gears couple, so that they turn together, with one degree of freedom.

A loop keeps r1 (w1 - w2) = r2 (w3 - w2) about its axis, to the elongation of its strands: r1, r2 the radii (m) of its
pulleys, w1, w3 the rates of their bodies, w2 that of the body along which the strands run. This is the one with the
guide, or the one between the two lines on which the pulleys sit. A gear keeps w1 - w2 = r (w3 - w4) likewise, to its
elasticity: each about its own axis, r its ratio, w2 and w4 of its carriers, which may be one body.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components import REGISTRY, SUPPLIED_ENERGY, Instance
from components.ccl import CableLoop
from components.contract.frames import Vector3, dot
from components.gear import Gear

from ..component_connections import component_values, instance_of
from ..connection_tables import Ccl, Connection
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
    """Two turns that a cable loop or a gear keeps in step, each of a body against its carrier.

    radii: the inverse ratio of both turns: radii of pulleys (m), or 1 and the ratio of a gear. carriers: the body along
    which the strands of a loop are led, twice, or None where it is not known. preload: of a strand (N).
    """

    key: str
    axes: tuple[Vector3, Vector3]
    bodies: tuple[str, str]
    radii: tuple[float, float]
    carriers: tuple[str, str] | None
    preload: float

    @property
    def name(self) -> str:
        """Name of the component."""
        return self.key.partition(".")[2]

    @property
    def turns(self) -> tuple[tuple[str, str, Vector3], ...]:
        """Body, carrier and axis of both turns; none where carriers are not known."""
        return tuple(zip(self.bodies, self.carriers, self.axes, strict=True)) if self.carriers else ()


class Jam(NamedTuple):
    """Lines that cannot move, and the keys of the cable loops and gears that couple them."""

    lines: tuple[str, ...]
    keys: tuple[str, ...]


class Strands(NamedTuple):
    """Both strands of a cable loop: the body that they run along, the preload of each (N), radii of the pulleys (m)."""

    along: str
    preload: float
    radii: tuple[float, float]


def strands(scene: SceneTables) -> Iterator[Strands]:
    """Strands of all cable loops whose way along a body is known."""
    for loop in loops(scene):
        if loop.carriers is not None:
            yield Strands(loop.carriers[0], loop.preload, loop.radii)


def coupled_lines(scene: SceneTables) -> tuple[CoupledLines, ...]:
    """Groups of two or more lines that move and whose rates are in fixed ratios; held lines do not move."""
    groups, names = [], [line.name for line in scene.hinge_lines]
    for rows, among in _groups(scene):
        rates = _rates(among, rows.values())
        if len(rates) > 1:
            drives = tuple(_drives(scene, rates))
            coupling = tuple(one.name for one, row in rows.items() if row.keys() <= rates.keys())
            groups.append(CoupledLines(rates, coupling, drives))
    return tuple(sorted(groups, key=lambda group: names.index(next(iter(group.rates)))))


def jams(scene: SceneTables) -> Iterator[Jam]:
    """Lines that cable loops and gears of unlike ratios, or with held lines, leave no motion."""
    for rows, among in _groups(scene):
        moving = np.abs(_modes(among, rows.values())).sum(axis=0) > _NOTHING
        stuck = tuple(name for name, moves in zip(among, moving, strict=True) if not moves)
        if stuck:
            yield Jam(stuck, tuple(one.key for one, row in rows.items() if not row.keys().isdisjoint(stuck)))


def _groups(scene: SceneTables) -> Iterator[tuple[dict[Coupling, dict[str, float]], list[str]]]:
    """Couplings that share lines, with their rows, and these lines in the scene's order."""
    rows = {one: row for one in (*loops(scene), *gears(scene)) if (row := _row(scene, one))}
    for group in _connected(rows):
        touched = {name for one in group for name in rows[one]}
        among = [line.name for line in scene.hinge_lines if line.name in touched]
        yield {one: rows[one] for one in group}, among


def rates_with(groups: Iterable[CoupledLines], name: str) -> tuple[tuple[str, float], ...]:
    """Lines that a line turns with, itself included, and their rates over its own; empty where it turns alone."""
    rates = next((group.rates for group in groups if name in group.rates), {})
    return tuple((other, rate / rates[name]) for other, rate in rates.items())


def loops(scene: SceneTables) -> Iterator[Coupling]:
    """Cable loops, among them those that are connections along the axes of their bodies, and are not cut."""
    for loop in scene.loops:
        yield loop_coupling(scene, loop)
    for one, values in _connections(scene, CableLoop.kind):
        if values.parameter("cut") < _CUT:
            bodies = (one.ports["pulley_1"].body, one.ports["pulley_2"].body)
            guide = one.ports["guide"].body if "guide" in one.ports else None
            radii = (values.parameter("radius_1"), values.parameter("radius_2"))
            axes, carriers = (values.component.structure["axis"],) * 2, _along(scene, bodies, guide)
            yield Coupling(_key(one), axes, bodies, radii, carriers, values.parameter("preload"))


def loop_coupling(scene: SceneTables, loop: Ccl) -> Coupling:
    """What a cable loop keeps in step."""
    bodies, radii = zip(*((one.body, one.radius) for one in (loop.pulley_1, loop.pulley_2)), strict=True)
    carriers = _along(scene, bodies, None if loop.guide is None else loop.guide.body)
    return Coupling(f"ccl.{loop.name}", (loop.axis, loop.axis), bodies, radii, carriers, loop.preload)


def _key(connection: Connection) -> str:
    return f"connection.{connection.name}"


def _along(scene: SceneTables, bodies: tuple[str, str], guide: str | None) -> tuple[str, str] | None:
    """The body along which the strands between two bodies run, for each of both; None where it is not known."""
    along = guide or body_between(scene, bodies)
    return None if along is None else (along, along)


def gears(scene: SceneTables) -> Iterator[Coupling]:
    """Gears between rotations, along the axes of their bodies, that are engaged."""
    for one, values in _connections(scene, Gear.kind):
        structure, between = values.component.structure, acting_between(one)
        if structure["second_motion"] == "rotation" and between:
            (first, carrier), (second, other) = between
            axes = (structure["first_axis"], structure["second_axis"])
            radii = (1.0, values.parameter("ratio"))
            yield Coupling(_key(one), axes, (first, second), radii, (carrier, other), 0.0)


def acting_between(connection: Connection) -> tuple[tuple[str, ...], ...]:
    """Groups of bodies between which a connection acts: a gear on each body and its carrier, others on all bodies.

    A gear without stiffness is disengaged and acts on none.
    """
    bodies = {name: seat.body for name, seat in connection.ports.items()}
    if connection.kind != Gear.kind:
        return (tuple(bodies.values()),)
    if instance_of(connection).parameter("stiffness") == 0.0:
        return ()
    carrier = bodies["carrier"]
    return (bodies["first"], carrier), (bodies["second"], bodies.get("second_carrier", carrier))


def _connections(scene: SceneTables, kind: str) -> Iterator[tuple[Connection, Instance]]:
    """Connections of a kind along the axes of their bodies, and their components."""
    for one in scene.connections:
        if one.kind == kind and one.axes is None:
            yield one, instance_of(one)


def _row(scene: SceneTables, coupling: Coupling) -> dict[str, float]:
    """Coefficients (m) by line of the sum of rates that a coupling keeps at zero; empty where it is not known."""
    turns = line_turns(scene, coupling)
    row: dict[str, float] = {}
    for turn, radius in zip(turns, (coupling.radii[0], -coupling.radii[1]), strict=True) if turns else ():
        for name, rate in turn.items():
            row[name] = row.get(name, 0.0) + radius * rate
    moving = {line.name for line in scene.hinge_lines if not line.held}
    row = {name: value for name, value in row.items() if name in moving}
    return _without_nothing(row, max(map(abs, coupling.radii)))


def line_turns(scene: SceneTables, coupling: Coupling) -> tuple[dict[str, float], ...]:
    """How both bodies turn against their carriers, per turn of each line; none where lines alone do not tell."""
    if not coupling.turns or any(
        _root(scene, one) != _root(scene, other) for one, other, _ in coupling.turns
    ):
        return ()
    found = []
    for body, carrier, axis in coupling.turns:
        turn = _turning(scene, body, axis)
        for name, rate in _turning(scene, carrier, axis).items():
            turn[name] = turn.get(name, 0.0) - rate
        found.append(turn)
    return tuple(found)


def body_between(scene: SceneTables, bodies: tuple[str, str]) -> str | None:
    """The body that two lines join to two others; None where there is none."""
    ways = [list(scene.lines_inward(body)) for body in bodies]
    lines = [line for way, other in (ways, ways[::-1]) for line in way if line not in other]
    if len(lines) != 2:
        return None
    shared = {lines[0].inboard, lines[0].outboard} & {lines[1].inboard, lines[1].outboard}
    return next(iter(shared - set(bodies)), None)


def _root(scene: SceneTables, body: str) -> str:
    """The body on which the lines that carry a body stand: the base or a placed one."""
    for line in scene.lines_inward(body):
        body = line.inboard
    return body


def _turning(scene: SceneTables, body: str, axis: Vector3) -> dict[str, float]:
    """Rate of a body about an axis against its root, for a rate of one of each line that carries it."""
    return {line.name: dot(line.axis, axis) for line in scene.lines_inward(body)}


def _without_nothing(values: Mapping[str, float], largest: float) -> dict[str, float]:
    return {name: value for name, value in values.items() if abs(value) > _NOTHING * largest}


def _connected(rows: Mapping[Coupling, Mapping[str, float]]) -> list[list[Coupling]]:
    """Couplings, together where lines lead from one to the other."""
    groups: list[list[Coupling]] = []
    for one, row in rows.items():
        joined = [group for group in groups if any(rows[other].keys() & row.keys() for other in group)]
        groups = [group for group in groups if group not in joined]
        groups.append([*(other for group in joined for other in group), one])
    return groups


def _rates(names: Sequence[str], rows: Iterable[Mapping[str, float]]) -> dict[str, float]:
    """Rates of lines over that of the first that moves; empty unless they have just one degree of freedom."""
    modes = _modes(names, rows)
    if len(modes) != 1:
        return {}
    rates = dict(zip(names, modes[0].tolist(), strict=True))
    moving = _without_nothing(rates, max(map(abs, rates.values())))
    first = next(iter(moving.values()))
    return {name: round(rate / first, 12) for name, rate in moving.items()}


def _modes(names: Sequence[str], rows: Iterable[Mapping[str, float]]) -> NDArray[np.float64]:
    """Rates of lines (freedoms, names) that couplings with these rows allow, orthonormal."""
    matrix = np.array([[row.get(name, 0.0) for name in names] for row in rows])
    _, sizes, modes = np.linalg.svd(matrix / np.linalg.norm(matrix, axis=1, keepdims=True))
    return modes[np.count_nonzero(sizes > _DEPENDENT) :]


def _drives(scene: SceneTables, names: Collection[str]) -> Iterator[str]:
    """Names of connections that supply energy and turn one of these lines."""
    lines = [line for line in scene.hinge_lines if line.name in names]
    for one in scene.connections:
        if supplies_energy(one):
            groups = acting_between(one)
            if any(acts_across(scene, line, groups) for line in lines):
                yield one.name


def observed_names(connection: Connection) -> set[str]:
    """Names of what a connection's component observes."""
    structure, _ = component_values(connection, "mean")
    component = REGISTRY[connection.kind](**structure)
    return {quantity.name for quantity in component.observation_layout.quantities}


def supplies_energy(connection: Connection) -> bool:
    """Whether its component supplies energy, as a drive does."""
    return SUPPLIED_ENERGY.name in observed_names(connection)


def acts_across(scene: SceneTables, line: HingeLine, groups: Iterable[Iterable[str]]) -> bool:
    """Whether the line is on the way from one body to another in one of the groups."""
    carried = [[line in scene.lines_inward(body) for body in bodies] for bodies in groups]
    return any(any(group) and not all(group) for group in carried)
