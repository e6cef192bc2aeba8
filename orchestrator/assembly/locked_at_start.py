"""Hinge lines that hold-downs or drives keep where a run begins, and hold-downs that lines have left behind."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from components.drive import Drive
from components.hinge import Hinge
from components.hold_down import HoldDown

from ..scene.event_tables import Event
from ..scene.placed_scene import PlacedScene

Edge = tuple[str, str]


def bolted_lines(scene: PlacedScene) -> frozenset[str]:
    """Lines beside an engaged drive, or closing a chain of lines, joints and hold-downs, open without the last."""
    roots = scene.group_roots
    lines, joints, bolts = _lines(scene), _between(scene, Hinge.kind), _between(scene, HoldDown.kind)
    driven = [
        {roots[seat.body] for seat in c.ports.values()}
        for c in scene.connections
        if c.kind == Drive.kind and c.parameters.get("stiffness") != 0.0  # 0: it is disengaged
    ]
    found = set()
    for name, ends in lines.items():
        others = [edge for other, edge in lines.items() if other != name] + list(joints.values())
        if set(ends) in driven or (_leads(ends, [*others, *bolts.values()]) and not _leads(ends, others)):
            found.add(name)
    return frozenset(found)


def bolts_across(scene: PlacedScene, moved: Collection[str]) -> tuple[str, ...]:
    """Names of the hold-downs between bodies that nothing but lines of these names joins."""
    kept = [ends for name, ends in _lines(scene).items() if name not in moved]
    kept += _between(scene, Hinge.kind).values()
    bolts = _between(scene, HoldDown.kind)
    return tuple(name for name, ends in bolts.items() if not _leads(ends, kept))


def without_bolts(scene: PlacedScene, gone: Collection[str]) -> PlacedScene:
    """The scene without hold-downs of these names, nor what events do to them or wait for from them."""
    connections = tuple(one for one in scene.connections if one.name not in gone)
    events: list[Event] = []
    for event in scene.events:
        if event.when is not None and event.when.component in gone:
            continue
        left = {
            "release": tuple(name for name in event.release if name not in gone),
            "set": {name: values for name, values in event.set.items() if name not in gone},
        }
        if any(left.values()):
            events.append(event.model_copy(update=left))
    return replace(scene, connections=connections, events=tuple(events))


def _lines(scene: PlacedScene) -> dict[str, Edge]:
    """Pieces on both sides of every hinge line."""
    roots = scene.group_roots
    return {line.name: (roots[line.inboard], roots[line.outboard]) for line in scene.hinge_lines}


def _between(scene: PlacedScene, kind: str) -> dict[str, Edge]:
    """Pieces on both sides of every connection of a kind that has two."""
    roots = scene.group_roots
    seats = {c.name: [roots[s.body] for s in c.ports.values()] for c in scene.connections if c.kind == kind}
    return {name: (bodies[0], bodies[1]) for name, bodies in seats.items() if len(bodies) == 2}


def _leads(ends: Edge, edges: Collection[Edge]) -> bool:
    """Whether edges lead from one end to the other."""
    reached, size = {ends[0]}, 0
    while len(reached) > size:
        size = len(reached)
        reached |= {body for edge in edges if reached & set(edge) for body in edge}
    return ends[1] in reached
