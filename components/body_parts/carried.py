"""What a base carries rigidly: part of its body, but no part of what its interface loads act on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any, Self

import numpy as np

from ..contract.component import ComponentError, Vector
from ..contract.frames import skew
from ..flexible.modal import ModalData

_PAIRS = tuple(combinations_with_replacement(range(3), 2))


@dataclass(frozen=True)
class Carried:
    """Mass (kg), centre of mass (3,) from the base's origin (m), inertia (3, 3) about it (kg.m2), axes of the base."""

    mass: float
    center_of_mass: Vector
    inertia: Vector

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Self:
        """From the fields by name."""
        center, inertia = (np.array(given[name], dtype=float) for name in ("center_of_mass", "inertia"))
        return cls(float(given["mass"]), center, inertia.reshape(3, 3))

    def mass_matrix(self, arm: Vector, axes: Vector) -> Vector:
        """Mass (6, 6) for translation of and rotation about a point, in other axes.

        arm: (3,) from the point to the centre of mass, in these. axes: (3, 3) of the base into these.
        """
        reach = skew(arm)
        turning = axes @ self.inertia @ axes.T - self.mass * reach @ reach
        return np.block([[self.mass * np.eye(3), -self.mass * reach], [self.mass * reach, turning]])

    def weight(self, gravity: Vector, reference: Vector) -> Vector:
        """Weight and its moment (6,) about a point of the base, where its axes are those of gravity (3,)."""
        force = self.mass * gravity
        return np.concatenate((force, np.cross(self.center_of_mass - reference, force)))

    def shares(self, whole: ModalData) -> Vector:
        """(6, 12) of what acts on the base alone: times the loads on the whole, then times `products` of its rates.

        The loads (6,) are about the origin. By Newton and Euler for the whole, which tell how this part is accelerated;
        weight accelerates both alike.
        """
        self._check(whole)
        none, unit = np.zeros(6), np.eye(3)
        by_load = [self._rest(load, np.zeros(3), whole) for load in np.eye(6)]
        by_axis = [self._rest(none, axis, whole) for axis in unit]
        by_rates = [
            by_axis[i] if i == k else self._rest(none, unit[i] + unit[k], whole) - by_axis[i] - by_axis[k]
            for i, k in _PAIRS
        ]
        return np.column_stack([*by_load, *by_rates])

    def _check(self, whole: ModalData) -> None:
        if not 0.0 <= self.mass < whole.mass:
            raise ComponentError(
                f"the base carries {self.mass:g} kg of its {whole.mass:g} kg; it must keep a mass of its own"
            )

    def _rest(self, load: Vector, omega: Vector, whole: ModalData) -> Vector:
        """What is left of a load on the whole (6,), which turns at a rate (3,)."""
        force, center = load[:3], whole.center_of_mass
        torque = load[3:] - np.cross(center, force) - np.cross(omega, whole.inertia @ omega)
        turning = np.linalg.solve(whole.inertia, torque)
        arm = self.center_of_mass - center
        own = force / whole.mass + np.cross(turning, arm) + np.cross(omega, np.cross(omega, arm))
        taken = self.mass * own
        moment = self.inertia @ turning + np.cross(omega, self.inertia @ omega)
        return load - np.concatenate((taken, np.cross(self.center_of_mass, taken) + moment))


def products(rate: Vector) -> Vector:
    """Products (6,) of components of a rate (3,): xx, xy, xz, yy, yz, zz."""
    return np.array([rate[i] * rate[k] for i, k in _PAIRS])
