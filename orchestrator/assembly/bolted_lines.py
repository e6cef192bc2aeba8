"""Hinge lines that hold-downs or drives keep where a run begins, so that nothing else need hold them there."""

from __future__ import annotations

from collections.abc import Collection

from components.drive import Drive
from components.hinge import Hinge
from components.hold_down import HoldDown

from ..scene.locked_groups import joined
from ..scene.schema import CheckedScene

Edge = tuple[str, str]


def bolted_lines(scene: CheckedScene) -> frozenset[str]:
    """Names of lines beside a drive, or that close a chain of lines, joints and hold-downs, open without the last."""
    roots = joined(scene)
    lines = {line.name: (roots[line.inboard], roots[line.outboard]) for line in scene.hinge_lines}
    seats = [(c.kind, tuple(roots[seat.body] for seat in c.ports.values())) for c in scene.connections]
    joints = [(bodies[0], bodies[1]) for kind, bodies in seats if kind == Hinge.kind and len(bodies) == 2]
    bolts = [(bodies[0], bodies[1]) for kind, bodies in seats if kind == HoldDown.kind and len(bodies) == 2]
    driven = [set(bodies) for kind, bodies in seats if kind == Drive.kind]
    found = set()
    for name, ends in lines.items():
        others = [edge for other, edge in lines.items() if other != name] + joints
        if set(ends) in driven or (_leads(ends, [*others, *bolts]) and not _leads(ends, others)):
            found.add(name)
    return frozenset(found)


def _leads(ends: Edge, edges: Collection[Edge]) -> bool:
    """Whether edges lead from one end to the other."""
    reached, size = {ends[0]}, 0
    while len(reached) > size:
        size = len(reached)
        reached |= {body for edge in edges if reached & set(edge) for body in edge}
    return ends[1] in reached
