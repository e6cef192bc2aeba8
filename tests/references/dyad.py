"""Two links of a folding chain in closed form: rigid, uniform, pinned at base, middle and top, the top on a path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Dyad:
    """A chain whose top is z above its base; mass (kg) and inertia (kg.m2, about the centre) of a link of length L (m).

    Forces are (t, 2): along the folded links, outward from the base joint, and up.
    """

    length: float
    mass: float
    inertia: float
    height: Vector
    rate: Vector
    acceleration: Vector

    @property
    def sine(self) -> Vector:
        """Of the angle of the links."""
        return self.height / (2.0 * self.length)

    @property
    def cosine(self) -> Vector:
        """Of the angle of the links."""
        return np.sqrt(1.0 - self.sine**2)

    @property
    def angle(self) -> Vector:
        """Of the links against the folded position (rad)."""
        return np.arcsin(self.sine)

    @property
    def angular_rate(self) -> Vector:
        """Rate of the angle (rad/s)."""
        return self.rate / (2.0 * self.length * self.cosine)

    @property
    def angular_acceleration(self) -> Vector:
        """Acceleration of the angle (rad/s2)."""
        return (self.acceleration / (2.0 * self.length) + self.sine * self.angular_rate**2) / self.cosine

    @property
    def _accelerations(self) -> tuple[Vector, Vector]:
        """Of the centres of the lower and the upper link."""
        s, c, w, a = self.sine, self.cosine, self.angular_rate, self.angular_acceleration
        lower = 0.5 * self.length * np.stack((-s * a - c * w * w, c * a - s * w * w), 1)
        return lower, lower * (1.0, 3.0)

    @property
    def middle(self) -> Vector:
        """Force on the lower link at the middle: moments of both links about their outer joints."""
        s, c, a = self.sine, self.cosine, self.angular_acceleration
        upper = self._accelerations[1]
        about_base = (self.inertia + 0.25 * self.mass * self.length**2) * a / self.length
        lever = 0.5 * self.mass * self.length * (c * upper[:, 1] + s * upper[:, 0])
        about_top = (self.inertia * a - lever) / self.length
        return np.stack(((about_top - about_base) / (2.0 * s), (about_base + about_top) / (2.0 * c)), 1)

    @property
    def base(self) -> Vector:
        """Force on the lower link at its base joint."""
        return self.mass * self._accelerations[0] - self.middle

    @property
    def top(self) -> Vector:
        """Force on the upper link at its top joint."""
        return self.mass * self._accelerations[1] + self.middle

    @property
    def kinetic_energy(self) -> Vector:
        """Of both links (J)."""
        translation = 0.5 * self.mass * self.length**2 * (1.0 + 4.0 * self.cosine**2)
        return 0.5 * (translation + 2.0 * self.inertia) * self.angular_rate**2
