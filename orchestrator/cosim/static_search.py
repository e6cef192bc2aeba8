"""Static equilibrium before a run: implicit steps of the participants' own gradient flow, ever longer.

A step of size h moves every body by h^2 times its unbalanced force over its mass, so long steps are Newton's method
for the equilibrium and short ones keep it from going astray: where stiffnesses are uneven, a joint of 1e9 N/m turns
the square of a small rotation into a wrench that the linear system knows nothing of.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from components.contract.ports import MOTION_SIZE

from .implicit.solver import Solver
from .participant import Vector
from .stepping import StepError, failure

_STEPS = (0.005, 0.01, 0.02, *(0.03,) * 6, *(0.06,) * 6, *(0.12,) * 5)
"""What is left of a coordinate's way to rest after a step is 1 / (1 + (w h)^2) of it; the last steps are alike."""
DURATION = sum(_STEPS)
"""Seconds before the start of a run that the search takes by the participants' clocks."""
_PARTS = 4
_KEPT = 16
"""Steps of a size that had to be found by dividing before a longer one is tried again."""
_SHORTEST = 1e-5
_MOST_DIVIDED = 1000
"""Steps that the whole search may divide: where no size leads on, four times as many fail at every smaller one."""
_AT_REST = 1e-6
"""Largest motion (m, rad) in the last step of what rests: 7e-5 m/s2 of unbalanced force over mass."""
_LONGER, _MOST_LONGER = 2.0, 8
"""Steps after these, each so many times as long as the one before, where something soft has not come to rest: 30 s."""
_STEADY, _FELT = 1e-6, 1e-3
"""Change of loads in a step, of the largest, up to which no longer one is made, and from which on it is told."""
_NO_LOAD = 1e-6
"""N or N.m, in whose size changes are judged where there are hardly any loads."""
_UNHELD = 1e-3
"""Largest relative change of the motion from one step to the next where nothing holds: softer than 0.04 Hz."""


class StaticSearch:
    """Brings the participants of a solver to static equilibrium, from their saved states at -`DURATION`.

    They are saved there. StepError where a step converges at no size, or where something is free to move.
    """

    def __init__(self, solver: Solver) -> None:
        self._solver = solver
        self._before = solver.accepted.copy()
        self._divided = 0
        self._longest = np.inf
        self._kept = 0
        network = solver.network
        self._ports = [
            (body, port)
            for body, ports in zip(network.bodies, network.body_ports, strict=True)
            for port in range(len(ports))
        ]

    def run(self) -> str:
        """Search; the solver's accepted wrenches are those of the equilibrium afterwards.

        What does not come to rest, a sentence, as soft coordinates hardly do; empty where all does.
        """
        solver = self._solver
        usual, solver.persistent = solver.persistent, True
        time = -DURATION
        poses = [self._poses()]
        for h in _STEPS:
            self._follow(time, h)
            time += h
            poses.append(self._poses())
        self._check_held(*poses[-3:], h=_STEPS[-1])
        h = self._go_on(poses)
        told = self._restless(_motions(*poses[-2:]), h) or self._spurious(poses[-1])
        solver.persistent = usual
        return told

    def _go_on(self, poses: list[list[Vector]]) -> float:
        """Ever longer steps, which end at t = 0 all of them, until all rests; the size (s) of the last one made.

        None where all falls as one, which longer steps would only carry away.
        """
        h = _STEPS[-1]
        for _ in range(_MOST_LONGER):
            falls = all(np.abs(_motion(a, b)[:3]).max() > _AT_REST for a, b in zip(*poses[-2:], strict=True))
            moves = max(np.abs(motion).max() for motion in _motions(*poses[-2:])) > _AT_REST
            if falls or (not moves and self._unsteady <= _STEADY):
                break
            h *= _LONGER
            self._follow(-h, h)
            poses.append(self._poses())
        return h

    @property
    def _unsteady(self) -> float:
        """Change of the loads in the last step over the largest: of bodies that bend beyond what holds them."""
        accepted = self._solver.accepted
        largest = float(np.abs(accepted).max(initial=0.0))
        return float(np.abs(accepted - self._before).max(initial=0.0)) / max(largest, _NO_LOAD)

    def _restless(self, motions: Sequence[Vector], h: float) -> str:
        worst = int(np.argmax([np.abs(motion).max() for motion in motions]))
        name = self._ports[worst][0].name
        if np.abs(motions[worst]).max() > _AT_REST:
            return (
                f"the run does not start at rest: {name} still moves {_left(motions[worst], h)} at the end of the "
                "static search. Check for joints that are soft relative to their loads, or add a restraint in "
                "this direction."
            )
        if self._unsteady > _FELT:
            return (
                f"the run does not start at rest: loads still change by {self._unsteady:.2g} of the largest at the "
                "end of the static search, because a body vibrates more slowly than the search lasts. Check the "
                "first rows of the result."
            )
        return ""

    def _spurious(self, poses: Sequence[Vector]) -> str:
        """A sentence where a short step leads away from these poses: to where long ones led has no equilibrium.

        A long step of a body that bends far has more roots than one. The short step is taken back.
        """
        solver, h = self._solver, _STEPS[0]
        solution = solver.solve(-h, h, solver.accepted)
        motions = _motions(poses, self._poses())
        solver.restore()
        solver.forget()
        worst = int(np.argmax([np.abs(motion).max() for motion in motions]))
        if solution.converged and np.abs(motions[worst]).max() <= _AT_REST:
            return ""
        return (
            "it does not start at rest: the search for static equilibrium ends where "
            f"{self._ports[worst][0].name} is in none, as its loads bend it or its joints further than the search "
            "can follow"
        )

    def _follow(self, time: float, h: float) -> None:
        """A step, or several short ones in its place where it does not converge, or lately did not."""
        if h <= self._longest and self._made(time, h):
            return
        for part in range(_PARTS):
            self._follow(time + part * h / _PARTS, h / _PARTS)

    def _made(self, time: float, h: float) -> bool:
        """Make a step; where it does not converge, False, and none as long is tried for a while."""
        solver = self._solver
        self._before[:] = solver.accepted
        solver.persistent = h <= _STEPS[0]
        solution = solver.solve(time, h, solver.accepted)
        if solution.converged:
            solver.accepted[:] = solver.wrenches
            solver.save(time + h)
            self._kept += 1
            if self._kept == _KEPT:
                self._longest, self._kept = _PARTS * self._longest, 0
            return True
        self._divided += 1
        if h < _SHORTEST or self._divided > _MOST_DIVIDED:
            raise failure(solver, solution, time, h)
        self._longest, self._kept = 0.5 * h, 0
        return False

    def _poses(self) -> list[Vector]:
        """Position and quaternion (7,) of every port of all bodies."""
        return [
            body.outputs[MOTION_SIZE * port : MOTION_SIZE * port + 7].copy() for body, port in self._ports
        ]

    def _check_held(self, *poses: Sequence[Vector], h: float) -> None:
        """StepError that names the body that moves most, if nothing slows it down."""
        before, last = (_motions(*pair) for pair in pairwise(poses))
        worst = int(np.argmax([np.abs(move).max() for move in last]))
        size = float(np.abs(last[worst]).max())
        change = float(np.abs(last[worst] - before[worst]).max())
        if size <= _AT_REST or change > _UNHELD * size:
            return
        turn = _turn_as_one(poses[-2], last)
        if turn is not None:
            raise StepError(
                "there is no static equilibrium to start from: with all hinges held, loads turn all that is free as "
                f"one {_described(turn, h)}; start without preload, or have them begin later"
            )
        raise StepError(
            f"there is no static equilibrium to start from: with all hinges held, {self._ports[worst][0].name} still "
            f"moves {_described(last[worst], h)}; nothing, or next to nothing, holds it in that direction: add a "
            "connection with stiffness there, or start without preload"
        )


