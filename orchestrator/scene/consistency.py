"""What the tables of a scene say about each other: names, points, the tree of hinge lines."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from math import acos, degrees

from components import REGISTRY, ComponentError, Instance
from components.contact import Contact
from components.contract.errors import unknown
from components.contract.frames import Vector3, add, cross, dot, norm, rotate, subtract
from components.numerics.span import SpanConnection

from .bodies import Attachment
from .body_tables import Body
from .component_connections import first_number, seated
from .connection_tables import Damper
from .event_tables import Event
from .hinge_line_tables import HingeLine
from .joint_presets import DISTANCE
from .placed_scene import PlacedScene

_PARALLEL = 0.5
"""Cosine between the axes of two pulleys, below which no cable leads one by the other."""
_ALONG = 1e-6
"""m, across their axis, within which one pulley is right behind another."""
_HINGE_GAP = 1e-3
"""m; how far apart the points of a hinge may be when stowed."""
_DEEPEST = 10.0
"""Penetrations, in reference penetrations, that a contact may start with."""


def repeated_names(named: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Components, as (key, name), that share a name with an earlier one."""
    seen: set[str] = set()
    for key, name in named:
        if name in seen:
            yield f"{key}: two components are named {name!r}"
        seen.add(name)


def unknown_places(
    found: Iterable[Attachment], points: Mapping[str, Mapping[str, Vector3] | None]
) -> Iterator[str]:
    """Ports at bodies or points that do not exist; the points of a body may be unknown (None)."""
    for port in found:
        if port.body not in points:
            yield f"{port.key}: there is no body {port.body!r}; bodies are {', '.join(points)}"
            continue
        known = points[port.body]
        if known is not None and port.point not in known:
            yield f"{port.key}: {port.body} has no point {port.point!r}; its points are {', '.join(known)}"


def unknown_bodies(lines: Iterable[HingeLine], bodies: Collection[str]) -> Iterator[str]:
    """Ends of lines at bodies that do not exist."""
    for line in lines:
        for side, body in (("inboard", line.inboard), ("outboard", line.outboard)):
            if body not in bodies:
                known = ", ".join(bodies)
                yield f"hinge_line.{line.name}.{side}: there is no body {body!r}; bodies are {known}"


def repeated_ports(found: Iterable[Attachment]) -> Iterator[str]:
    """Connections that take a body twice, and points of a body that carry two hinges."""
    bodies: set[tuple[str, str]] = set()
    places: dict[tuple[str, str], str] = {}
    for port in found:
        owner = port.key.rpartition(".")[0]  # names may be shared by mistake
        if (owner, port.body) in bodies:
            yield f"{port.key}: {port.connection} is connected to {port.body} twice"
        bodies.add((owner, port.body))
        if port.key.startswith("hinge_line."):
            other = places.setdefault((port.body, port.point), port.connection)
            if other != port.connection:
                yield f"{port.key}: point {port.point} of {port.body} already carries hinge {other}"


def unknown_hinges(dampers: Iterable[Damper], hinges: Collection[str]) -> Iterator[str]:
    """Dampers at hinges that do not exist."""
    for damper in dampers:
        if damper.hinge not in hinges:
            known = ", ".join(hinges)
            yield f"damper.{damper.name}.hinge: there is no hinge {damper.hinge!r}; hinges are {known}"


def unknown_components(
    events: Iterable[Event], components: Sequence[str], fmus: Sequence[str]
) -> Iterator[str]:
    """Events about components, or conditions on components and FMUs, that do not exist."""
    for event in events:
        found = [(f"event.{event.name}.{key}", name, components) for name, key in event.targets.items()]
        if event.when is not None:
            key = f"event.{event.name}.when.component"
            found.append((key, event.when.component, [*components, *fmus]))
        for key, name, known in found:
            if name not in known:
                yield f"{key}: {name!r} {unknown(name, list(known), 'component')}"


def misplaced(bodies: Iterable[Body], points: Mapping[str, Mapping[str, Vector3] | None]) -> Iterator[str]:
    """Placed bodies whose place is not a known point of the base or of a body that hinge lines carry."""
    listed = list(bodies)
    placed = {body.name for body in listed if body.place is not None}
    for body in listed:
        if body.place is None:
            continue
        key, at = f"body.{body.name}.place", body.place
        known = points.get(at.body)
        if at.body not in points or at.body in placed:
            carried = ", ".join(name for name in points if name not in placed)
            yield f"{key}.body: {at.body!r} is no body that hinge lines carry; those are {carried}"
        elif known is not None and at.point not in known:
            yield f"{key}.point: {at.body} has no point {at.point!r}; its points are {', '.join(known)}"


def misdirected(base: str, lines: Iterable[HingeLine], placed: Collection[str]) -> Iterator[str]:
    """Lines that carry the base or a body that another carries; placed bodies that lines carry."""
    carried: dict[str, str] = {}
    for line in lines:
        if line.outboard == base:
            yield f"hinge_line.{line.name}.outboard: {base} is the base; name it as the inboard body"
        elif line.outboard in carried:
            yield (
                f"hinge_line.{line.name}.outboard: {line.outboard} is that of {carried[line.outboard]} already, "
                "whose angle says where it stands; what closes a loop is a [[connection]] of preset revolute"
            )
        carried.setdefault(line.outboard, line.name)
    for body in placed:
        if body in carried:
            yield f"body.{body}.place: hinge lines carry this body, so its place follows from them; leave it out"


