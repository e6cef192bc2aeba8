"""Modes of second order where a scene states none: those whose stiffness loads along the body, or its spin, change."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from math import sqrt
from typing import NamedTuple

import numpy as np

from components.contract.component import ComponentError, Vector
from components.contract.frames import Vector3
from components.flexible.modal import ModalData, rigid_motion
from components.load import Load

from ..scene.bodies import attachments, body_definition, body_model
from ..scene.body_tables import Body
from ..scene.hinge_line_tables import HingeLine
from ..scene.loops.coupled_lines import strands
from ..scene.placed_scene import PlacedScene
from ..scene.table import SceneError
from . import Part
from .dense import generalized_modes, null_space
from .driving import load_laws

FELT = 0.01
"""Of the stiffness of a mode: half of it is the change of its frequency, so that peaks are off by 0.5 %."""
_LOWEST = 16
"""Modes whose pairs are looked at first: pairs go with the square of modes, and loads change the lowest ones most."""
_SAMPLES = 257


def with_second_order(scene: PlacedScene, bending: Mapping[str, bool]) -> dict[str, Body]:
    """Bodies by name, with a number of modes of second order where the scene states none.

    bending: whether each body has modes in the run; others keep what the scene says.
    """
    bodies = {body.name: body for body in scene.bodies}
    names = [name for name, body in bodies.items() if body.second_order_modes is None and bending[name]]
    spin, loads = fastest_turn(scene), axial_loads(scene) if names else {}
    for name in names:
        if supplies_second_order(body := bodies[name]):
            try:
                count = _chosen(scene, body, spin, loads[name])
            except ComponentError as error:
                raise SceneError([f"{scene.file}: body.{name}: {error}"]) from None
            bodies[name] = body.model_copy(update={"second_order_modes": count})
    return bodies


def supplies_second_order(body: Body) -> bool:
    """Whether a body can have modes of second order, and its geometry does not choose them itself."""
    if not body.can_bend or body.inertia_coupling != "full":
        return False
    definition = body_definition(body)
    stretches = definition.panel is not None and definition.panel.plate.geometry == "von_karman"
    return definition.imported is None and not stretches


def _chosen(scene: PlacedScene, body: Body, spin: float, load: AxialLoad) -> int:
    """Modes from the lowest up to the last one that loads change; all where the body spins (rad/s)."""
    data = _unfiltered(body)
    modes = data.frequency
    joints = joint_places(scene, body)
    if spin and spin**2 > FELT * held_frequency(data, joints) ** 2:
        return int(modes.size)
    if not joints or not any(load):
        return 0
    low, chosen = 0, _LOWEST
    while low < min(2 * chosen, modes.size):
        low = min(max(_LOWEST, 2 * low), int(modes.size))
        ways = ways_through(_unfiltered(body, low), joints)
        shares = np.max(
            [load.over(way.span) * np.abs(np.diag(way.taken)) for way in ways], axis=0, initial=0.0
        )
        chosen = int(np.flatnonzero(shares > FELT).max(initial=-1)) + 1
    return chosen


def low_second_order(body: Body, besides: int) -> ModalData:
    """The body with its lowest modes of second order, some beyond the first ones; imported bodies have none."""
    modes = 0 if body_definition(body).imported is not None else _unfiltered(body).frequency.size
    count = min(modes, max(_LOWEST, 2 * besides))
    return body_model(body.model_copy(update={"second_order_modes": count}), flexible=True)


def _unfiltered(body: Body, second_order: int = 0) -> ModalData:
    """The body before modes are switched off, of which so many are of second order."""
    keys = {"second_order_modes": second_order, "modes_off": (), "frequencies_off": ()}
    return body_model(body.model_copy(update=keys), flexible=True)


class Way(NamedTuple):
    """From one joint of a body to another: the distance (m), and what a newton that presses both takes of modes.

    taken: (S, S), shares of their stiffness; the inverse of its largest eigenvalue is Euler's load (N).
    """

    span: float
    taken: Vector

    def euler(self, kept: int = 0) -> float:
        """The load (N) that makes modes from a number on bend out."""
        most = float(np.linalg.eigvalsh(self.taken[kept:, kept:]).max(initial=0.0))
        return 1.0 / max(most, float(np.finfo(float).tiny))


def ways_through(data: ModalData, joints: Sequence[Sequence[str]]) -> list[Way]:
    """Between every two joints, each by the points of the body that it holds; a single one presses its inertia.

    None of imported bodies, of which strains to second order are not known.
    """
    low = data.second_order_modes
    if not low:
        return []
    stiffness = np.outer(data.frequency[:low], data.frequency[:low])
    places = [[data.point_names.index(point) for point in joint] for joint in joints]
    ends = [(data.point_positions[at].mean(0), data.second_order_points[at, :3].mean(0)) for at in places]
    if len(ends) == 1:
        ends.append((data.center_of_mass, np.zeros((3, low, low))))
    ways = []
    for (here, moved_here), (there, moved_there) in combinations(ends, 2):
        span = float(np.linalg.norm(there - here))
        if span:
            along = (there - here) / span
            ways.append(Way(span, np.tensordot(along, moved_here - moved_there, axes=1) / stiffness))
    return ways


def joint_places(scene: PlacedScene, body: Body) -> list[list[str]]:
    """Points of a body by what holds it or acts on it there: hinge lines with all their hinges, else connections."""
    line_of = {hinge.name: line.name for line in scene.hinge_lines for hinge in line.hinges}
    found: dict[str, list[str]] = {}
    for one in attachments(scene.hinge_lines, (), (), scene.connections):
        if one.body == body.name:
            found.setdefault(line_of.get(one.connection, one.connection), []).append(one.point)
    return list(found.values())


class AxialLoad(NamedTuple):
    """Estimate of what presses a body along it: N, and, over the distance that latch-up acts across, N.m."""

    force: float
    strands: float
    slack_strand: float
    latch_up: float

    def over(self, span: float) -> float:
        """The force (N) between joints so far apart (m); while a line latches strands have their preload."""
        return self.force + max(self.slack_strand, self.strands + self.latch_up / span)


def axial_loads(scene: PlacedScene) -> dict[str, AxialLoad]:
    """By weight, inertia and loads, by cable loops along a body and the motors of its wing, which latches take up."""
    until, every, found = scene.header.until, list(strands(scene)), {}
    acceleration = max(
        (_largest(motion.laws[0].acceleration, until) for motion in scene.motions.values()), default=0.0
    )
    laws = [load_laws(one)[0] for one in scene.connections if one.kind == Load.kind]
    force = sum(_largest(law.value, until) for law in laws)
    carrying = {body: list(scene.lines_inward(body)) for body in scene.points}
    for body, own in carrying.items():
        names = {line.name for line in own}
        wing = [k for k in scene.hinge_lines if not k.held and carrying[k.outboard][-1].name in names]
        loops = [one for one in every if one.along == body]
        torque = sum(abs(line.motor_law.value(line.initial_angle)) for line in wing)
        stiffness = max((line.latch.stiffness for line in wing if line.latch is not None), default=0.0)
        carried = [b.name for b in scene.bodies if not own or any(k is own[0] for k in carrying[b.name])]
        weight = _across(scene.header.gravity, own) + acceleration
        found[body] = AxialLoad(
            weight * sum(scene.rigid_models[name].mass for name in carried) + force,
            sum(2.0 * one.preload for one in loops),
            max((torque / min(one.radii) for one in loops), default=0.0),
            sqrt(2.0 * sum(line.motor_energy for line in wing) * stiffness),
        )
    return found


def _across(gravity: Vector3, own: Sequence[HingeLine]) -> float:
    """Magnitude of gravity (m/s2) across the line of a body; own: the lines that carry it."""
    across = np.array(gravity)
    if own:
        axis = np.array(own[0].axis)
        across = np.cross(across, axis / np.linalg.norm(axis))
    return float(np.linalg.norm(across))


def _largest(law: Callable[[float], float], until: float) -> float:
    """Largest magnitude of a function of time until a time (s)."""
    return max(abs(law(time)) for time in np.linspace(0.0, until, _SAMPLES).tolist())


def held_frequency(data: ModalData, joints: Sequence[Sequence[str]]) -> float:
    """Lowest frequency (rad/s) of a body clamped at the points of one of its joints, infinite without joints or modes.

    A spin is slow or fast relative to it: clamped at an end a beam vibrates six times slower than free.
    """
    found, count = np.inf, data.frequency.size
    mass = np.eye(6 + count)
    mass[:3, :3], mass[3:6, 3:6] = data.mass * np.eye(3), data.inertia
    stiffness = np.diag(np.concatenate((np.zeros(6), data.frequency**2)))
    for joint in joints if count else ():
        places = [data.point_names.index(point) for point in joint]
        rigid = np.vstack([rigid_motion(data.point_positions[at] - data.center_of_mass) for at in places])
        modal = np.vstack([part[at] for at in places for part in (data.translation, data.rotation)])
        free = null_space(np.hstack((rigid, modal)))
        if free.size:
            lowest = generalized_modes(free.T @ stiffness @ free, free.T @ mass @ free)[0][0]
            found = min(found, float(np.sqrt(max(lowest, 0.0))))
    return float(found)


def second_order_modes(part: Part) -> int:
    """How many modes of a modal body are of second order."""
    return int(np.shape(part.structure["modal"]["second_order_points"])[-1])


def fastest_turn(scene: PlacedScene, until: float | None = None) -> float:
    """Largest rate (rad/s) of turns that motions of the scene follow, up to a time (s), by default its end."""
    end = scene.header.until if until is None else until
    return max((_largest(motion.laws[1].rate, end) for motion in scene.motions.values()), default=0.0)
