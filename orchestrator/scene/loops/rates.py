"""How bodies move where a scene starts: as the laws of motions lead them, by the least rates that joints allow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..bodies import StartPose
from ..body_tables import Motion
from .constraints import Constraint, Vector
from .initial_assembly import Weight, jacobian, least_displacements


def start_rates(
    base: str,
    poses: Mapping[str, StartPose],
    motions: Mapping[str, Motion],
    held: Sequence[Constraint],
    weights: Mapping[str, Weight],
) -> dict[str, Vector]:
    """Velocity of the origin and angular velocity (6,) of every body that moves at the start, world axes.

    Hinge lines start at rest, so what they carry moves with the base, and so do placed bodies, but for the least
    change of the weighted ones that the constraints on them and motions require.
    """
    rates = dict.fromkeys(poses, np.zeros(6))
    if base in motions:
        whole = _led(motions[base], poses[base])
        rates = {name: _carried(whole, poses[base], pose) for name, pose in poses.items()}
    rates |= {name: _led(motion, poses[name]) for name, motion in motions.items()}
    if held and (any(c.rate for c in held) or any(rate.any() for rate in rates.values())):
        change = _change(held, poses, rates, weights)
        rates |= {name: rates[name] + part for name, part in zip(weights, change.reshape(-1, 6), strict=True)}
    return {name: rate for name, rate in rates.items() if rate.any()}


def _change(
    held: Sequence[Constraint],
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