def carried_along(scene: PlacedScene) -> Iterator[str]:
    """Held lines that make a body part of what moves by a law, whose loads would lack the body's inertia."""
    for line in scene.hinge_lines:
        if line.held and (root := scene.group_roots[line.outboard]) in scene.motions:
            yield (
                f"hinge_line.{line.name}.held: {root} follows a motion, and loads on it would lack the inertia of "
                f"{line.outboard}; hold the line by a hinge of the preset fixed, a [[connection]], instead"
            )


def disconnected(base: str, bodies: Iterable[str], lines: Iterable[HingeLine]) -> Iterator[str]:
    """Bodies that are not the outboard end of a chain of hinge lines from the base."""
    inboard_of = {line.outboard: line.inboard for line in lines}
    for body in bodies:
        path = [body]
        while (inner := inboard_of.get(path[-1])) is not None and inner not in path:
            path.append(inner)
        if path[-1] != base:
            yield (
                f"body.{body}: nothing says where it starts, as no chain of hinge lines leads to it from {base}; give "
                "it a place = { body, point } if connections hold it (a free spacecraft is the [base], with free = "
                "{ mass, center_of_mass, inertia })"
            )


def impossible_loops(scene: PlacedScene) -> Iterator[str]:
    """Cable loops around pulleys that, when stowed, face away or of which one lies within the other."""
    points, poses = scene.points, scene.poses
    for loop in scene.loops:
        pulleys = loop.pulley_1, loop.pulley_2
        axis, other = (rotate(poses[pulley.body].orientation, loop.axis) for pulley in pulleys)
        if dot(axis, other) < _PARALLEL:
            apart = degrees(acos(max(-1.0, dot(axis, other))))
            yield (
                f"ccl.{loop.name}.axis: when stowed, the axes of its pulleys on {loop.pulley_1.body} and "
                f"{loop.pulley_2.body} are {apart:.3g} deg apart; set the axis of the lines between them, in the axes "
                "of both bodies"
            )
            continue
        first, second = (
            poses[pulley.body].place(add(points[pulley.body][pulley.point], pulley.offset))
            for pulley in pulleys
        )
        apart = norm(cross(subtract(second, first), axis))
        difference = abs(loop.pulley_1.radius - loop.pulley_2.radius)
        if apart <= difference + _ALONG:
            yield (
                f"ccl.{loop.name}: when stowed, its pulleys are {apart:.4g} m apart across their axis, and their radii "
                f"differ by {difference:.4g} m, so no cable runs around both; check axis and the points of the pulleys"
            )


def open_hinges(scene: PlacedScene) -> Iterator[str]:
    """Hinges whose two points do not meet when stowed, because they are not on one line along the axis."""
    points, poses = scene.points, scene.poses
    for line in scene.hinge_lines:
        for hinge in line.hinges:
            a = poses[line.inboard].place(points[line.inboard][hinge.inboard])
            b = poses[line.outboard].place(points[line.outboard][hinge.outboard])
            gap = norm(subtract(b, a))
            if gap > _HINGE_GAP:
                seats = " and ".join(
                    f"{point!r} of {body} at ({', '.join(f'{x:.4g}' for x in points[body][point])}) m"
                    for body, point in ((line.inboard, hinge.inboard), (line.outboard, hinge.outboard))
                )
                yield (
                    f"hinge_line.{line.name}.hinges.{hinge.name}: its points are {gap:.4g} m apart when stowed, "
                    f"{seats}; the hinges of a line must lie on one line along its axis, so check the points of all"
                )


def buried_contacts(scene: PlacedScene) -> Iterator[str]:
    """Contacts that start deeper than a force could have pressed them."""
    roots = scene.group_roots
    for connection in scene.connections:
        if connection.kind != Contact.kind:
            continue
        if len({roots[seat.body] for seat in connection.ports.values()}) == 1:
            continue  # within one piece, where it never acts
        depth, reference = _start_depth(scene.seated(connection))
        if depth > _DEEPEST * reference:
            gap = first_number(connection, "gap")
            touch = round(gap - depth, 9) + 0.0
            yield (
                f"connection.{connection.name}: the contact starts {depth:.4g} m deep, and its reference_penetration "
                f"is {reference:.4g} m; gap is the clearance of the plane along the normal from the inboard port: the "
                f"plane touches the outboard port where gap is {touch:.6g} m, and is clear of it "
                "below that; check the signs of gap and normal"
            )


def without_direction(scene: PlacedScene) -> Iterator[str]:
    """Springs, suspensions and distance joints between coincident points, whose force has no direction.

    A distance joint moves placed bodies along the line of its points, so it has a direction where these are written.
    """
    for connection in scene.connections:
        if not issubclass(REGISTRY[connection.kind], SpanConnection):
            continue
        poses = scene.written_poses if connection.preset == DISTANCE else scene.poses
        try:
            seated(connection, scene.points, poses).initialize()
        except ComponentError as error:
            yield f"connection.{connection.name}: at the start {error}; check the points and offsets of its ports"


def _start_depth(contact: Instance) -> tuple[float, float]:
    """Penetration (m) of a contact at the start, and its reference penetration (m)."""
    contact.initialize()
    return float(contact.observed()["penetration"][0]), contact.parameter("reference_penetration")
