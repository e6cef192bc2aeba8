"""The energy guard: it rejects spurious roots of the step equations, which do not conserve energy.

The equations of a long step can have roots that the motion does not have. At such a root wrenches and motions agree to
the last digit, but the work of constant wrenches on a rotating body does not: the energy balance jumps.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import Structure
from typing import Any

from .energy_balance import Energies
from .implicit.snapshot import Numbers
from .native.fields import fields

SHARE = 1e-4
"""Largest jump over the energy in motion; sound steps of any length leave 2.5e-5 or less, spurious roots up to 1."""
ROUNDED = 1e-12
"""Of all energies: rounding of their sums, and what solutions that agree to the iteration's tolerance leave at rest."""
_LEAST_KINETIC = 1e-17
"""J in motion, for steps of what hardly moves yet, where all is rounding."""
STEADY = 2.0
ALLOWANCE = 2.0


class EnergyGuard(Structure):
    """Whether the balance of energy of a step is closed well enough for the step to stand.

    A jump is measured against the energy in motion: the largest kinetic energy so far, a least one, or what changes
    hands in the step itself, whichever is more. Energy that was stored all the time says nothing about a step.

    What smaller steps do not cure is not for them to cure: a jump that goes with the length of the step is a power
    that a participant does not account for, and one that stays at the smallest step is rounding. Both are let
    pass from then on, and the recorded residual shows them.
    """

    _fields_ = fields("EnergyGuard")
    last: Sequence[float]
    kinetic: float
    powers: Sequence[float]
    power: float
    rounding: float
    trials: int

    def __init__(self, start: Energies) -> None:
        super().__init__(last=tuple(start), kinetic=max(start.kinetic, _LEAST_KINETIC))

    def allows(self, found: Energies, h: float) -> bool:
        """Whether a step of size h (s) from the last accepted one to these energies stands."""
        jump = self._jump(found)
        if jump <= SHARE * self.kinetic:
            return True
        known = max(self.power * h, self.rounding, ROUNDED * sum(map(abs, found)))
        if not jump > max(SHARE * self._in_motion(found), known):
            return True
        powers = [*self.powers[1:], jump / h]
        self.powers = tuple(powers)
        self.trials = min(self.trials + 1, len(powers))
        if self.trials < len(powers) or not max(powers) < STEADY * min(powers):
            return False
        self.power = ALLOWANCE * max(powers)
        return True

    def give_in(self, found: Energies) -> None:
        """Let pass from now on what the smallest step leaves open."""
        self.rounding = ALLOWANCE * self._jump(found)

    def accept(self, found: Energies) -> None:
        """Take note of the energies that an accepted step ends with."""
        self.last = tuple(found)
        self.kinetic = max(self.kinetic, found.kinetic)
        self.trials = 0

    @classmethod
    def of(cls, numbers: Numbers) -> EnergyGuard:
        """The one that was made plain numbers."""
        guard = cls(Energies(*numbers["last"]))
        Structure.__init__(guard, **{name: _settable(value) for name, value in numbers.items()})
        return guard

    def _jump(self, found: Energies) -> float:
        return abs(found.balance - Energies(*self.last).balance)

    def _in_motion(self, found: Energies) -> float:
        exchanged = max(abs(after - before) for after, before in zip(found, self.last, strict=True))
        return max(self.kinetic, exchanged)


def _settable(value: Any) -> Any:  # noqa: ANN401 - a number or a list of them
    """An array of a structure is set by a tuple."""
    return tuple(value) if isinstance(value, list) else value
