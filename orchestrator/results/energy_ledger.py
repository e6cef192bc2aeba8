"""Energies of a run, and whether the balance closes within the tolerance.

Every component records its kinetic, potential, dissipated and supplied energy and its numerical loss. The energy
*exchanged* up to a time is the sum of all gains since the start. In a perfect balance it equals the sum of all losses:
the energy that has changed its place or form, with or without a motor. A constant potential of kilojoules is not part
of it, and a motor that hardly moves does not make it small.

The tolerance is the relative accuracy of velocities. An energy goes with their square. So a run within the tolerance
has a residual of at most twice the tolerance times the energy exchanged, or times the kinetic energy if little is
exchanged.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from components import (
    DISSIPATED_ENERGY,
    KINETIC_ENERGY,
    NUMERICAL_DISSIPATION,
    POTENTIAL_ENERGY,
    SUPPLIED_ENERGY,
)
from components.contract.component import Vector

from ..messages import message
from .result import Result

_GAINS: Final = {
    KINETIC_ENERGY.name: 1.0,
    POTENTIAL_ENERGY.name: 1.0,
    DISSIPATED_ENERGY.name: 1.0,
    NUMERICAL_DISSIPATION.name: 1.0,
    SUPPLIED_ENERGY.name: -1.0,
}
_ALLOWED = 2.0
"""Relative error of an energy over that of the velocities."""
_NOTHING = 1e-12
"""J: what rounding leaves of the energies of what rests."""
_AT_REST, _ROUNDED = 1e-7, 1e-8
"""Of the energies that stand there: below the first nothing moves, and the second is what iterations leave of them."""
_SCENE = "scene"


class EnergyLedger(NamedTuple):
    """Energies (J) of a run: largest exchanged or in motion, numerical loss at the end, largest residual.

    standing: sum of the largest magnitudes of all stored energies, whether or not anything moves.
    """

    exchanged: float
    numerical: float
    residual: float
    tolerance: float | None
    """what the run was asked for, where its result tells"""
    standing: float = 0.0

    @property
    def relative_residual(self) -> float | None:
        """Residual over the energy exchanged; None where nothing moved."""
        return self.residual / self.exchanged if self.exchanged > 0.0 else None

    @property
    def _is_rounding(self) -> bool:
        """Whether nothing moves but for what iterations leave of energies that stand there."""
        rests = self.exchanged <= _AT_REST * self.standing
        return rests and self.residual <= _ROUNDED * self.standing

    def warnings(self) -> tuple[str, ...]:
        """A sentence where the balance is off by more than the tolerance allows."""
        relative = self.relative_residual
        if self.tolerance is None or relative is None or self.residual <= _NOTHING:
            return ()
        if relative <= _ALLOWED * self.tolerance or self._is_rounding:
            return ()
        return (
            message(
                "W-energy-balance",
                f"The energy balance is off by {self.residual:.3g} J, {relative:.2g} of the energy exchanged; the "
                f"tolerance allows {_ALLOWED * self.tolerance:.2g}. Run again with a smaller --tolerance, and check "
                "units of stiffnesses and torques.",
            ),
        )


def energy_ledger(result: Result) -> EnergyLedger | None:
    """The energies of a result; None where it has no balance of them."""
    if not result.has(_SCENE, "energy_residual"):
        return None
    numerical = 0.0
    if result.has(_SCENE, NUMERICAL_DISSIPATION.name):
        numerical = float(result.signal(_SCENE, NUMERICAL_DISSIPATION.name)[-1])
    return EnergyLedger(
        exchanged=float(max(energy.max() for energy in _exchange(result))),
        numerical=numerical,
        residual=float(np.max(np.abs(result.signal(_SCENE, "energy_residual")))),
        tolerance=tolerance_asked(result),
        standing=sum(_standing(result)),
    )


def _standing(result: Result) -> Iterator[float]:
    """Largest size (J) of every account of energy that is there."""
    for variable in (KINETIC_ENERGY.name, POTENTIAL_ENERGY.name):
        for name in result.recording(variable):
            if name != _SCENE:
                yield float(np.abs(result.signal(name, variable)).max())


def rows_of_exchange(result: Result) -> list[int]:
    """Rows at which most was exchanged, and most in motion."""
    return [int(np.argmax(energy)) for energy in _exchange(result)]


def _exchange(result: Result) -> tuple[Vector, Vector]:
    """Sum of gains since the start, and kinetic energy (J), each of shape (N,)."""
    exchanged: Vector = np.zeros(result.time.size)
    moving: Vector = np.zeros(result.time.size)
    for variable, sign in _GAINS.items():
        for name in result.recording(variable):
            if name == _SCENE:
                continue
            energy = result.signal(name, variable)
            exchanged += np.maximum(sign * (energy - energy[0]), 0.0)
            if variable == KINETIC_ENERGY.name:
                moving += energy
    return exchanged, moving


def tolerance_asked(result: Result) -> float | None:
    """The requested tolerance in the provenance; None if there is none."""
    return _tolerance(result, "tolerance")


def tolerance_taken(result: Result) -> float | None:
    """The smaller tolerance of a repeated run; None for other runs."""
    return _tolerance(result, "refined_tolerance")


def _tolerance(result: Result, name: str) -> float | None:
    try:
        return float(result.provenance[name])
    except (KeyError, ValueError):
        return None
