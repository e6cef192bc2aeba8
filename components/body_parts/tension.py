"""Forces on the modes of a body whose bending stretches it: energy 1/2 sum N_p^2, tensions N_p = 1/2 eta^T S_p eta.

Over a step they are linear in time, u0 + u1 P1. With the mean g of the energy's gradient along the straight path of
the coordinates (Simpson's rule is exact), its divided difference K (g1 - g0 = K (eta1 - eta0)) and the first moments m
of the modal rates,

    u0 = -g + K m / 2,    u1 = -(g1 - g0) / 2:

of order 4, as the pair of K does no work, and the work of the rest is the energy exactly (`fourth_order_correction`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contract.component import Vector


class Tension(NamedTuple):
    """At modal coordinates low (S,): tensions N (P,), root of J, and their derivatives (P, S)."""

    low: Vector
    tension: Vector
    slope: Vector

    @property
    def gradient(self) -> Vector:
        """Of the energy (S,)."""
        found: Vector = self.tension @ self.slope
        return found


class TensionForms:
    """The forms S_p (P, S, S) of a body; its S lowest modes stretch it."""

    def __init__(self, forms: Vector) -> None:
        self.count = forms.shape[1]
        self._forms = forms
        self._rows = forms.reshape(-1, forms.shape[2])

    def at(self, eta: Vector) -> Tension:
        """Tensions at modal coordinates (M,)."""
        low = eta[: self.count]
        slope = self.times(low)
        return Tension(low, 0.5 * (slope @ low), slope)

    def times(self, low: Vector) -> Vector:
        """All forms times coordinates (S,), shape (P, S)."""
        found: Vector = (self._rows @ low).reshape(-1, self.count)
        return found

    def energy(self, eta: Vector) -> float:
        """Energy (J) of the tensions at modal coordinates (M,)."""
        tension = self.at(eta).tension
        return 0.5 * float(tension @ tension)

    def curvature(self, tension: Vector, slope: Vector) -> Vector:
        """Second derivatives (S, S) of the energy where tensions (P,) and their derivatives (P, S) are these."""
        found: Vector = slope.T @ slope + np.tensordot(tension, self._forms, 1)
        return found


class OwnTension(NamedTuple):
    """Tension that bending makes, over a step: the body's forms, what they are at both ends, and the moments (S,)."""

    forms: TensionForms
    start: Tension
    end: Tension
    moment: Vector

    def after(self, eta: Vector, moment: Vector) -> OwnTension:
        """The same with its end at modal coordinates (M,) and with first moments (M,) of their rates."""
        return self._replace(end=self.forms.at(eta), moment=moment[: self.forms.count])

    def _middle(self) -> tuple[Vector, Vector, Vector]:
        """Tensions (P,) at the mean coordinates, the mean of those at both ends, and mean derivatives (P, S)."""
        ends = self.start.tension + self.end.tension
        return (
            0.25 * (ends + self.start.slope @ self.end.low),
            0.5 * ends,
            0.5 * (self.start.slope + self.end.slope),
        )

    def add_forces(self, force: Vector, slope: Vector) -> None:
        """Adds means and slopes of the forces of a step to those on all modes (M,)."""
        tension, mean, rows = self._middle()
        low = slice(self.forms.count)
        first, last = self.start.gradient, self.end.gradient
        force[low] -= (first + 4.0 * (tension @ rows) + last) / 6.0
        force[low] += 0.5 * ((rows @ self.moment) @ rows + mean @ self.forms.times(self.moment))
        slope[low] -= 0.5 * (last - first)

    def tangents(self) -> tuple[Vector, Vector, Vector]:
        """Derivatives (S, S) of means and slopes by the coordinates at the end, and of means by the moments.

        That of the means is near what it is, which is enough for an iteration.
        """
        _, mean, rows = self._middle()
        divided = self.forms.curvature(mean, rows)
        last = self.forms.curvature(self.end.tension, self.end.slope)
        return -divided / 3.0 - last / 6.0, -0.5 * last, 0.5 * divided


def own_tension(forms: TensionForms | None, eta: Vector) -> OwnTension | None:
    """At rest at modal coordinates (M,); None where bending does not stretch."""
    if forms is None:
        return None
    found = forms.at(eta)
    return OwnTension(forms, found, found, np.zeros(forms.count))
