"""Static equilibrium of a mechanism near its pose, by Newton's method on the exact tangent.

Where a step of Newton leads astray, as at a contact or a slack rope, or where nothing is stiff yet, inertia damps it:
(K + M / h^2) x = f is an implicit step, of the size h (s), of the motion from rest, and h grows as steps succeed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from components import ComponentError
from components.contract.component import Vector

from ...scene.table import SceneError
from ..dense import null_space
from . import ZERO_FREQUENCY
from .linear_model import LinearModel, Rows, normal_modes
from .mechanism import Mechanism

_MOST_ITERATIONS, _MOST_AT_START = 40, 200
_LARGEST_TURN, _LARGEST_WAY = 0.15, 1.0
"""rad and m, in one iteration"""
_FARTHEST = 0.6
"""rad, from where the search began; an equilibrium beyond belongs to another configuration"""
_DRIVEN = 1e-9
"""Of the largest force out of balance, that drives no free motion."""
_TOLERANCE = 1e-9
"""m and rad that the last iteration may move a port"""
_ALIKE, _FALLING = 1e-4, 1e-2
"""m and rad of an iteration that leaves the stiffness as it is, if the work fell to so much of the one before"""
_MORE, _NEAR = 2.0, 1e-7
"""Times as far as the last steps, that another may lead on from there; of steps that move ports (m, rad) further."""
_DAMPED, _SHORTER, _LONGER, _LONGEST = 1.0, 0.25, 4.0, 1e3
"""Step (s) that a first failure leads to, factors after a failure and after a success, and the longest damped one."""
_TURNS = 7e-5
"""rad/s2 of a free spacecraft, from which on it does not rest."""


class NoEquilibriumError(SceneError):
    """There is none; `acceleration` (n,) of all coordinates where the search ended. turns_as_one: of a free whole."""

    def __init__(self, acceleration: Vector, *, turns_as_one: bool) -> None:
        super().__init__(["there is no static equilibrium"])
        self.acceleration, self.turns_as_one = acceleration, turns_as_one


class _Tangent(NamedTuple):
    """Linear equations about a pose, and what moves there without force.

    rows: of coordinates that move. rigid: basis (n, 6) of what the whole does as one where nothing holds it, or None.
    free: shapes (n, k).
    """

    model: LinearModel
    rows: Rows
    rigid: Vector | None
    free: Vector

    @property
    def forces(self) -> Vector:
        """(n,) out of balance; of a free whole in axes that fall with it."""
        force = self.model.residual
        if self.rigid is None:
            return force
        found: Vector = force - self.model.mass @ (self.rigid @ (self.rigid.T @ force))
        return found

    @property
    def drive(self) -> Vector:
        """Acceleration (n,) that forces give to free motions."""
        found: Vector = self.free @ (self.free.T @ self.forces)
        return found

    @property
    def is_driven(self) -> bool:
        """Whether they give any."""
        force = self.forces
        largest = float(np.abs(self.free.T @ force).max(initial=0.0))
        return largest > _DRIVEN * float(np.abs(force).max(initial=1.0))

    @property
    def idle(self) -> Vector:
        """Shapes (n, k) of free motions that nothing drives: all across the one that forces would start."""
        if not self.is_driven:
            return self.free
        found: Vector = self.free @ null_space((self.free.T @ self.forces)[None])
        return found

    def step(self, size: float, without: Vector) -> Vector:
        """An implicit step (n,) of a size (s) without motions of shapes (n, k); LinAlgError where there is none."""
        model, rows = self.model, self.rows
        matrix = model.stiffness if size == np.inf else model.stiffness + model.mass / size**2
        found = np.zeros(len(model.mass))
        if without.size:
            kept = np.zeros((len(found), len(rows) - without.shape[1]))
            kept[rows] = null_space((model.mass @ without)[rows].T)
            found = kept @ np.linalg.lstsq(kept.T @ matrix @ kept, kept.T @ self.forces)[0]
        else:
            found[rows] = np.linalg.solve(matrix[np.ix_(rows, rows)], self.forces[rows])
        if self.rigid is not None:
            found -= self.rigid @ (self.rigid.T @ (model.mass @ found))
        return found

    def mean_way(self, motion: Vector) -> float:
        """Root mean square (m) over all mass of a motion (n,), as bodies may bend far between ports that stay."""
        return float(np.sqrt(abs(motion @ self.model.mass @ motion) / self.model.total_mass))

    def with_forces(self, mechanism: Mechanism) -> _Tangent:
        """The same with the forces of the mechanism's present pose."""
        return self._replace(model=replace(self.model, residual=mechanism.forces()))


