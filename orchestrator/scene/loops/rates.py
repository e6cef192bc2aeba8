"""How bodies move where a scene starts: as laws, given rates and hinge lines say, by the least change that joints need.

Rates of a body are the velocity of its origin and its angular velocity (6,), world axes, m/s and rad/s.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from components.contract.frames import Vector3, rotate, rotation_matrix, skew
from components.flexible.modal import ModalData

from ..bodies import StartPose
from ..body_tables import FreeBase, Motion
from ..hinge_line_tables import HingeLine
from ..schema import SceneTables
from .constraints import Constraint, Matrix, Vector
from .coupled_lines import CoupledLines
from .initial_assembly import Weight, jacobian, least, units

_MISSED = 1e-6
"""Of the largest rate; joints of loops stand to 1e-12 m, and in a singular position to the root of that."""
_RATIO = 0.01
"""Of a rate, by which lines that a cable loop or a gear couples may differ from their ratio: radii are rounded."""


class Standing(NamedTuple):
    """A scene where it starts: poses, points and rigid models of bodies, laws that these follow, joints, cable loops.

    displaceable: placed bodies that follow no law.
    """

    tables: SceneTables
    poses: Mapping[str, StartPose]
    points: Mapping[str, Mapping[str, Vector3]]
    models: Mapping[str, ModalData]
    motions: Mapping[str, Motion]
    displaceable: Mapping[str, Weight]
    constraints: Sequence[Constraint]
    coupled_lines: Sequence[CoupledLines]


class StartRates(NamedTuple):
    """Rates (6,) of every body that moves at the start, and what given rates contradict, as sentences with keys."""

    rates: Mapping[str, Vector]
    problems: tuple[str, ...]


class _Row(NamedTuple):
    """A given rate of a body: its key, the body, the value (3,) and its derivatives (3, 6) by the body's rates."""

    key: str
    body: str
    value: Vector
    slopes: Matrix


def start_rates(scene: Standing) -> StartRates:
    """Rates that joints between bodies allow, nearest to those without these joints.

    Base, bodies that follow laws, and lines with a start rate move as these say. All else moves with what carries it.
    Joints that close loops and given rates of placed bodies then change placed bodies and lines without a start rate
    as little as possible, weighed by mass and inertia.
    """
    lines, problems = _line_rates(scene)
    rates = _carried_rates(scene, lines)
    given, held = list(_given(scene)), scene.constraints
    if (given or held) and (
        any(c.rate for c in held)
        or any(row.value.any() for row in given)
        or any(rate.any() for rate in rates.values())
    ):
        names = list(rates)
        slopes, wanted = _rows(scene, given, names)
        missed = wanted - slopes @ np.concatenate(list(rates.values()))
        ways, unit = _freedoms(
            scene, [x for x in scene.tables.hinge_lines if not x.held and x.name not in lines], names
        )
        change = ways @ least(slopes @ ways, missed, unit)
        rates = {n: rates[n] + part for n, part in zip(names, change.reshape(-1, 6), strict=True)}
        problems += _contradicted(scene, given, missed - slopes @ change, rates, bool(lines))
    return StartRates({name: rate for name, rate in rates.items() if rate.any()}, tuple(problems))


def _line_rates(scene: Standing) -> tuple[dict[str, float], list[str]]:
    """Given rates (rad/s) by line, those of cable loops among them, and sentences where these contradict each other."""
    given = {line.name: line.start_rate for line in scene.tables.hinge_lines if line.start_rate is not None}
    found, problems = dict(given), []
    for group in scene.coupled_lines:
        first = next((name for name in group.rates if given.get(name)), "")
        for name, ratio in group.rates.items() if first else ():
            rate = given[first] * ratio / group.rates[first]
            if abs(found.setdefault(name, rate) - rate) > _RATIO * abs(rate):
                problems.append(
                    f"hinge_line.{name}.start_rate: is {found[name]:.4g} rad/s, but {', '.join(group.loops)} couples "
                    f"it with {first}, which turns it at {rate:.4g} rad/s; leave one of both out"
                )
    return found, problems


def _carried_rates(scene: Standing, lines: Mapping[str, float]) -> dict[str, Vector]:
    """Rates of all bodies as if no joint closed a loop; placed ones move with the base, or as laws lead them."""
    base, poses = scene.tables.base, scene.poses
    whole = np.zeros(6)
    if base.name in scene.motions:
        whole = _led(scene.motions[base.name], poses[base.name])
    elif base.free is not None:
        whole = _free(base.free, poses[base.name])
    rates = {name: _carried(whole, poses[base.name], pose) for name, pose in poses.items()}
    waiting = list(scene.tables.hinge_lines)
    while waiting:  # from the base outward
        outer = {line.outboard for line in waiting}
        for line in [line for line in waiting if line.inboard not in outer]:
            inner = _carried(rates[line.inboard], poses[line.inboard], poses[line.outboard])
            turn = lines.get(line.name, 0.0) * _turning(scene, line, line.outboard)
            rates[line.outboard] = inner + turn
            waiting.remove(line)
    return rates | {name: _led(motion, poses[name]) for name, motion in scene.motions.items()}


