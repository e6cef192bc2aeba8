"""A checked scene -> an assembly at one fidelity."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from components import ComponentError, Instance
from components.contract.component import Vector
from components.contract.frames import add, rotation_matrix, with_positive_scalar
from components.flexible.modal import ModalData

from ..scene.bodies import body_model, moved
from ..scene.body_tables import Body, Motion
from ..scene.component_connections import WrenchMode, component_values
from ..scene.locked_groups import PortSite, RigidGroup, joined_geometry, joined_model, rigid_groups
from ..scene.placed_scene import PlacedScene
from ..scene.table import SceneError
from . import Assembly, Geometry, HingeLine, Link, Part, SignalFmu
from .beams import beam_part
from .driving import driving
from .end_stops import stop_attachments, stop_parts
from .events import assembly_events
from .fidelities import choose_fidelity
from .hinges import assembly_lines, damper_part, hinge_parts, line_latch, loop_part
from .second_order import with_second_order
from .start_values import with_port_starts


def assemble(
    scene: PlacedScene,
    rigid: Collection[str] = (),
    flexible: Collection[str] = (),
    wrench_mode: WrenchMode = "mean",
    large_deformation: Collection[str] | None = (),
) -> Assembly:
    """Parts, links and hinge lines of a scene at the given fidelity; SceneError for impossible fidelities.

    large_deformation: None for linear analyses, which take beams of large deformation as flexible bodies.
    """
    held = scene.locked_bodies
    chosen = choose_fidelity(scene, rigid, flexible, large_deformation or ())
    is_flexible = {name: chosen[name] != "rigid" and name not in held for name in chosen}
    beams = {
        body.name: body
        for body in scene.bodies
        if chosen[body.name] == "large_deformation"
        and large_deformation is not None
        and body.name not in held
    }
    modal = {name: bends and name not in beams for name, bends in is_flexible.items()}
    models = {
        name: _model(scene, body, modal[name])
        for name, body in with_second_order(scene, modal).items()
        if name not in beams
    }
    parts_of_bodies, links, geometry = _placed_parts(scene, models, beams)
    if not links:
        raise SceneError([f"{scene.file}: no connection acts on what moves; hold fewer hinge lines"])
    linked = {link.connection[0] for link in links}
    connections = connection_parts(scene, is_flexible, wrench_mode)
    # those of [[connection]] are within their ranges, as the scene is sound
    own = {one.name for one in scene.connections}
    _refuse_out_of_range(scene, [part for part in connections if part.name not in own])
    parts = with_port_starts([*parts_of_bodies, *(p for p in connections if p.name in linked)], links)
    header, lines = scene.header, [line for line in scene.hinge_lines if not line.held]
    hinge_lines = assembly_lines(scene, is_flexible, wrench_mode)
    fmus = _signal_fmus(scene, parts, hinge_lines)
    return Assembly(
        name=header.name,
        scene_tree=scene.tree,
        flexible=tuple(name for name, bends in is_flexible.items() if bends and name not in beams),
        large_deformation=tuple(beams),
        parts=parts,
        links=tuple(links),
        hinge_lines=hinge_lines,
        base=scene.base.name,
        until=header.until,
        tolerance=header.tolerance,
        largest_step=header.largest_step,
        preload=header.preload,
        driving=driving(scene, lines),
        geometry=geometry,
        events=assembly_events(scene, parts, hinge_lines, fmus),
        signal_fmus=fmus,
    )


def _signal_fmus(
    scene: PlacedScene, parts: Sequence[Part], lines: Sequence[HingeLine]
) -> tuple[SignalFmu, ...]:
    if not scene.fmus:
        return ()
    from .signal_fmus import signal_fmus  # takes its time, which scenes without FMUs need not

    return signal_fmus(scene, parts, lines)


def groups_with_sites(scene: PlacedScene) -> Mapping[str, RigidGroup]:
    """Rigid groups by their roots, with the sites of all connections that act in a run."""
    found = [*scene.attachments, *(port for line in scene.hinge_lines for port in stop_attachments(line))]
    return rigid_groups(scene, found, scene.poses)


def _placed_parts(
    scene: PlacedScene,
    models: Mapping[str, ModalData],
    beams: Mapping[str, Body],
) -> tuple[list[Part], list[Link], dict[str, Geometry]]:
    """Bodies where they start and with the rates that they start with, their links, and what pictures need."""
    parts: list[Part] = []
    links: list[Link] = []
    geometry: dict[str, Geometry] = {}
    for group in groups_with_sites(scene).values():
        if group.root in beams:
            part, shown = beam_part(scene, beams[group.root], group)
            center = scene.rigid_models[group.root].center_of_mass
        else:
            part, shown = _group_part(scene, group, models)
            center = part.structure.get("modal", {}).get("center_of_mass")
        parts.append(_moving_at_start(part, center, scene.rates.get(group.root)))
        links += [Link((group.root, site.name), site.connection) for site in group.sites]
        geometry |= {group.root: shown} if len(shown.positions) else {}
    return parts, links, geometry


def connection_parts(scene: PlacedScene, is_flexible: Mapping[str, bool], mode: WrenchMode) -> list[Part]:
    """Every connection of the scene, those of held lines included; is_flexible: by the name of every body."""
    parts: list[Part] = []
    for line in scene.hinge_lines:
        latch = line_latch(scene, line, is_flexible, mode)
        parts += [*hinge_parts(scene, line, latch, is_flexible, mode), *stop_parts(line, mode)]
    parts += [loop_part(loop, mode) for loop in scene.loops]
    parts += [damper_part(scene, damper, mode) for damper in scene.dampers]
    return parts + [Part(one.name, one.kind, *component_values(one, mode)) for one in scene.connections]


def _refuse_out_of_range(scene: PlacedScene, parts: Sequence[Part]) -> None:
    """SceneError on values of lines and loops, or shares of them, that their components do not take."""
    problems = []
    for part in parts:
        one = Instance(part.component(), part.start)
        try:
            one.component.check_ranges(one.parameters)
        except ComponentError as error:
            problems.append(f"{scene.file}: {part.name}: {error}")
    if problems:
        raise SceneError(problems)


def _model(scene: PlacedScene, body: Body, flexible: bool) -> ModalData:
    try:
        return body_model(body, flexible, scene.structural_damping)
    except ComponentError as error:
        raise SceneError([f"{scene.file}: body.{body.name}: {error}"]) from None


def _group_part(
    scene: PlacedScene, group: RigidGroup, models: Mapping[str, ModalData]
) -> tuple[Part, Geometry]:
    """A body or joined group where it starts, and what a picture of it needs."""
    base = scene.rigid_models.get(scene.base.name)
    own = {name: models[name] for name in group.bodies if name in models}
    if (motion := scene.motions.get(group.root)) is not None:
        return _moving_part(scene, group, motion), _geometry(*joined_geometry(group, own))
    if group.root == scene.base.name:
        carried = _carried(group, own)
        if base is None:
            return _fixed_part(scene, group, carried), _geometry(*joined_geometry(group, own))
        own = {scene.base.name: base, **own}
    model = joined_model(group, own) if group.is_joined else own[group.root]
    ports = [
        {"name": s.name, "point": s.point, "offset": s.offset, "orientation": s.orientation}
        for s in group.sites
    ]
    bodies = {body.name: body for body in scene.bodies}
    structure: dict[str, Any] = {"modal": model.to_arrays(), "ports": ports}
    pose = scene.poses[group.root]
    start: dict[str, Any] = {
        "initial_position": pose.position,
        "initial_orientation": with_positive_scalar(pose.orientation),
        "gravity": scene.header.gravity,
    }
    if group.root in bodies:
        structure["inertia_coupling"] = bodies[group.root].inertia_coupling
        start["damping_scale"] = bodies[group.root].damping_scale
    else:
        marked = [port | _outside(site) for port, site in zip(ports, group.sites, strict=True)]
        structure |= {"is_base": True, "ports": marked, **carried}
    shown = Geometry(model.display_positions, model.display_shapes, model.display_faces)
    return Part(group.root, "body", structure, start), shown


def _moving_at_start(part: Part, center: Vector | None, rates: Vector | None) -> Part:
    """A body with the velocities of its centre of mass that its rates (6,) give it; what follows a law has none."""
    if rates is None or center is None:
        return part
    w, x, y, z = np.ravel(part.start["initial_orientation"]).tolist()
    velocity = rates[:3] + np.cross(rates[3:], rotation_matrix((w, x, y, z)) @ np.ravel(center))
    start = {
        "initial_velocity": tuple(velocity.tolist()),
        "initial_angular_velocity": tuple(rates[3:].tolist()),
    }
    return replace(part, start={**part.start, **start})


def _geometry(positions: Any, faces: Any) -> Geometry:  # noqa: ANN401 - arrays
    return Geometry(positions, np.zeros((len(positions), 3, 0)), faces)


def _carried(group: RigidGroup, models: Mapping[str, ModalData]) -> dict[str, Any]:
    """What held lines join to the base, as its structure has it; empty where nothing is."""
    if not models:
        return {}
    whole = joined_model(group, models)
    center, inertia = tuple(whole.center_of_mass.tolist()), whole.inertia.tolist()
    return {"carried": {"mass": whole.mass, "center_of_mass": center, "inertia": inertia}}


def _fixed_part(scene: PlacedScene, group: RigidGroup, carried: Mapping[str, Any]) -> Part:
    """The spacecraft as ground, with what held lines join to it; loads are about its first point."""
    structure = {"ports": _frame_ports(scene, group), **carried}
    if carried:
        structure["gravity"] = scene.header.gravity
    return Part(group.root, "fixed_base", structure, {})


def _moving_part(scene: PlacedScene, group: RigidGroup, motion: Motion) -> Part:
    """What follows a motion; loads are about its pivot."""
    back = (-law.value(0.0) for law in motion.laws)
    frame = moved(scene.poses[group.root], motion, *back)
    structure = {
        **motion.model_dump(),
        "ports": _frame_ports(scene, group),
        "position": frame.position,
        "orientation": with_positive_scalar(frame.orientation),
        "is_base": group.root == scene.base.name,
    }
    return Part(group.root, "moving_base", structure, {})


def _frame_ports(scene: PlacedScene, group: RigidGroup) -> list[dict[str, Any]]:
    """Ports of a group in the axes of its root."""
    ports = []
    for site in group.sites:
        body, _, point = site.point.partition(".") if group.is_joined else (group.root, "", site.point)
        at = group.poses[body].place(scene.points[body][point])
        port = {"name": site.name, "position": add(at, site.offset), "orientation": site.orientation}
        ports.append(port | _outside(site) if group.root == scene.base.name else port)
    return ports


def _outside(site: PortSite) -> dict[str, bool]:
    """What a port of the base says where something acts there from outside; nothing where something is joined."""
    return {"outside": True} if site.outside else {}
