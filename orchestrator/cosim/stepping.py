"""Time: choosing communication steps, rejecting them, and finding events inside them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from ctypes import Structure
from dataclasses import dataclass
from math import ceil, floor, log, sqrt
from typing import NamedTuple

from components import FanfoldError

from ..assembly import HingeLine
from .implicit.convergence import Solution
from .implicit.solver import Solver
from .native.fields import fields
from .ports import Order

_ITERATED, _MOST_ITERATED = {2: 1e-2, 4: 1e-3}, 1e-6
"""Tolerance of an iteration over that of the run by order, and the largest; slopes take up what it leaves in stiff
joints, and recorded loads."""
_LOCKED, _LEAST_LOCKED = 1e-2, 1e-9
"""Of these where rigid bodies lock: what is left of a lock of 1e8 N.m/rad is a torque beside those of light bodies."""
RATIO = sqrt(2.0)
ALLOWED_SHARE = 12.0 * 0.0025
LOOSE = {2: 0.0, 4: 0.25}
"""Power of the tolerance that the allowed error of a step falls behind above 1e-4, where steps resolve less ringing."""
_LEAST_KINETIC_SHARE = 1e-3
_LEAST_KINETIC_ENERGY = 1e-9
REFERENCE_TOLERANCE = 1e-4
"""Below it, sizes of steps and the allowed error go with higher powers of the tolerance."""
GROWTH_MARGIN = 0.5
REJECTED, REJECTED_STIRRED = 3.0, 10.0
FORGET = 0.8
STIRRED_STEPS = 3
STEPS_AFTER_GROWTH = STIRRED_STEPS + 1
STEPS_AFTER_SHRINKING = 8
MOST_LEVELS, MOST_GROWTH = 6, 2
STEPS_AFTER_DIVISION = 16
LEAST_ERROR = 1e-9
TIME_ROUNDING, BREAK_REACHED = 1e-12, 1e-9  # s, what sums of step sizes may leave
STRETCHED, SHARED = 1.001, 1.5
"""Steps in which a remainder that would be a tiny step is taken in one, or where a step may be chosen in two."""
_TO_CONVERGE = 1.0 / 1024.0
"""Of the smallest step for accuracy: friction that breaks away below a light body in a lock converges where it moves
little in a step."""
_LONGER = 1.1
_PLAN_TAIL, _PARTS, _MOST_PARTS = 8, 4, 1024


class StepError(FanfoldError):
    """A step failed at every size: a sentence with the connection, the residual and the time."""


class StepSizes(Structure):
    """The geometric grid of communication step sizes, largest x sqrt(2)^-k, and where we are on it.

    A change of step stirs up whatever is stiff, so steps change seldom: an error a little above what is
    allowed is accepted and the next step made smaller, and after a change the size stays for a while.
    Errors of the first steps after a change are those of the stirring, which smaller steps would only renew:
    they stand unless they are large, and say nothing about the next size.
    """

    _fields_ = fields("StepSizes")
    largest: float
    smallest: float
    order: Order
    level: int
    wait: int
    stirred: int
    worst: float

    def __init__(self, largest: float, smallest: float, order: Order = 2, **others: float) -> None:
        super().__init__(largest, smallest, order, **others)

    @property
    def _per_level(self) -> float:
        """Logarithm of how much the error of a step grows with one level."""
        return (self.order + 1) * log(RATIO)

    @property
    def size(self) -> float:
        """Present step size."""
        return self.largest * RATIO**-self.level

    def restart(self, size: float, *, stirred: bool = True) -> None:
        """Go to the grid size at or below the given one; not stirred: errors of the first steps count like others."""
        self.level = max(0, -floor(log(size / self.largest) / log(RATIO) + 1e-9))
        self._changed(STEPS_AFTER_GROWTH)
        if not stirred:
            self.stirred = 0

    def shrink(self, levels: int = 2, *, to_converge: bool = False) -> bool:
        """Go down; False where that is below the smallest size, which no accuracy but convergence may go below."""
        self.level += levels
        self._changed(STEPS_AFTER_SHRINKING)
        return self.size >= self.least(to_converge=to_converge)

    def least(self, *, to_converge: bool = False) -> float:
        """Size (s) that accuracy, or convergence, may ask for at the least."""
        return self.smallest * (_TO_CONVERGE if to_converge else 1.0)

    def judge(self, error: float) -> bool:
        """Whether a step with this error (over what is allowed) stands; chooses the size of the next one."""
        can_shrink = self.size > 2.0 * self.smallest
        stirred = self.stirred > 0
        if error > (REJECTED_STIRRED if stirred else REJECTED) and can_shrink:
            self.shrink(max(1, min(MOST_LEVELS, ceil(log(error) / self._per_level))))
            return False
        self.wait -= 1
        if stirred:
            self.stirred -= 1
            return True
        self.worst = max(error, FORGET * self.worst)
        if error > 1.0 and can_shrink:
            self.shrink(1)
        elif self.wait <= 0:
            room = floor(log(GROWTH_MARGIN / max(self.worst, LEAST_ERROR)) / self._per_level)
            if room >= 1 and self.level > 0:
                self.level = max(0, self.level - min(room, MOST_GROWTH))
                self._changed(STEPS_AFTER_GROWTH)
        return True

    def _changed(self, wait: int) -> None:
        self.wait, self.stirred, self.worst = wait, STIRRED_STEPS, 0.0


class Iterated(NamedTuple):
    """Tolerance of iterations: a share of that of the run, but neither below nor above some."""

    share: float
    least: float
    most: float

    def of(self, tolerance: float) -> float:
        """In a run of a tolerance."""
        return min(max(self.share * tolerance, self.least), self.most)


def iterated(lines: Iterable[HingeLine], order: Order) -> Iterated:
    """Settings of a run with these lines; locks need a smaller tolerance, limited by round-off."""
    share = _ITERATED[order]
    if not any(line.locks_rigid for line in lines):
        return Iterated(share, 0.0, _MOST_ITERATED)
    return Iterated(_LOCKED * share, _LEAST_LOCKED, _LOCKED * _MOST_ITERATED)


def _allowed(tolerance: float, order: Order) -> float:
    """Error of a step, from the wrenches h^2 u'' or what is left of them, that a run with this tolerance may make."""
    ratio = tolerance / REFERENCE_TOLERANCE
    power = 1.0 / order if ratio < 1.0 else -LOOSE[order]
    return float(ALLOWED_SHARE * tolerance * ratio**power)


class ErrorEstimate(Structure):
    """Local error of a step from how far its mean wrench lies off the line through the last two, or off its slopes.

    The mean over the step errs by a twelfth of h^2 u'', or of what slopes do not tell of it. The work such
    wrenches do on the motion they cause, over an energy, is the square of a relative error in velocity; measured
    so, a light attachment point that springs about without energy does not hold up a whole wing. The energy is
    the largest of what motors will put through the scene, of the kinetic energy seen, and of a thousandth of what
    is stored at the start. The part that is allowed goes with the tolerance to the power (n + 1) / n below 1e-4,
    so that errors, which go with h^n where those of a step go with h^(n + 1), follow the tolerance.
    """

    _fields_ = fields("ErrorEstimate")
    allowed: float
    resolved: float
    energy: float

    def __init__(self, tolerance: float, stored: float, driving: float = 0.0, order: Order = 2) -> None:
        energy = max(_LEAST_KINETIC_SHARE * abs(stored), driving, _LEAST_KINETIC_ENERGY)
        super().__init__(_allowed(tolerance, order), _allowed(tolerance, 2), energy)

    @property
    def resolved_angle(self) -> float:
        """Angular frequency times step size (rad) up to which a vibration that holds all energy is followed well.

        By order 2, at order 4 as well: what an event starts is no smoother.
        """
        return float(self.resolved ** (1.0 / 3.0))

    def see(self, kinetic: float) -> None:
        """Take note of the kinetic energy (J)."""
        self.energy = max(self.energy, kinetic)

    def __call__(self, square: float) -> float:
        """Error over what is allowed, from the square of the relative error that the wrenches h^2 u'' make."""
        return sqrt(square) / self.allowed

    def share(self, square: float) -> float:
        """Part of a step, at most all of it, whose error leaves room to grow, where errors go with the step."""
        return min(1.0, GROWTH_MARGIN / max(self(square), LEAST_ERROR))


def share_of_steps(tolerance: float) -> float:
    """Part of the largest, the smallest and first steps that a run of a tolerance takes."""
    return min(1.0, sqrt(tolerance / REFERENCE_TOLERANCE))


@dataclass
class SubdividedStep:
    """Parts that a fixed step is made in, as whole ones did not converge or gained energy; made: steps of this size.

    Parts become fewer seldom: steps that are larger and smaller in turn pump what is stiff.
    """

    parts: int = 1
    made: int = 0

    def divide(self) -> bool:
        """Four parts of each; False where these are too many."""
        self.parts, self.made = self.parts * _PARTS, 0
        return self.parts <= _MOST_PARTS

    def stood(self) -> None:
        """Count a step that stands, and try half the parts after some."""
        self.made += 1
        if self.parts > 1 and self.made >= STEPS_AFTER_DIVISION:
            self.parts, self.made = self.parts // 2, 0


class StepPlan:
    """Steps given before a run, a list (s) for every segment between events; those beyond the last go by that."""

    def __init__(self, segments: Sequence[Sequence[float]]) -> None:
        # a run that ends at an event has begun a segment without steps
        self._segments = [list(segment) for segment in segments if segment]

    def __bool__(self) -> bool:
        return bool(self._segments)

    def now(self, made: Sequence[Sequence[float]]) -> tuple[list[float], int]:
        """The plan (s) of the present segment, and where in it a run stands that has made these steps."""
        segment, position = len(made) - 1, len(made[-1])
        plan = self._segments[min(segment, len(self._segments) - 1)]
        # beyond its end, not the last step's size: that one only ended at an event and may be tiny
        plan.extend([max(plan[-_PLAN_TAIL:])] * (position + 1 - len(plan)))
        return plan, position

    def first_after(self, made: Sequence[Sequence[float]]) -> float:
        """The first planned step (s) after an event now."""
        return self.now([*made, []] if made[-1] else made)[0][0]

    def divide(self, made: Sequence[Sequence[float]], least: float) -> bool:
        """Make several steps of the next one; False where they would be smaller than that (s)."""
        plan, position = self.now(made)
        part = plan[position] / _PARTS
        if part < least:
            return False
        plan[position : position + 1] = [part] * _PARTS
        return True


def to_own_events(segments: Sequence[Sequence[float]]) -> list[list[float]]:
    """Steps of a run as a plan for one whose events come a little earlier or later: the last of each is longer.

    Without, an event that comes a little later leaves a step so tiny that loads after it are off.
    """
    return [[*steps[:-1], _LONGER * steps[-1]] if steps else [] for steps in segments]


def failure(solver: Solver, solution: Solution, time: float, h: float) -> Exception:
    """What to raise when even the smallest step does not converge: a participant's own error, or a StepError."""
    return solution.failure or StepError(
        f"the step of {h:.3g} s from t = {time:.6f} s does not converge: after {solution.iterations} iterations the "
        f"wrench of {solver.network.port_of_row(solution.worst_row)} still changes by {solution.correction:.3g} "
        "times its tolerance; loosen the tolerance, check that connection's stiffness, or start from a smaller step"
    )
