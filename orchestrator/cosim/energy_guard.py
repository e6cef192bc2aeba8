"""The energy guard: steps that leave the balance of energy open are none of the motion's, however well they converge.

The equations of a long step can have roots that the motion does not have. Wrenches and motions agree at them to
the last digit, but work that the rotation of a body makes of held wrenches does not: the balance jumps.
"""

from __future__ import annotations

from .energy_balance import Energies
from .implicit.snapshot import Numbers, plain

_SHARE = 1e-4
"""Largest jump over the energy in motion; sound steps of any length leave 2.5e-5 or less, spurious roots up to 1."""
_ROUNDED = 1e-12
"""Of all energies: rounding of their sums, and what solutions that agree to the iteration's tolerance leave at rest."""
_STEADY = 2.0
_STEADY_TRIALS = 4
_ALLOWANCE = 2.0


class EnergyGuard:
    """Whether the balance of energy of a step is closed well enough for the step to stand.

    A jump is measured against the energy in motion: the largest kinetic energy so far, or what changes hands in the
    step itself, whichever is more. Energy that was stored all the time says nothing about a step.

    What smaller steps do not cure is not for them to cure: a jump that goes with the length of the step is a power
    that a participant does not account for, and one that stays at the smallest step is rounding. Both are let
    pass from then on, and the recorded residual shows them.
    """

    def __init__(self, start: Energies) -> None:
        self._last = start
        self._kinetic = start.kinetic
        self._powers: list[float] = []
        self._power = 0.0
        self._rounding = 0.0

    def allows(self, found: Energies, h: float) -> bool:
        """Whether a step of size h (s) from the last accepted one to these energies stands."""
        jump = self._jump(found)
        if jump <= _SHARE * self._kinetic:
            return True
        known = max(self._power * h, self._rounding, _ROUNDED * sum(map(abs, found)))
        if not jump > max(_SHARE * self._in_motion(found), known):
            return True
        self._powers.append(jump / h)
        trials = self._powers[-_STEADY_TRIALS:]
        if len(trials) == _STEADY_TRIALS and max(trials) < _STEADY * min(trials):
            self._power = _ALLOWANCE * max(trials)
            return True
        return False

    def give_in(self, found: Energies) -> None:
        """Let pass from now on what the smallest step leaves open."""
        self._rounding = _ALLOWANCE * self._jump(found)

    def accept(self, found: Energies) -> None:
        """Take note of the energies that an accepted step ends with."""
        self._last = found
        self._kinetic = max(self._kinetic, found.kinetic)
        self._powers.clear()

    def numbers(self) -> Numbers:
        """All that it knows."""
        return {name: plain(value) for name, value in vars(self).items()}

    def take(self, numbers: Numbers) -> None:
        """What another guard knew."""
        vars(self).update(numbers, _last=Energies(**numbers["_last"]))

    def _jump(self, found: Energies) -> float:
        return abs(found.balance - self._last.balance)

    def _in_motion(self, found: Energies) -> float:
        exchanged = max(abs(after - before) for after, before in zip(found, self._last, strict=True))
        return max(self._kinetic, exchanged)
