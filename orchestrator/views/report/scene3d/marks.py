"""What is marked in space beside bodies: ports, hinge axes, what connects points, and loads at the interface."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from components import FanfoldError
from components.contract.component import Vector
from components.contract.frames import add
from components.contract.roles import INTERFACE_LOAD

from ....analysis.stress.model import scene_of
from ....results.point_loads import port_loads
from ....results.result import Result
from ....scene.placed_scene import PlacedScene
from ...viewers.motion import Rows
from ...viewers.thinning import straight
from .numbers import double, single

_SHARE_OF_PEAK = 5e-3
Place = dict[str, object]
"""body: its name, or none for the world; point: (3,) in its frame at rest, m"""


def marks(result: Result, bodies: Collection[str], rows: Rows, remarks: list[str]) -> dict[str, object]:
    """Ports, axes, links and loads for the page; remarks: gets a sentence where the result does not hold its scene."""
    ports, axes, links = list[dict[str, object]](), list[dict[str, object]](), list[dict[str, object]]()
    at_base: dict[str, Place] = {}
    try:
        scene = scene_of(result)
        places = _places(scene, bodies)
    except FanfoldError as error:
        why = str(error).removeprefix(f"{result.name}: ")
        remarks.append(f"Ports and hinge axes are not shown: {why}")
    else:
        ports = [{"name": f"{name}.{port}", **place} for (name, port), place in places.items()]
        axes, links = list(_axes(scene, places)), list(_links(scene, places))
        at_base = {name: place for (name, _), place in places.items() if place["body"] == scene.base.name}
    loads = list(_loads(result, at_base, rows))
    for place in (*ports, *axes, *loads, *(end for link in links for end in _ends(link))):
        place["body"] = place["body"] if place["body"] in bodies else None
    return {"ports": ports, "axes": axes, "links": links, "loads": loads}


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


def _links(scene: PlacedScene, places: Mapping[tuple[str, str], Place]) -> Iterator[dict[str, object]]:
    """Cable loops from pulley to pulley, and other connections from port to port."""
    pairs = {loop.name: ("pulley_1", "pulley_2") for loop in scene.loops}
    pairs |= {one.name: tuple(one.ports) for one in scene.connections if len(one.ports) == 2}  # type: ignore[misc]
    for name, (first, last) in pairs.items():
        ends = [places.get((name, port)) for port in (first, last)]
        if all(ends):
            yield {"name": name, "ends": [dict(end) for end in ends if end]}


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
