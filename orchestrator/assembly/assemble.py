"""A checked scene -> an assembly at one fidelity."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from components import ComponentError
from components.contract.frames import add, rotate
from components.flexible.modal import ModalData

from ..scene.bodies import StartPose, attachments, base_model, body_model, scene_points
from ..scene.body_tables import Body
from ..scene.component_connections import WrenchMode, component_values
from ..scene.locked_groups import Piece, held_bodies, joined, joined_geometry, joined_model, pieces
from ..scene.loops.closing import start_poses
from ..scene.schema import CheckedScene
from ..scene.table import SceneError
from . import Assembly, Geometry, Link, Part
from .end_stops import stop_attachments, stop_parts
from .events import assembly_events
from .hinges import assembly_line, damper_part, hinge_parts, line_latch, loop_part
from .start_values import with_port_starts


def choose_fidelity(
    scene: CheckedScene, rigid: Collection[str], flexible: Collection[str]
) -> dict[str, bool]:
    """Whether each body is flexible: its default, unless named (or meant by "all") in one of the two sets."""
    bodies = {body.name: body for body in scene.bodies}
    problems = [
        f"{scene.file}: there is no body {name!r}; bodies are {', '.join(bodies)}"
        for name in sorted({*rigid, *flexible} - {*bodies, "all"})
    ]
    to_rigid = set(bodies) if "all" in rigid else set(rigid)
    entries = {name for name, body in bodies.items() if body.can_bend}
    to_flexible = entries if "all" in flexible else set(flexible)
    for name in bodies:
        if name in to_rigid and name in to_flexible:
            problems.append(f"{scene.file}: body.{name}: it cannot be both rigid and flexible")
        if name in to_flexible - entries:
            problems.append(
                f"{scene.file}: body.{name}: only a body of the catalogue, or with a panel or frame, can be flexible"
            )
    if problems:
        raise SceneError(problems)
    return {
        name: name in to_flexible or (body.flexible and name not in to_rigid) for name, body in bodies.items()
    }


def assemble(
    scene: CheckedScene,
    rigid: Collection[str] = (),
    flexible: Collection[str] = (),
    wrench_mode: WrenchMode = "mean",
) -> Assembly:
    """Parts, links and hinge lines of a scene at the given fidelity; SceneError for impossible fidelities."""
    held = held_bodies(scene)
    chosen = choose_fidelity(scene, rigid, flexible)
    is_flexible = {name: chosen[name] and name not in held for name in chosen}
    models = {body.name: _model(scene, body, is_flexible[body.name]) for body in scene.bodies}
    poses = start_poses(scene, scene_points(scene))
    found = list(attachments(scene.hinge_lines, scene.loops, scene.dampers, scene.connections))
    found += [port for line in scene.hinge_lines for port in stop_attachments(line)]
    parts_of_bodies: list[Part] = []
    links: list[Link] = []
    geometry: dict[str, Geometry] = {}
    for piece in pieces(scene, found, poses).values():
        part, shown = _piece_part(scene, piece, models, poses)
        parts_of_bodies.append(part)
        links += [Link((piece.root, site.name), site.connection) for site in piece.sites]
        geometry |= {piece.root: shown} if len(shown.positions) else {}
    if not links:
        raise SceneError([f"{scene.file}: no connection acts on what moves; hold fewer hinge lines"])
    linked = {link.connection[0] for link in links}
    connections = _connection_parts(scene, is_flexible, wrench_mode)
    parts = with_port_starts([*parts_of_bodies, *(p for p in connections if p.name in linked)], links)
    header, lines = scene.header, [line for line in scene.hinge_lines if not line.held]
    roots = joined(scene)
    hinge_lines = tuple(
        assembly_line(
            line,
            line_latch(scene, line, is_flexible, wrench_mode),
            is_flexible,
            (roots[line.inboard], roots[line.outboard]),
            rotate(poses[line.inboard].orientation, line.axis),
        )
        for line in lines
    )
    return Assembly(
        name=header.name,
        scene_tree=scene.tree,
        flexible=tuple(name for name, modal in is_flexible.items() if modal),
        parts=parts,
        links=tuple(links),
        hinge_lines=hinge_lines,
        base=scene.base.name,
        until=header.until,
        tolerance=header.tolerance,
        largest_step=header.largest_step,
        preload=header.preload,
        driving_energy=sum(line.motor_energy for line in lines),
        geometry=geometry,
        events=assembly_events(scene, parts, hinge_lines),
    )


def _connection_parts(scene: CheckedScene, is_flexible: Mapping[str, bool], mode: WrenchMode) -> list[Part]:
    """Every connection of the scene, those of held lines included."""
    parts: list[Part] = []
    for line in scene.hinge_lines:
        latch = line_latch(scene, line, is_flexible, mode)
        parts += [*hinge_parts(scene, line, latch, is_flexible, mode), *stop_parts(line, mode)]
    parts += [loop_part(loop, mode) for loop in scene.loops]
    parts += [damper_part(scene, damper, mode) for damper in scene.dampers]
    return parts + [Part(one.name, one.kind, *component_values(one, mode)) for one in scene.connections]


def _model(scene: CheckedScene, body: Body, flexible: bool) -> ModalData:
    try:
        return body_model(body, flexible, scene.structural_damping)
    except ComponentError as error:
        raise SceneError([f"{scene.file}: body.{body.name}: {error}"]) from None


def _piece_part(
    scene: CheckedScene, piece: Piece, models: Mapping[str, ModalData], poses: Mapping[str, StartPose]
) -> tuple[Part, Geometry]:
    """A body or joined piece, at rest where it starts, and what a picture of it needs."""
    base = base_model(scene.base)
    own = {name: models[name] for name in piece.bodies if name in models}
    if piece.root == scene.base.name:
        if base is None:
            return _fixed_part(scene, piece, poses), _geometry(*joined_geometry(piece, own))
        own = {scene.base.name: base, **own}
    model = joined_model(piece, own) if piece.is_joined else own[piece.root]
    ports = [
        {"name": s.name, "point": s.point, "offset": s.offset, "orientation": s.orientation}
        for s in piece.sites
    ]
    bodies = {body.name: body for body in scene.bodies}
    structure: dict[str, Any] = {"modal": model.to_arrays(), "ports": ports}
    pose = poses[piece.root]
    start: dict[str, Any] = {
        "initial_position": pose.position,
        "initial_orientation": pose.orientation,
        "gravity": scene.header.gravity,
    }
    if piece.root in bodies:
        structure["inertia_coupling"] = bodies[piece.root].inertia_coupling
        start["damping_scale"] = bodies[piece.root].damping_scale
    else:
        structure["is_base"] = True
    shown = Geometry(model.display_positions, model.display_shapes, model.display_faces)
    return Part(piece.root, "body", structure, start), shown


def _geometry(positions: Any, faces: Any) -> Geometry:  # noqa: ANN401 - arrays
    return Geometry(positions, np.zeros((len(positions), 3, 0)), faces)


def _fixed_part(scene: CheckedScene, piece: Piece, poses: Mapping[str, StartPose]) -> Part:
    """The spacecraft as ground, with what held lines join to it; loads are about its first point."""
    points = scene_points(scene)
    ports = []
    for site in piece.sites:
        body, _, point = site.point.partition(".") if piece.is_joined else (piece.root, "", site.point)
        at = piece.poses[body].place(points[body][point])
        ports.append({"name": site.name, "position": add(at, site.offset), "orientation": site.orientation})
    return Part(piece.root, "fixed_base", {"ports": ports}, {})
