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
    model, moved = _with_loaded_joints(mechanism, advice)
    before = np.inf
    for iteration in range(_MOST_ITERATIONS):
        if iteration:
            model = linearise(mechanism)
        rows = model.other_rows
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


def _with_loaded_joints(mechanism: Mechanism, advice: str) -> tuple[LinearModel, Vector]:
    """The tangent with joints that carry what loads ask of them, and the motion (n,) that it took.

    A pendulum in a joint that carries nothing yet has no stiffness, nor has a rope without tension: a step that leaves
    out the free motions loads them. SceneError where something moves without force still.
    """
    model, moved = linearise(mechanism), np.zeros(mechanism.size)
    free = _free_motions(model)
    if not free.size:
        return model, moved
    rows = model.other_rows
    kept = linalg.null_space((model.mass @ free)[rows].T)
    stiffness = kept.T @ model.stiffness[np.ix_(rows, rows)] @ kept
    moved[rows] = kept @ np.linalg.lstsq(stiffness, kept.T @ model.residual[rows])[0]
    if float(np.abs(_port_motions(mechanism, moved)[:, 3:]).max(initial=0.0)) <= _LARGEST_TURN:
        mechanism.move(moved)
        model = linearise(mechanism)
        free = _free_motions(model)
    if free.size:
        count = free.shape[1]
        raise SceneError(
            [
                f"the configuration has {count} motion{'s' * (count > 1)} without stiffness, so its equilibrium is not "
                f"unique; {advice}"
            ]
        )
    return model, moved


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
