"""Forces on the modes of a body whose bending stretches it: energy 1/2 sum N_p^2, tensions N_p = 1/2 eta^T S_p eta.

Over a step they act as means of the tensions at both ends on the slopes of these at the mean coordinates: N is
quadratic, and its change is exactly that slope times the change of the coordinates, so that their work is the energy
exactly (a discrete gradient: Gonzalez 1996).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contract.component import Vector


class Tension(NamedTuple):
    """At modal coordinates: tensions N (P,), root of J, and their derivatives (P, S)."""

    tension: Vector
    slope: Vector


class TensionForms:
    """The forms S_p (P, S, S) of a body; its S lowest modes stretch it."""

    def __init__(self, forms: Vector) -> None:
        self.count = forms.shape[1]
        self._forms = forms
        self._rows = forms.reshape(-1, forms.shape[2])

    def at(self, eta: Vector) -> Tension:
        """Tensions at modal coordinates (M,)."""
        low = eta[: self.count]
        slope = (self._rows @ low).reshape(-1, self.count)
        return Tension(0.5 * (slope @ low), slope)

    def energy(self, eta: Vector) -> float:
        """Energy (J) of the tensions at modal coordinates (M,)."""
        tension = self.at(eta).tension
        return 0.5 * float(tension @ tension)

    def add_force(self, start: Tension, end: Tension, force: Vector) -> None:
        """Adds to forces (M,) those of a step between these ends."""
        force[: self.count] -= 0.5 * (start.tension + end.tension) @ (0.5 * (start.slope + end.slope))

    def tangent(self, start: Tension, end: Tension) -> Vector:
        """Twice the derivative (S, S) of the forces of a step by the coordinates at its end.

        At equal ends it is that of the forces of an instant by its coordinates.
        """
        mean = 0.5 * (start.tension + end.tension)
        slope = 0.5 * (start.slope + end.slope)
        found: Vector = -(slope.T @ end.slope + np.tensordot(mean, self._forms, 1))
        return found
