"""Mean force of a stiff linear coordinate over a step: passive, second order, and damped at any stiffness.

The mean of the elastic force at both ends keeps energy exactly, but a stiff coordinate between bodies that
take held forces then meets a wall: its rate changes sign every step and never dies. Two inertial terms of
the size k h^2, one on the change of the end rates, one on the change of the mean rates, shift that mode by
O(h^2) only and damp it like O((w h)^3): a spectral radius of 0.64 in the limit of infinite stiffness, a
damping ratio of 5e-5 at w h = 0.1. They store energy like masses, and what they take out they turn to heat.
"""

from __future__ import annotations

from typing import NamedTuple

_WEIGHT_OF_RATES = 0.05
_WEIGHT_OF_MEANS = 0.20


class StepMotion(NamedTuple):
    """Motion of one coordinate over a step, and the mean rate of the step before."""

    start: float
    end: float
    start_rate: float
    end_rate: float
    previous_mean: float
    h: float


def inertial_force(stiffness: float, m: StepMotion) -> float:
    """The two inertial terms, -k h^2 (0.05 a1 + 0.20 a2), a1 from end rates and a2 from mean rates.

    Both accelerations divide by h alone, so that the stiffness of a step depends on nothing but its size.
    """
    change_of_mean = (m.end - m.start) / m.h - m.previous_mean
    change_of_rate = m.end_rate - m.start_rate
    return -stiffness * m.h * (_WEIGHT_OF_RATES * change_of_rate + _WEIGHT_OF_MEANS * change_of_mean)


def bushing_force(stiffness: float, damping: float, m: StepMotion, end_weight: float) -> tuple[float, float]:
    """Mean force of spring, damper and inertial terms of one coordinate, and the energy turned to heat.

    end_weight above one half (static solutions) weights the end value instead of adding inertial terms.
    """
    if stiffness == 0.0 and damping == 0.0:
        return 0.0, 0.0
    change = m.end - m.start
    extra = -damping * change / m.h
    if end_weight == 0.5:
        extra += inertial_force(stiffness, m)
    else:
        extra -= stiffness * (end_weight - 0.5) * change
    return -0.5 * stiffness * (m.start + m.end) + extra, -extra * change
