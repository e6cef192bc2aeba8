"""The torque-free rigid body in closed form, by Jacobi's elliptic functions.

Principal moments I1 < I2 < I3 and twice the energy 2T with the momentum H so that H^2 > 2T I2 (it turns about
the axis of I3): w1 = a1 cn, w2 = a2 sn, w3 = a3 dn of rate (t - t0). See Landau and Lifshitz, Mechanics, 37.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk, ellipkinc

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class FreeRotor:
    """Constants of the motion: amplitudes (3,), rate (rad/s), parameter k^2 and phase of the functions."""

    amplitude: Vector
    rate: float
    parameter: float
    phase: float

    @property
    def period(self) -> float:
        """Time (s) after which the angular velocity returns, in body axes."""
        return 4.0 * float(ellipk(self.parameter)) / self.rate

    def angular_velocity(self, time: float) -> Vector:
        """Angular velocity (3,) in principal axes."""
        sn, cn, dn, _ = ellipj(self.rate * time + self.phase, self.parameter)
        return self.amplitude * np.array((cn, sn, dn))


def free_rotor(inertia: Vector, start: Vector) -> FreeRotor:
    """The motion from the angular velocity `start` (3,), w1 > 0 and w3 > 0 there."""
    i1, i2, i3 = (float(v) for v in inertia)
    twice_energy = float(inertia @ start**2)
    momentum_squared = float((inertia * start) @ (inertia * start))
    if not (i1 < i2 < i3 and momentum_squared > twice_energy * i2 and start[0] > 0.0 < start[2]):
        raise ValueError("needs I1 < I2 < I3, rotation about the third axis, and w1 and w3 positive")
    low, high = momentum_squared - twice_energy * i1, twice_energy * i3 - momentum_squared
    amplitude = np.sqrt((high / (i1 * (i3 - i1)), high / (i2 * (i3 - i2)), low / (i3 * (i3 - i1))))
    # w1' = (I2 - I3)/I1 w2 w3 and w2' = (I3 - I1)/I2 w3 w1 fix the sign: with w1, w3 > 0, w2 grows
    rate = float(np.sqrt((i3 - i2) * low / (i1 * i2 * i3)))
    parameter = (i2 - i1) * high / ((i3 - i2) * low)
    phase = float(ellipkinc(np.arctan2(start[1] / amplitude[1], start[0] / amplitude[0]), parameter))
    return FreeRotor(amplitude, rate, float(parameter), phase)
