"""Mean force of a stiff linear coordinate over a step: passive for any body, damped at any stiffness.

The mean of the elastic force at both ends keeps energy exactly, but a stiff coordinate between bodies that
take held forces then meets a wall: its rate changes sign every step and never dies. Two inertial terms of
the size k h^2 shift that mode by O(h^2) only and damp it like O((w h)^3): a spectral radius of 0.64 in the
limit of infinite stiffness, a damping ratio of 5e-5 at w h = 0.1. With d the increment of the coordinate,

    -0.20 k (d - d_previous)   and   -0.05 k (p - p_previous),   p = 2 d - p_previous.

p is h times the end rate as a held force on a rigid body gives it. Both terms work exactly like the change
of a stored energy, 0.10 k d^2 and 0.025 k p^2, minus a loss, and setting p back to something smaller only
loses. So at a constant step no body, however flexible, gains energy from them. p is set back to the true end
rate, because on a flexible body it would keep a part that changes its sign every step, but never below the line
through the last two mean rates: held forces leave a flexible body's end rate too small by a share that does not
vanish with h, and a slow mode would lose that share of the stored energy in every step. A change of step keeps the
remembered rates, which is smooth where the coordinate moves; there the terms may give back more than they took, by
the order of (w h)^2 of the energy of the coordinate.
"""

from __future__ import annotations

from typing import NamedTuple

from .scheme import OF_INCREMENTS, OF_RATES


class Memory(NamedTuple):
    """What a coordinate remembers of the last step: its mean rate, its end rate p / h, and how rough it went.

    Of order 4, the end rate is the one that the path has, and roughness acts, see `fourth_order_correction`.
    """

    mean_rate: float
    end_rate: float
    roughness: float = 0.0


class StepMotion(NamedTuple):
    """Motion of one coordinate over a step of size h, and what it remembers of the step before.

    moment: of its rate, the integral of P1 s' dt with P1 = 2 t / h - 1; only laws of order 4 take note of it.
    """

    start: float
    end: float
    h: float
    memory: Memory
    moment: float = 0.0

    def without_inertia(self) -> StepMotion:
        """The same without inertial terms: they tame held forces, which those of an end point are not."""
        mean = (self.end - self.start) / self.h
        return self._replace(memory=Memory(mean, mean))


class MeanLoad(NamedTuple):
    """Mean force of a coordinate over a step, its heat, and what the scheme took away (J).

    slope: coefficient of P1 of the force, zero of order 2.
    """

    force: float
    heat: float
    numerical: float
    slope: float = 0.0


def inertial_force(stiffness: float, m: StepMotion) -> float:
    """The two inertial terms."""
    change = m.end - m.start
    from_mean, from_end = change - m.h * m.memory.mean_rate, change - m.h * m.memory.end_rate
    return -stiffness * (OF_INCREMENTS * from_mean + 2.0 * OF_RATES * from_end)


def remembered(m: StepMotion, end_rate: float) -> Memory:
    """Memory after the step; `end_rate` is the true rate at its end."""
    mean = (m.end - m.start) / m.h
    rigid, ahead = 2.0 * mean - m.memory.end_rate, 1.5 * mean - 0.5 * m.memory.mean_rate
    bound = ahead if abs(end_rate) < abs(ahead) else end_rate
    return Memory(mean, bound if abs(bound) < abs(rigid) else rigid)


def bushing_load(stiffness: float, damping: float, m: StepMotion) -> MeanLoad:
    """Mean load of spring, damper and inertial terms of one coordinate."""
    if stiffness == 0.0 and damping == 0.0:
        return MeanLoad(0.0, 0.0, 0.0)
    return damped_load(-0.5 * stiffness * (m.start + m.end), stiffness, damping, m)


def damped_load(elastic: float, stiffness: float, damping: float, m: StepMotion) -> MeanLoad:
    """Mean load with a damper and inertial terms beside the mean elastic force."""
    change = m.end - m.start
    viscous = -damping * change / m.h
    numerical = inertial_force(stiffness, m)
    return MeanLoad(elastic + viscous + numerical, -viscous * change, -numerical * change)