def _motions(before: Sequence[Vector], after: Sequence[Vector]) -> list[Vector]:
    """Motions of all ports; where none stays, but for their mean translation: a free spacecraft falls as one."""
    moves = [_motion(a, b) for a, b in zip(before, after, strict=True)]
    if not all(move.any() for move in moves):
        return moves
    shared = np.mean([move[:3] for move in moves], axis=0)
    return [np.concatenate((move[:3] - shared, move[3:])) for move in moves]


def _turn_as_one(poses: Sequence[Vector], motions: Sequence[Vector]) -> Vector | None:
    """The turn (6,) that all ports at these poses share as those of one rigid body; None where they do not."""
    turns = np.array([motion[3:] for motion in motions])
    shifts = np.array([motion[:3] for motion in motions])
    turn, arms = turns.mean(axis=0), np.array([pose[:3] for pose in poses])
    own = shifts - np.cross(turn, arms - arms.mean(axis=0))
    apart = np.abs(np.concatenate((own - own.mean(axis=0), turns - turn))).max()
    moved = np.abs(np.concatenate((shifts, turns))).max()
    return np.concatenate((np.zeros(3), turn)) if apart <= _UNHELD * moved else None


def _motion(before: Vector, after: Vector) -> Vector:
    """Translation (m) and rotation vector (rad) between two poses, world axes, small."""
    w, x, y, z = before[3:7].tolist()
    back = np.array([[-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])
    turn = 2.0 * (back @ after[3:7])
    return np.concatenate((after[:3] - before[:3], turn))


def _way(move: Vector) -> tuple[str, str, float]:
    """In which direction a port moves most, in m or rad, and how far."""
    shift, turn = move[:3], move[3:]
    vector, words, unit = (
        (shift, "along", "m") if np.abs(shift).max() >= np.abs(turn).max() else (turn, "about", "rad")
    )
    size = float(np.linalg.norm(vector))
    x, y, z = (vector / size).round(2).tolist()
    return f"{words} ({x:g}, {y:g}, {z:g})", unit, size


def _described(move: Vector, h: float) -> str:
    """How what nothing holds would start."""
    way, unit, size = _way(move)
    return f"{way}, by {size / h**2:.2g} {unit}/s2"


def _left(move: Vector, h: float) -> str:
    """How what something holds still creeps: h is no time of its own, so that no acceleration follows."""
    way, unit, size = _way(move)
    return f"{way}, by {size:.2g} {unit} in its last step, of {h:.2g} s"
