"""What is marked in space beside bodies: ports, hinge axes, what connects points, and loads at the interface."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from components.contract.component import Vector
from components.contract.frames import add
from components.contract.roles import INTERFACE_LOAD

from ....assembly import Geometry
from ....results.point_loads import port_loads
from ....results.result import Result
from ....scene.placed_scene import PlacedScene
from ...viewers.motion import Rows
from ...viewers.thinning import straight
from .numbers import double, single

_SHARE_OF_PEAK = 5e-3
Place = dict[str, object]
"""body: its name, or none for the world; point: (3,) in its frame at rest, m"""


def marks(
    result: Result,
    scene: PlacedScene | None,
    shown: Mapping[str, Geometry],
    bodies: Collection[str],
    rows: Rows,
) -> dict[str, object]:
    """Ports, hinges, dampers, links, tips and loads for the page; shown: bodies with a surface, bodies: all that move.

    Without a scene there are loads alone.
    """
    places = {} if scene is None else _places(scene, bodies)
    found: dict[str, list[dict[str, object]]] = {
        "ports": [{"name": f"{name}.{port}", **place} for (name, port), place in places.items()],
        "axes": [],
        "dampers": [],
        "links": [],
        "tips": [],
        "frames": [],
    }
    at_base: dict[str, Place] = {}
    if scene is not None:
        found["axes"] = list(_axes(scene, places))
        found["dampers"] = list(_dampers(scene, places))
        found["links"] = list(_links(scene, places))
        found["tips"] = list(_tips(scene, shown))
        found["frames"] = [
            {"body": body.name, "point": [0.0, 0.0, 0.0]} for body in scene.bodies if body.name in bodies
        ]
        at_base = {name: place for (name, _), place in places.items() if place["body"] == scene.base.name}
    found["loads"] = list(_loads(result, at_base, rows))
    ends = (end for link in found["links"] for end in _ends(link))
    for place in (*(one for kind in found if kind != "links" for one in found[kind]), *ends):
        place["body"] = place["body"] if place["body"] in bodies else None
    return {**found}


def _places(scene: PlacedScene, bodies: Collection[str]) -> dict[tuple[str, str], Place]:
    """Places of ports of connections, by connection and port, on bodies whose motion is known."""
    found = dict[tuple[str, str], Place]()
    for one in scene.attachments:
        if one.body in bodies or one.body == scene.base.name:
            point = add(scene.points[one.body][one.point], one.offset)
            found[one.connection, one.port] = {"body": one.body, "point": list(point)}
    return found


def _axes(scene: PlacedScene, places: Mapping[tuple[str, str], Place]) -> Iterator[dict[str, object]]:
    """Axes of hinges at their inboard ports, in the axes of that body, which are those of the line."""
    for line in scene.hinge_lines:
        for hinge in line.hinges:
            if place := places.get((hinge.name, "inboard")):
                yield {"name": line.name, "axis": list(line.axis), **place}


def _dampers(scene: PlacedScene, places: Mapping[tuple[str, str], Place]) -> Iterator[dict[str, object]]:
    """Dampers at the inboard ports of their hinges, with the axis of the line."""
    axes = {hinge.name: line.axis for line in scene.hinge_lines for hinge in line.hinges}
    for damper in scene.dampers:
        if damper.hinge in axes and (place := places.get((damper.hinge, "inboard"))):
            yield {"name": damper.name, "axis": list(axes[damper.hinge]), **place}


def _tips(scene: PlacedScene, shown: Mapping[str, Geometry]) -> Iterator[dict[str, object]]:
    """Of bodies that carry no other, the node farthest from their hinges."""
    inner = {line.inboard for line in scene.hinge_lines}
    for line in scene.hinge_lines:
        if line.outboard in shown and line.outboard not in inner:
            nodes = np.asarray(shown[line.outboard].positions)
            roots = np.array([scene.points[line.outboard][hinge.outboard] for hinge in line.hinges])
            farthest = int(np.argmax(np.linalg.norm(nodes - roots.mean(axis=0), axis=1)))
            yield {"body": line.outboard, "point": nodes[farthest].tolist()}


def _links(scene: PlacedScene, places: Mapping[tuple[str, str], Place]) -> Iterator[dict[str, object]]:
    """Cable loops from pulley to pulley, by way of their guide, and other connections from port to port."""
    for loop in scene.loops:
        ports = ("pulley_1", "guide", "pulley_2")
        ends = [dict(place) for port in ports if (place := places.get((loop.name, port)))]
        if len(ends) > 1:
            radii = [loop.pulley_1.radius, loop.pulley_2.radius]
            yield {"name": loop.name, "ends": ends, "radii": radii, "axis": list(loop.axis)}
    for one in scene.connections:
        ends = [dict(place) for port in one.ports if (place := places.get((one.name, port)))]
        if len(one.ports) == len(ends) == 2:
            yield {"name": one.name, "ends": ends, "radii": [], "axis": []}


def _ends(link: Mapping[str, object]) -> list[Place]:
    ends = link["ends"]
    return ends if isinstance(ends, list) else []


def _loads(result: Result, at_base: Mapping[str, Place], rows: Rows) -> Iterator[dict[str, object]]:
    """Forces (N) and torques (N.m) on the spacecraft in its axes: of every port whose place is known, or the sum."""
    for unit in ("N", "N.m"):
        at_ports = {name: load for name, load in port_loads(result, unit).items() if name in at_base}
        for name, load in at_ports.items():
            yield _load(result.time, rows, name, unit, load) | dict(at_base[name])
        if not at_ports:
            for name, variable in result.in_role(INTERFACE_LOAD):
                if result.unit(name, variable) == unit:
                    load = result.signal(name, variable)
                    yield _load(result.time, rows, name, unit, load) | {
                        "body": name,
                        "point": [0.0, 0.0, 0.0],
                    }


def _load(time: Vector, rows: Rows, name: str, unit: str, load: Vector) -> dict[str, object]:
    """A load (N, 3) at few times, linear in between."""
    values = np.nan_to_num(load[rows].reshape(rows.size, -1))
    peak = float(np.linalg.norm(values, axis=1).max(initial=0.0))
    chosen = straight(time[rows], values, _SHARE_OF_PEAK * peak)
    return {
        "name": name,
        "unit": unit,
        "time": double(time[rows][chosen]),
        "values": single(values[chosen]),
        "peak": peak,
    }
