"""How bodies move where a scene starts: as the laws of motions lead them, by the least rates that joints allow."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from components.contract.frames import Vector3

from ..bodies import StartPose, body_model, motions, written_poses
from ..body_tables import Motion
from ..schema import CheckedScene
from .constraints import Constraint, Vector, constraints
from .initial_assembly import Weight, acts, jacobian, least_displacements


def start_rates(
    scene: CheckedScene, points: Mapping[str, Mapping[str, Vector3]], poses: Mapping[str, StartPose]
) -> dict[str, Vector]:
    """Velocity of the origin and angular velocity (6,) of every body that moves at the start, world axes.

    Hinge lines start at rest, so what they carry moves with the base, and so do placed bodies, but for the least
    change, weighted by mass and inertia, that joints and motions ask for.
    """
    led = motions(scene)
    base = poses[scene.base.name]
    rates = dict.fromkeys(poses, np.zeros(6))
    if scene.base.name in led:
        whole = _led(led[scene.base.name], base)
        rates = {name: _carried(whole, base, pose) for name, pose in poses.items()}
    rates |= {name: _led(motion, poses[name]) for name, motion in led.items()}
    free = [body for body in scene.bodies if body.place is not None and body.name not in led]
    names = [body.name for body in free]
    held = [c for c in constraints(scene, points, written_poses(scene, points)) if acts(c, set(names))]
    if held and (any(c.rate for c in held) or any(rate.any() for rate in rates.values())):
        change = _change(
            held, poses, rates, {body.name: Weight.of(body_model(body, flexible=False)) for body in free}
        )
        rates |= {name: rates[name] + part for name, part in zip(names, change.reshape(-1, 6), strict=True)}
    return {name: rate for name, rate in rates.items() if rate.any()}


def _change(
    held: list[Constraint],
    poses: Mapping[str, StartPose],
    rates: Mapping[str, Vector],
    weights: Mapping[str, Weight],
) -> Vector:
    """Least change of rates (6 a body), those of the weighed bodies, that follows motions and keeps loops closed."""
    wanted = np.concatenate([np.full(len(c.names()), c.rate) for c in held])
    slopes = jacobian(held, poses, list(rates))[1]
    missed = wanted - slopes @ np.concatenate(list(rates.values()))
    own = jacobian(held, poses, list(weights))[1]
    return least_displacements(own, missed, [poses[name] for name in weights], list(weights.values()))


def _led(motion: Motion, pose: StartPose) -> Vector:
    """Rates (6,) of what follows a motion."""
    shift, turn = (law.rate(0.0) for law in motion.laws)
    spin = turn * np.array(motion.rotation_axis) / np.linalg.norm(motion.rotation_axis)
    along = shift * np.array(motion.translation_axis) / np.linalg.norm(motion.translation_axis)
    arm = np.subtract(pose.position, pose.place(motion.pivot))
    return np.concatenate((along + np.cross(spin, arm), spin))


def _carried(whole: Vector, base: StartPose, pose: StartPose) -> Vector:
    """Rates (6,) at a pose of what moves with the base as one."""
    arm = np.subtract(pose.position, base.position)
    return np.concatenate((whole[:3] + np.cross(whole[3:], arm), whole[3:]))