class _Step(NamedTuple):
    """A step (n,) from a pose: how far (m or rad) it moves a port or all mass; what share may be made; its work (J)."""

    motion: Vector
    way: float
    share: float
    work: float

    @property
    def made(self) -> Vector:
        """As far as one iteration may go."""
        found: Vector = self.share * self.motion
        return found


def settle(mechanism: Mechanism, advice: str) -> None:
    """Move to equilibrium, the base standing still; SceneError where there is none near, with the advice."""
    tangent = _with_loaded_joints(mechanism, at_start=False)
    if count := tangent.free.shape[1]:
        raise SceneError(
            [
                f"the configuration has {count} motion{'s' * (count > 1)} without stiffness, so its equilibrium is not "
                f"unique; {advice}"
            ]
        )
    if not _iterated(mechanism, tangent, at_start=False):
        raise SceneError([f"there is no static equilibrium near this configuration; {advice}"])


def come_to_rest(mechanism: Mechanism) -> None:
    """Move to where a run can start at rest; NoEquilibriumError where that is nowhere.

    What moves without force may stay where it is, as nothing drives it, and a free whole may fall.
    """
    tangent = _tangent(mechanism, at_start=True)
    if tangent.rigid is not None:
        acceleration = tangent.rigid @ (tangent.rigid.T @ tangent.model.residual)
        if np.abs(acceleration[tangent.model.base_rows][3:]).max() > _TURNS:
            raise NoEquilibriumError(acceleration, turns_as_one=True)
    if not _iterated(mechanism, tangent, at_start=True):
        tangent = _tangent(mechanism, at_start=True)
        raise NoEquilibriumError(_acceleration(tangent), turns_as_one=False)


def driven_motion(mechanism: Mechanism) -> Vector | None:
    """What loads drive away (n,) once joints carry what they can: of motions without stiffness; None where none are."""
    tangent = _with_loaded_joints(mechanism, at_start=True)
    return tangent.drive if tangent.is_driven else None


def _iterated(mechanism: Mechanism, tangent: _Tangent, *, at_start: bool) -> bool:
    """Newton's iteration from a pose and its tangent; whether it ends in equilibrium.

    A start is where potential falls to, be it far. Near the end the stiffness is left as it is.
    """
    size = _DAMPED if tangent.is_driven else np.inf
    moved, before, way, alike = np.zeros(mechanism.size), np.inf, 0.0, False
    for _ in range(_MOST_AT_START if at_start else _MOST_ITERATIONS):
        step = _step(mechanism, tangent, size)
        if step is None or (at_start and step.work < 0.0):
            size = _shorter(size)
            continue
        pose = mechanism.pose()
        after = _after(mechanism, step, tangent if alike else None, at_start=at_start)
        if after is None or not _leads_on(mechanism, max(step.way, way), after, size):
            mechanism.come_back(pose)
            size, alike = _shorter(size), False
            continue
        moved += step.made
        # beside a stiff clamp ports hardly move; what is out of balance falls with the work until it is round-off
        if step.way < _TOLERANCE and abs(step.work) >= 0.5 * before and size == np.inf:
            mechanism.follow()
            return True
        turned = float(np.abs(_port_motions(mechanism, moved)[:, 3:]).max(initial=0.0))
        if (not at_start and turned > _FARTHEST) or (size >= _LONGEST and after.is_driven):
            return False
        falling = abs(step.work) < _FALLING * before < np.inf
        alike = step.way < _TOLERANCE or (step.way < _ALIKE and falling)
        before, way, tangent = abs(step.work), step.way, after
        size = size * _LONGER if size < _LONGEST else np.inf
    return False


def _shorter(size: float) -> float:
    return _SHORTER * min(size, _DAMPED / _SHORTER)


