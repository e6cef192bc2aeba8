"""Check of a scene before its run: problems, warnings, bodies, lines, loops, and sketches."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector
from components.contract.frames import Vector3, add, rotate, rotation_matrix
from components.flexible.modal import ModalData

from ..assembly import Assembly
from ..assembly.assemble import assemble
from ..assembly.fidelities import choose_fidelity
from ..assembly.hinges import line_latch
from ..assembly.second_order import second_order_modes
from ..messages import message
from ..records import short_repr
from ..results.result import Result
from ..scene import PlacedScene
from ..scene.bodies import Attachment, StartPose, body_definition, body_model
from ..scene.body_tables import Body, Fidelity
from ..scene.connection_tables import Ccl
from ..scene.hinge_line_tables import HingeLine
from ..scene.loops.coupled_lines import loop_coupling
from ..scene.loops.initial_assembly import Closed
from ..scene.loops.rates import momenta
from ..validity.before_run import warnings_before_run
from ..validity.cable_loops import coupled_travels
from .opening import opening

Places = Mapping[str, StartPose]
Points = Mapping[str, Mapping[str, Vector3]]


@dataclass(frozen=True)
class BodyOverview:
    """A body: its model, mass (kg; None of a fixed base), centre of mass and size (m) along its own axes, points."""

    name: str
    model: str
    mass: float | None
    center_of_mass: Vector3 | None
    size: Vector3
    points: tuple[str, ...]


@dataclass(frozen=True)
class LineOverview:
    """A hinge line: angles (rad), motor torques (N.m) at the stowed and the deployed angle, what ends its travel."""

    name: str
    inboard: str
    outboard: str
    hinges: tuple[str, ...]
    held: bool
    start: float
    deployed: float
    motor: tuple[float, float] | None
    motor_energy: float
    friction_preload: float
    sticks: bool
    latch: str
    effective_inertia: float | None
    end_stop: float | None

    @property
    def travel(self) -> float:
        """Expected turn from the start to the deployed angle, rad."""
        return 0.0 if self.held else self.deployed - self.start


@dataclass(frozen=True)
class LoopOverview:
    """A cable loop: radii (m), travels (rad) against the body between, cable (m) that these do not share."""

    name: str
    bodies: tuple[str, str]
    radii: tuple[float, float]
    travels: tuple[float, float] | None
    mismatch: float
    preload: float


@dataclass(frozen=True)
class StartMotion:
    """All bodies that move freely at the start: kinetic energy (J), momentum (N.s), angular momentum (N.m.s).

    Momenta in world axes; the angular one about the world's origin.
    """

    kinetic_energy: float
    linear_momentum: Vector3
    angular_momentum: Vector3


@dataclass(frozen=True)
class Sketch:
    """What a picture of one configuration shows, in world axes (m), by name.

    faces: (F, 4, 3) of bodies. frames: origin and axes (3,), (3, 3) of bodies. axes: ends (2, 3) of hinge lines. loops:
    courses (2 or 3, 3) of cables. ports: (P, 3).
    """

    faces: Mapping[str, Vector]
    frames: Mapping[str, tuple[Vector, Vector]]
    axes: Mapping[str, Vector]
    loops: Mapping[str, Vector]
    ports: Vector


@short_repr
@dataclass(frozen=True)
class SceneCheck:
    """A scene before its run; where it has problems there is nothing else, as nobody can tell what is meant."""

    scene: str
    problems: tuple[str, ...]
    warnings: tuple[str, ...] = ()
    bodies: tuple[BodyOverview, ...] = ()
    lines: tuple[LineOverview, ...] = ()
    loops: tuple[LoopOverview, ...] = ()
    connections: Mapping[str, str] = field(default_factory=dict)
    """kind of every other connection by name"""
    agreements: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """what the agreement check found of every imported body"""
    start_motion: StartMotion | None = None
    """None where everything starts at rest"""
    stowed: Sketch | None = None
    deployed: Sketch | None = None
    placed: PlacedScene | None = None
    assembly: Assembly | None = None
    models: Mapping[str, ModalData] = field(default_factory=dict)
    """of bodies and of a free base"""

    @cached_property
    def opening(self) -> Result | None:
        """Poses on the way to the deployed configuration, over the share of it in %; None with problems."""
        if self.placed is None or self.assembly is None:
            return None
        return opening(self.placed, self.assembly, self.models)

    def as_dict(self) -> dict[str, Any]:
        """For JSON, without the sketches."""
        return {
            "scene": self.scene,
            "problems": self.problems,
            "warnings": self.warnings,
            "bodies": [asdict(body) for body in self.bodies],
            "lines": [{**asdict(line), "travel": line.travel} for line in self.lines],
            "loops": [asdict(loop) for loop in self.loops],
            "connections": dict(self.connections),
            "agreements": {name: dict(found) for name, found in self.agreements.items()},
            "start_motion": None if self.start_motion is None else asdict(self.start_motion),
        }


def check_scene(
    scene: PlacedScene,
    rigid: Collection[str] = (),
    flexible: Collection[str] = (),
    large_deformation: Collection[str] = (),
) -> SceneCheck:
    """A sound scene looked at, with the bodies as they are to run; SceneError where it cannot be assembled."""
    chosen = choose_fidelity(scene, rigid, flexible, large_deformation)
    bends = {name: fidelity != "rigid" for name, fidelity in chosen.items()}
    # says what only an assembly can tell, such as that a body has not the modes asked for
    assembly = assemble(scene, rigid, flexible, large_deformation=large_deformation)
    held = scene.locked_bodies
    models = {
        body.name: body_model(body, chosen[body.name] == "flexible" and body.name not in held)
        for body in scene.bodies
    }
    second = {
        part.name: second_order_modes(part) for part in assembly.parts if part.name in assembly.flexible
    }
    if scene.base.free is not None:
        models = {scene.base.name: scene.rigid_models[scene.base.name], **models}
    far = scene.deployed.extended
    return SceneCheck(
        scene=scene.header.name,
        problems=(),
        warnings=(
            *warnings_before_run(scene, assembly, [name for name, one in bends.items() if one]),
            *_out_of_reach(scene, far, bends),
        ),
        bodies=tuple(_bodies(scene, models, chosen, held, second)),
        lines=tuple(_line(scene, line, bends) for line in scene.hinge_lines),
        loops=tuple(_loop(scene, loop) for loop in scene.loops),
        connections={
            **{damper.name: "eddy_current_damper" for damper in scene.dampers},
            **{connection.name: connection.kind for connection in scene.connections},
        },
        agreements=_agreements(scene),
        start_motion=_start_motion(scene),
        stowed=_sketch(scene, models, scene.poses),
        deployed=_sketch(scene, models, far.poses),
        placed=scene,
        assembly=assembly,
        models=models,
    )


def _agreements(scene: PlacedScene) -> dict[str, dict[str, str]]:
    """What the agreement check found of every body that is imported, reduced as the scene says."""
    definitions = {body.name: body_definition(body) for body in scene.bodies if body.rigid is None}
    return {
        body.name: {row.name: row.found for row in imported.agreement(body_model(body, flexible=True))}
        for body in scene.bodies
        if body.name in definitions and (imported := definitions[body.name].imported) is not None
    }


def _start_motion(scene: PlacedScene) -> StartMotion | None:
    """Energy and momenta of what moves at the start and follows no law."""
    moving = [name for name in scene.rigid_models if name in scene.rates and name not in scene.motions]
    energy, linear, angular = 0.0, np.zeros(3), np.zeros(3)
    for name in moving:
        model, pose, rates = scene.rigid_models[name], scene.poses[name], scene.rates[name]
        momentum, spin = momenta(model, pose, rates)
        energy += 0.5 * float(momentum @ momentum / model.mass + spin @ rates[3:])
        linear = linear + momentum
        angular = angular + spin + np.cross(pose.place(_triple(model.center_of_mass)), momentum)
    return StartMotion(energy, _triple(linear), _triple(angular)) if moving else None


def _out_of_reach(scene: PlacedScene, far: Closed, bends: Mapping[str, bool]) -> Iterator[str]:
    """A message about the joint that stays open farthest where motions lead, if its bodies are rigid.

    None where lines follow from others by loops, as where these lead them is not known.
    """
    if any(line.is_pivot and not line.held for line in scene.hinge_lines):
        return
    ports = {one.name: [seat.body for seat in one.ports.values()] for one in scene.connections}
    rigid = [name for name in far.open_by if not any(bends.get(body, False) for body in ports[name])]
    if name := max(rigid, key=lambda name: far.open_by[name], default=""):
        yield message(
            "W-motion-reach",
            f"connection.{name}: where all lines are deployed and motions are farthest from their start it stays open "
            f"by {1e3 * far.open_by[name]:.4g} mm (or mrad). Check how far the laws of motions lead, and the lengths "
            "between points.",
        )


def _bodies(
    scene: PlacedScene,
    models: Mapping[str, ModalData],
    chosen: Mapping[str, Fidelity],
    held: Collection[str],
    second_order: Mapping[str, int],
) -> list[BodyOverview]:
    bodies = {body.name: body for body in scene.bodies}
    rows = []
    for name, points in scene.points.items():
        data = models.get(name)
        model = (
            ("moved" if scene.base.motion is not None else "fixed")
            if data is None
            else _model_words(
                bodies[name],
                chosen[name],
                data.frequency.size,
                second_order.get(name, 0),
                is_held=name in held,
            )
            if name in bodies
            else "rigid"
        )
        nodes = list(points.values()) if data is None else [*points.values(), *data.display_positions]
        size = np.ptp(np.array(nodes, dtype=float).reshape(-1, 3), axis=0) if len(nodes) else np.zeros(3)
        center = None if data is None else _triple(data.center_of_mass)
        rows.append(
            BodyOverview(
                name, model, None if data is None else data.mass, center, _triple(size), tuple(points)
            )
        )
    return rows


def _model_words(body: Body, fidelity: Fidelity, modes: int, second_order: int, *, is_held: bool) -> str:
    """What a body is modelled by; modes: those that it has, with constraint modes and without rigid ones.

    second_order: how many of these are.
    """
    if is_held:
        return "rigid, as one piece with others by held lines"
    if fidelity == "flexible":
        second = f", {second_order} of second order" if second_order else ""
        panel = body_definition(body).panel
        stretching = ", stretched by bending" if panel and panel.plate.geometry == "von_karman" else ""
        kept = modes + 6 - 6 * len(body_definition(body).attachment_points)
        return f"flexible, {kept} fixed-interface modes{second}{stretching}"
    beam = body_definition(body).beam if fidelity == "large_deformation" else None
    return "rigid" if beam is None else f"large deformation, {beam.elements} elements"


def _triple(v: NDArray[np.float64]) -> Vector3:
    return (float(v[0]), float(v[1]), float(v[2]))


def _line(scene: PlacedScene, line: HingeLine, flexible: Mapping[str, bool]) -> LineOverview:
    setting = line_latch(scene, line, flexible, "mean")
    inertia = None if line.latch is None else line.latch.effective_inertia or scene.effective_inertia(line)
    is_spring = setting.kind == "spring" or setting.straight
    stiff = f", {setting.stiffness:.5g} N.m/rad" if is_spring else ""
    kind = "spring with play" if setting.straight else setting.kind
    return LineOverview(
        line.name, line.inboard, line.outboard, tuple(hinge.name for hinge in line.hinges), line.held,
        line.initial_angle, line.deployed_angle,
        _motor_torques(line),
        line.motor_energy, line.friction_preload, line.presliding is not None, f"{kind}{stiff}", inertia,
        line.stop_angle,
    )  # fmt: skip


def _motor_torques(line: HingeLine) -> tuple[float, float] | None:
    """Of its motor, opening, at the stowed and the deployed angle."""
    if line.motor is None:
        return None
    return line.motor_law.value(line.stowed_angle), line.motor_law.value(line.deployed_angle)


def _loop(scene: PlacedScene, loop: Ccl) -> LoopOverview:
    travels = coupled_travels(scene, loop_coupling(scene, loop))
    ends = loop.pulley_1, loop.pulley_2
    return LoopOverview(
        loop.name, (ends[0].body, ends[1].body), (ends[0].radius, ends[1].radius),
        None if travels is None else (travels.first, travels.second),
        0.0 if travels is None else travels.mismatch, loop.preload,
    )  # fmt: skip


def _sketch(scene: PlacedScene, models: Mapping[str, ModalData], poses: Places) -> Sketch:
    """What stands where in these poses."""
    points, ports = scene.points, scene.attachments
    sizes = [
        float(np.linalg.norm(np.ptp(data.display_positions, axis=0)))
        for data in models.values()
        if len(data.display_positions)
    ]
    return Sketch(
        faces={
            name: _placed(poses[name], data.display_positions)[data.display_faces]
            for name, data in models.items()
            if len(data.display_faces)
        },
        frames={
            name: (np.array(pose.position), rotation_matrix(pose.orientation)) for name, pose in poses.items()
        },
        axes={
            line.name: _axis(line, poses, points, 0.1 * max(sizes, default=1.0)) for line in scene.hinge_lines
        },
        loops={loop.name: _course(loop, ports, poses, points) for loop in scene.loops},
        ports=np.array([_at(port, poses, points) for port in ports]).reshape(-1, 3),
    )


def _placed(pose: StartPose, nodes: Vector) -> Vector:
    result: Vector = np.array(pose.position) + nodes @ rotation_matrix(pose.orientation).T
    return result


def _at(port: Attachment, poses: Places, points: Points) -> Vector3:
    return poses[port.body].place(add(points[port.body][port.point], port.offset))


def _axis(line: HingeLine, poses: Places, points: Points, reach: float) -> Vector:
    """Ends of a hinge line, somewhat beyond its outermost hinges."""
    inner = poses[line.inboard]
    along = np.array(rotate(inner.orientation, line.axis))
    places = np.array([inner.place(points[line.inboard][hinge.inboard]) for hinge in line.hinges])
    shares = (places - places[0]) @ along
    ends = np.array([shares.min() - reach, shares.max() + reach])
    result: Vector = places[0] + ends[:, None] * along
    return result


def _course(loop: Ccl, ports: Collection[Attachment], poses: Places, points: Points) -> Vector:
    """From pulley to pulley, by way of the guide where there is one."""
    own = {port.port: _at(port, poses, points) for port in ports if port.connection == loop.name}
    return np.array([own[name] for name in ("pulley_1", "guide", "pulley_2") if name in own])
