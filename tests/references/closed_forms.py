"""Closed forms of one-coordinate mechanisms, for scenes that the components are run in."""

from __future__ import annotations

from math import acos, atanh, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector


class Instant(NamedTuple):
    """Time (s) and rate (rad/s) at which an angle is passed."""

    time: float
    rate: float


def spring_driven(inertia: float, stiffness: float, wind_up: float, angle: float) -> Instant:
    """From rest at zero under T = k (wind_up - angle): angle = wind_up (1 - cos w t)."""
    w = sqrt(stiffness / inertia)
    phase = acos(1.0 - angle / wind_up)
    return Instant(phase / w, wind_up * w * sin(phase))


def spring_driven_angle(inertia: float, stiffness: float, wind_up: float, time: float) -> float:
    """Angle (rad) of the same motion at a time."""
    return wind_up * (1.0 - cos(sqrt(stiffness / inertia) * time))


def two_inertia_frequency(stiffness: float, inertia_1: float, inertia_2: float) -> float:
    """Frequency (Hz) of two inertias about one axis with a spring between."""
    return sqrt(stiffness * (1.0 / inertia_1 + 1.0 / inertia_2)) / (2.0 * pi)


def pinned_pair_inertia(
    inertia_1: float, inertia_2: float, mass_2: float, length_1: float, arm_2: float
) -> float:
    """Inertia against the relative rate of two bodies in line, the first pinned and free to turn.

    inertia_1 about the pin, inertia_2 about the joint at `length_1` from it, mass_2 at `arm_2` beyond that.
    """
    m11 = inertia_1 + mass_2 * length_1**2
    m12 = mass_2 * length_1 * arm_2
    return (m11 * inertia_2 - m12**2) / (m11 + inertia_2 + 2.0 * m12)


def coulomb_stop(inertia: float, torque: float, rate: float) -> tuple[float, float]:
    """Time (s) and angle (rad) in which a constant friction torque stops a rotor."""
    return inertia * rate / torque, 0.5 * inertia * rate**2 / torque


def stiction_overrun(inertia: float, torque: float, transition: float) -> float:
    """Further angle (rad) because friction rises as 1.5 r - 0.5 r^3 below the transition rate, r = rate/transition.

    The integral of J w dw / T over that rise, minus the half J w^2 / T of constant friction.
    """
    return inertia * transition**2 / torque * (2.0 / sqrt(3.0) * atanh(1.0 / sqrt(3.0)) - 0.5)


def bouncing(time: Vector, play: float, rate: float, frequency: float) -> Vector:
    """Places (m or rad) of what starts in the middle of a play: straight through it, half a sine in a spring beyond.

    play: either way, m or rad. rate: m/s or rad/s. frequency: on one of the springs, rad/s.
    """
    through, within = play / rate, np.pi / frequency
    ends = np.cumsum([through, within, 2.0 * through, within, through])
    t, deepest = time % ends[-1], rate / frequency
    ways = (
        rate * t,
        play + deepest * np.sin(frequency * (t - ends[0])),
        play - rate * (t - ends[1]),
        -play - deepest * np.sin(frequency * (t - ends[2])),
        -play + rate * (t - ends[3]),
    )
    return np.select([t < end for end in ends], ways, ways[-1])
