"""Static equilibrium of a mechanism near its pose, by Newton's method on the exact tangent; the base does not move."""

from __future__ import annotations

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
_TOLERANCE = 1e-9
"""m and rad that the last iteration may move a port"""


def settle(mechanism: Mechanism, advice: str) -> None:
    """Move to equilibrium; SceneError where there is none near, with the advice of what to do then."""
    moved, before = _load_joints(mechanism), np.inf
    for iteration in range(_MOST_ITERATIONS):
        model = linearise(mechanism)
        rows = model.other_rows
        if not iteration:
            _refuse_free_motions(model, advice)
        step = np.zeros(mechanism.size)
        step[rows] = np.linalg.solve(model.stiffness[np.ix_(rows, rows)], model.residual[rows])
        work, motion = abs(float(step @ model.residual)), _port_motions(mechanism, step)
        if not np.isfinite(motion).all():
            break
        turn = float(np.abs(motion[:, 3:]).max(initial=0.0))
        step *= min(1.0, _LARGEST_TURN / max(turn, 1e-300))
        mechanism.move(step)
        moved += step
        # beside a stiff clamp ports hardly move; what is out of balance falls with the work until it is round-off
        if float(np.abs(motion).max(initial=0.0)) < _TOLERANCE and work >= 0.5 * before:
            mechanism.follow()
            return
        before = work
        if float(np.abs(_port_motions(mechanism, moved)[:, 3:]).max(initial=0.0)) > _FARTHEST:
            break
    raise SceneError([f"there is no static equilibrium near this configuration; {advice}"])


def _load_joints(mechanism: Mechanism) -> Vector:
    """Motion (n,) that lets joints carry what loads ask of them; none where nothing moves without force.

    A pendulum in a joint that carries nothing yet has no stiffness, nor has a rope without tension: the first step
    leaves out the free motions, and what it loads may have made them stiff.
    """
    model, moved = linearise(mechanism), np.zeros(mechanism.size)
    free = _free_motions(model)
    if not free.size:
        return moved
    rows = model.other_rows
    kept = linalg.null_space((model.mass @ free)[rows].T)
    stiffness = kept.T @ model.stiffness[np.ix_(rows, rows)] @ kept
    moved[rows] = kept @ np.linalg.lstsq(stiffness, kept.T @ model.residual[rows])[0]
    turn = float(np.abs(_port_motions(mechanism, moved)[:, 3:]).max(initial=0.0))
    if not turn <= _LARGEST_TURN:
        return np.zeros(mechanism.size)
    mechanism.move(moved)
    return moved


def _free_motions(model: LinearModel) -> Vector:
    """Shapes (n, k) of what moves without force while the base does not."""
    modes = normal_modes(model, model.base_constraints)
    found: Vector = modes.shapes[:, modes.is_free]
    return found


def _refuse_free_motions(model: LinearModel, advice: str) -> None:
    """Equilibrium is not unique where something moves without force."""
    free = _free_motions(model).shape[1]
    if free:
        raise SceneError(
            [
                f"the configuration has {free} motion{'s' * (free > 1)} without stiffness, so its equilibrium is not "
                f"unique; {advice}"
            ]
        )


def _port_motions(mechanism: Mechanism, step: Vector) -> Vector:
    """Small motions (ports, 6) of all connections' ports."""
    found = [
        mechanism.jacobian(name, port) @ step
        for name, connection in mechanism.connections.items()
        for port in range(len(connection.ports))
    ]
    return np.array(found).reshape(-1, 6)