def _given(scene: Standing) -> Iterator[_Row]:
    """Given rates of placed bodies: of their centre of mass, and angular velocities."""
    for body in scene.tables.bodies:
        if body.angular_velocity is not None:
            key = f"body.{body.name}.angular_velocity"
            yield _Row(key, body.name, np.array(body.angular_velocity), np.eye(3, 6, 3))
        if body.velocity is not None:
            arm = rotate(scene.poses[body.name].orientation, _center(scene.models[body.name]))
            slopes = np.hstack((np.eye(3), -skew(np.array(arm))))
            yield _Row(f"body.{body.name}.velocity", body.name, np.array(body.velocity), slopes)


def _rows(scene: Standing, given: list[_Row], names: list[str]) -> tuple[Matrix, Vector]:
    """Derivatives (rows, 6 a body) of all that joints and given rates require by rates of bodies, and the values."""
    blocks, values = [], []
    if scene.constraints:
        blocks.append(jacobian(scene.constraints, scene.poses, names)[1])
        values += [np.full(len(c.names()), c.rate) for c in scene.constraints]
    for row in given:
        block = np.zeros((3, 6 * len(names)))
        at = 6 * names.index(row.body)
        block[:, at : at + 6] = row.slopes
        blocks.append(block)
        values.append(row.value)
    return np.vstack(blocks), np.concatenate(values)


def _freedoms(scene: Standing, lines: list[HingeLine], names: list[str]) -> tuple[Matrix, Matrix]:
    """Rates of bodies (6 a body, n) by those of placed bodies and of lines, and what weighs these (n, n)."""
    placed = list(scene.displaceable)
    count = 6 * len(placed)
    ways = np.zeros((6 * len(names), count + len(lines)))
    unit = np.zeros((count + len(lines),) * 2)
    for i, name in enumerate(placed):
        at = 6 * names.index(name)
        ways[at : at + 6, 6 * i : 6 * i + 6] = np.eye(6)
    unit[:count, :count] = units([scene.poses[name] for name in placed], list(scene.displaceable.values()))
    for column, line in enumerate(lines, count):
        inertia = 0.0
        for name in names:
            if line in scene.tables.lines_inward(name):
                motion = _turning(scene, line, name)
                ways[6 * names.index(name) :, column][:6] = motion
                inertia += _double_energy(scene.models[name], scene.poses[name], motion)
        unit[column, column] = inertia**-0.5
    return ways, unit


def _contradicted(
    scene: Standing, given: list[_Row], missed: Vector, rates: Mapping[str, Vector], has_lines: bool
) -> Iterator[str]:
    """A sentence on the joint or given rate that the others contradict most; none where nobody has given a rate."""
    is_given = given or has_lines or (scene.tables.base.free is not None and scene.tables.base.free.is_moving)
    largest = max(float(np.abs(rate).max()) for rate in rates.values())
    if not is_given or not (worst := float(np.abs(missed).max())) > _MISSED * largest:
        return
    keys = [f"connection.{c.connection}" for c in scene.constraints for _ in c.names()]
    keys += [row.key for row in given for _ in range(3)]
    yield (
        f"{keys[int(np.abs(missed).argmax())]}: rates at the start contradict each other by {worst:.4g} m/s (or "
        "rad/s) here, as joints do not allow them all; check velocity, angular_velocity and start_rate, or leave "
        "out those that follow from others"
    )


def _turning(scene: Standing, line: HingeLine, body: str) -> Vector:
    """Rates of a body that a line carries while the line opens by 1 rad/s."""
    inner = scene.poses[line.inboard]
    axis = np.array(rotate(inner.orientation, line.axis))
    hinge = inner.place(scene.points[line.inboard][line.hinges[0].inboard])
    return np.concatenate((np.cross(axis, np.subtract(scene.poses[body].position, hinge)), axis))


def _double_energy(model: ModalData, pose: StartPose, rates: Vector) -> float:
    """Twice the kinetic energy (J) of a rigid body."""
    momentum, spin = momenta(model, pose, rates)
    return float(momentum @ momentum / model.mass + spin @ rates[3:])


def momenta(model: ModalData, pose: StartPose, rates: Vector) -> tuple[Vector, Vector]:
    """Linear momentum (N.s) of a rigid body, and its angular momentum (N.m.s) about its centre of mass."""
    axes = rotation_matrix(pose.orientation)
    velocity = rates[:3] + np.cross(rates[3:], axes @ model.center_of_mass)
    return model.mass * velocity, axes @ model.inertia @ axes.T @ rates[3:]


def _center(model: ModalData) -> tuple[float, float, float]:
    x, y, z = model.center_of_mass.tolist()
    return x, y, z


def _led(motion: Motion, pose: StartPose) -> Vector:
    """Rates (6,) of what follows a motion."""
    shift, turn = (law.rate(0.0) for law in motion.laws)
    spin = turn * np.array(motion.rotation_axis) / np.linalg.norm(motion.rotation_axis)
    along = shift * np.array(motion.translation_axis) / np.linalg.norm(motion.translation_axis)
    arm = np.subtract(pose.position, pose.place(motion.pivot))
    return np.concatenate((along + np.cross(spin, arm), spin))


def _free(base: FreeBase, pose: StartPose) -> Vector:
    """Rates (6,) of a free base."""
    spin = np.array(base.angular_velocity)
    arm = rotate(pose.orientation, base.center_of_mass)
    return np.concatenate((np.array(base.velocity) - np.cross(spin, arm), spin))


def _carried(whole: Vector, base: StartPose, pose: StartPose) -> Vector:
    """Rates (6,) at a pose of what moves with a body as one."""
    arm = np.subtract(pose.position, base.position)
    return np.concatenate((whole[:3] + np.cross(whole[3:], arm), whole[3:]))
