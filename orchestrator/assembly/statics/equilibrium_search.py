"""Static equilibrium of a mechanism near its pose, by Newton's method on the exact tangent; the base does not move."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy import linalg

from components.contract.component import Vector

from ...scene.table import SceneError
from .linear_model import LinearModel, linearise, normal_modes
from .mechanism import Mechanism

_MOST_ITERATIONS = 40
_LARGEST_TURN = 0.15
"""rad, in one iteration"""
_FARTHEST = 0.6
"""rad, from where the search began; an equilibrium beyond belongs to another configuration"""
_DRIVEN = 1e-9
"""Of the largest force out of balance, that drives no free motion."""
_TOLERANCE = 1e-9
"""m and rad that the last iteration may move a port"""
_ALIKE, _FALLING = 1e-6, 1e-4
"""m and rad of an iteration that leaves the stiffness as it is, if the work fell to so much of the one before"""


def settle(mechanism: Mechanism, advice: str, *, idle: bool = False) -> None:
    """Move to equilibrium; SceneError where there is none near, with the advice of what to do then.

    idle: what moves without force may stay where it is, if nothing drives it.
    """
    start = _with_loaded_joints(mechanism)
    model, moved, free = start.model, start.moved, start.free
    if free.size and not (idle and _is_idle(model, free)):
        count = free.shape[1]
        raise SceneError(
            [
                f"the configuration has {count} motion{'s' * (count > 1)} without stiffness, so its equilibrium is not "
                f"unique; {advice}"
            ]
        )
    kept, before, alike = _without(model, free), np.inf, False
    for iteration in range(_MOST_ITERATIONS):
        if iteration:
            stiffness = model.stiffness if alike else mechanism.stiffness()
            model = replace(model, stiffness=stiffness, residual=mechanism.forces())
        try:
            step = _step(model, kept)
        except np.linalg.LinAlgError:
            break
        work, motion = abs(float(step @ model.residual)), _port_motions(mechanism, step)
        if not np.isfinite(motion).all():
            break
        way = float(np.abs(motion).max(initial=0.0))
        turn = float(np.abs(motion[:, 3:]).max(initial=0.0))
        step *= min(1.0, _LARGEST_TURN / max(turn, 1e-300))
        mechanism.move(step)
        moved += step
        # beside a stiff clamp ports hardly move; what is out of balance falls with the work until it is round-off
        if way < _TOLERANCE and work >= 0.5 * before:
            mechanism.follow()
            return
        alike = way < _ALIKE and work < _FALLING * before < np.inf
        before = work
        if float(np.abs(_port_motions(mechanism, moved)[:, 3:]).max(initial=0.0)) > _FARTHEST:
            break
    raise SceneError([f"there is no static equilibrium near this configuration; {advice}"])


def driven_motion(mechanism: Mechanism) -> Vector | None:
    """What loads drive away (n,) once joints carry what they can: of motions without stiffness; None where none are."""
    start = _with_loaded_joints(mechanism)
    if not start.free.size or _is_idle(start.model, start.free):
        return None
    found: Vector = start.free @ (start.free.T @ start.model.residual)
    return found


class _Start(NamedTuple):
    """A tangent, the motion (n,) up to it, and shapes (n, k) of what moves there without force."""

    model: LinearModel
    moved: Vector
    free: Vector


def _with_loaded_joints(mechanism: Mechanism) -> _Start:
    """Where joints carry what loads ask of them.

    A pendulum in a joint that carries nothing yet has no stiffness, nor has a rope without tension: a step that leaves
    out the free motions loads them.
    """
    model, moved = linearise(mechanism), np.zeros(mechanism.size)
    free = _free_motions(model)
    if not free.size:
        return _Start(model, moved, free)
    moved = _step(model, _without(model, free))
    if float(np.abs(_port_motions(mechanism, moved)[:, 3:]).max(initial=0.0)) > _LARGEST_TURN:
        return _Start(model, np.zeros(mechanism.size), free)
    mechanism.move(moved)
    model = linearise(mechanism)
    return _Start(model, moved, _free_motions(model))


def _without(model: LinearModel, free: Vector) -> Vector | None:
    """Basis (n, m) of the motions that have no part in free ones; None where there are none."""
    if not free.size:
        return None
    rows = model.other_rows
    basis = np.zeros((len(model.mass), len(rows) - free.shape[1]))
    basis[rows] = linalg.null_space((model.mass @ free)[rows].T)
    return basis


def _step(model: LinearModel, kept: Vector | None) -> Vector:
    """Newton's step (n,) to balance, among these motions or all; LinAlgError where none of all does."""
    if kept is not None:
        found: Vector = kept @ np.linalg.lstsq(kept.T @ model.stiffness @ kept, kept.T @ model.residual)[0]
        return found
    rows, step = model.other_rows, np.zeros(len(model.mass))
    step[rows] = np.linalg.solve(model.stiffness[np.ix_(rows, rows)], model.residual[rows])
    return step


def _is_idle(model: LinearModel, free: Vector) -> bool:
    """Whether nothing drives free motions."""
    return float(np.abs(free.T @ model.residual).max()) <= _DRIVEN * float(
        np.abs(model.residual).max(initial=1.0)
    )


def _free_motions(model: LinearModel) -> Vector:
    """Shapes (n, k) of what moves without force while the base does not."""
    modes = normal_modes(model, model.base_constraints)
    found: Vector = modes.shapes[:, modes.is_free]
    return found


def _port_motions(mechanism: Mechanism, step: Vector) -> Vector:
    """Small motions (ports, 6) of all connections' ports."""
    found = [
        mechanism.jacobian(name, port) @ step
        for name, connection in mechanism.connections.items()
        for port in range(len(connection.ports))
    ]
    return np.array(found).reshape(-1, 6)