def _step(mechanism: Mechanism, tangent: _Tangent, size: float) -> _Step | None:
    """A step of a size (s) from a tangent; None where its equations have no solution."""
    try:
        motion = tangent.step(size, tangent.idle)
    except np.linalg.LinAlgError:
        return None
    ports = _port_motions(mechanism, motion)
    if not np.isfinite(ports).all():
        return None
    way, turn = (float(np.abs(part).max(initial=1e-300)) for part in (ports, ports[:, 3:]))
    share = min(1.0, _LARGEST_TURN / turn, _LARGEST_WAY / way)
    work = share * float(motion @ tangent.forces)
    return _Step(motion, max(way, tangent.mean_way(motion)), share, work)


def _after(mechanism: Mechanism, step: _Step, kept: _Tangent | None, *, at_start: bool) -> _Tangent | None:
    """The tangent at the end of a step, or the one kept with the forces there; None where a component refuses."""
    try:
        mechanism.move(step.made)
        after = _tangent(mechanism, at_start=at_start) if kept is None else kept.with_forces(mechanism)
    except (ComponentError, SceneError, ArithmeticError, ValueError):
        return None
    return after if np.isfinite(after.model.residual).all() else None


def _leads_on(mechanism: Mechanism, way: float, after: _Tangent, size: float) -> bool:
    """Whether what would follow leads no further than the last two steps (m, rad).

    Forces say nothing: a joint of 1e9 N/m turns the square of a small rotation into more than all loads, which the next
    step, a small one, takes away.
    """
    if way <= _NEAR:
        return True
    left = _step(mechanism, after, size)
    return left is None or left.way <= _MORE * way


def _tangent(mechanism: Mechanism, *, at_start: bool) -> _Tangent:
    """About the present pose. at_start: a free base moves, unless nothing holds the whole, which moves about it."""
    mechanism.carry()
    none = np.zeros((mechanism.size, mechanism.size))
    mass, stiffness, forces = mechanism.mass(), mechanism.stiffness(), mechanism.forces()
    model = LinearModel(mechanism, mass, none, none, stiffness, forces)
    rows, rigid = model.other_rows, None
    if at_start and not model.is_grounded:
        whole = mechanism.rigid_motion(model.origin)
        held = np.abs(whole[:, :3].T @ stiffness @ whole[:, :3]).max()
        if held > (2.0 * np.pi * ZERO_FREQUENCY) ** 2 * np.trace(mass):
            rows = model.free_rows
        else:
            factor = np.linalg.cholesky(whole.T @ mass @ whole)
            rigid = np.linalg.solve(factor, whole.T).T
    return _Tangent(model, rows, rigid, _free_motions(model, rows))


def _free_motions(model: LinearModel, rows: Rows) -> Vector:
    """Shapes (n, k) of what moves without force in these coordinates."""
    count = len(model.mass)
    if not rows.size:
        return np.zeros((count, 0))
    still = np.setdiff1d(np.arange(count), rows)
    modes = normal_modes(model, np.eye(count)[still] if still.size else None)
    found: Vector = modes.shapes[:, modes.is_free]
    return found


def _with_loaded_joints(mechanism: Mechanism, *, at_start: bool) -> _Tangent:
    """Where joints carry what loads ask of them.

    A pendulum in a joint that carries nothing yet has no stiffness, nor has a rope without tension: a step that leaves
    out the free motions loads them.
    """
    tangent = _tangent(mechanism, at_start=at_start)
    if not tangent.free.size:
        return tangent
    step = tangent.step(np.inf, tangent.free)
    if float(np.abs(_port_motions(mechanism, step)[:, 3:]).max(initial=0.0)) > _LARGEST_TURN:
        return tangent
    mechanism.move(step)
    return _tangent(mechanism, at_start=at_start)


def _acceleration(tangent: _Tangent) -> Vector:
    """(n,) of what moves without stiffness, or of all coordinates where nothing does."""
    if tangent.is_driven:
        return tangent.drive
    rows, found = tangent.rows, np.zeros(len(tangent.model.mass))
    found[rows] = np.linalg.solve(tangent.model.mass[np.ix_(rows, rows)], tangent.forces[rows])
    return found


def _port_motions(mechanism: Mechanism, step: Vector) -> Vector:
    """Small motions (ports, 6) of all connections' ports."""
    found = [mechanism.port_motions(name) @ step for name in mechanism.connections]
    return np.concatenate([np.zeros(0), *found]).reshape(-1, 6)
