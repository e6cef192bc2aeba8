"""Force of a coordinate that is linear in time over a step: of order 4, with the work of its potential at any step.

Over a step of size h the force is u0 + u1 P1, P1 = 2 t / h - 1. What a connection knows of the motion s(t) are both
ends and the first moment m of its rate, the integral of P1 s' dt = s1 + s0 - 2 mean(s). With D the discrete gradient
of the potential V, D (s1 - s0) = V1 - V0, and any tangent k of V',

    u0 = -D + k m / 2,    u1 = -k (s1 - s0) / 2:

the pair does no work, (k m / 2) (s1 - s0) + u1 m = 0, so the force does that of the potential exactly. With k the
divided difference of V' the mean of V' is that along the curved path, and u1 its first moment, to third order in h.
A damper c adds -c (s1 - s0) / h and -3 c m / h, whose heat is never negative.

No step size is too long for the energy, but a coordinate that a step does not resolve would ring for ever. Numerical
damping of 0.1 k h r takes that ringing, by its first moment alone: u1 falls by 0.3 k r m. The mean rate, where a slow
motion beside the ringing is, stays free. The roughness r of a motion, from 0 to 1, compares the rate with which a step
begins, as its path says, with the one with which the step before ended:

    a = (s1 - s0 - 3 m) / h,  b = (s1 - s0 + 3 m) / h,  sqrt(q) = |a - b_before| / (|a| + |b_before| + |b|),
    r = (3 r_before + q) / 4.

It acts in the next step, so a step's law is the same in all its iterations, and nearly that of the step before, whose
stiffness iterations start from. Where steps resolve the motion, r goes
with h^6, with h^4 where a coordinate comes to rest or the step changes, and what the damping takes is beyond order 4.
Where they do not, r is near one half: beside an inertia M that the spring k holds, the deflection falls by a factor of
0.54 a step where k h^2 / M is large; what is left then, a motion that goes out and comes back within each step, fades
by a share of 250 M / (k h^2) only.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from .laws import Law, mean_force
from .scheme import LEAST_RATE, NUMERICAL_DAMPING, ROUGHNESS_SHARE
from .stiff_coordinate import MeanLoad, Memory, StepMotion, bushing_load, remembered


def workless_load(
    elastic: float, tangent: float, damping: float, m: StepMotion, roughness: float = 0.0
) -> MeanLoad:
    """Load of a discrete gradient `elastic` (N, N.m), a tangent of its law and a damper over a step."""
    change = m.end - m.start
    numerical = NUMERICAL_DAMPING * max(tangent, 0.0) * m.h * roughness
    mean, slope = change / m.h, 3.0 * m.moment / m.h
    square = mean * change + slope * m.moment
    return MeanLoad(
        elastic + 0.5 * tangent * m.moment - damping * mean,
        damping * square,
        numerical * slope * m.moment,
        -0.5 * tangent * change - (damping + numerical) * slope,
    )


def workless_spring(stiffness: float, damping: float, m: StepMotion) -> MeanLoad:
    """Load of a linear spring and a damper, with numerical damping."""
    if stiffness == 0.0 and damping == 0.0:
        return MeanLoad(0.0, 0.0, 0.0)
    elastic = -0.5 * stiffness * (m.start + m.end)
    return workless_load(elastic, stiffness, damping, m, m.memory.roughness)


def stiff_load(stiffness: float, damping: float, m: StepMotion, *, is_paired: bool) -> MeanLoad:
    """Load of a linear spring and a damper of either order."""
    if is_paired:
        return workless_spring(stiffness, damping, m)
    return bushing_load(stiffness, damping, m)


def workless_law(law: Law, damping: float, m: StepMotion, roughness: float = 0.0) -> MeanLoad:
    """Load of any law and a damper."""
    return workless_load(mean_force(law, m.start, m.end), law.tangent(m.start, m.end), damping, m, roughness)


def gauss_rates(change: float, moment: float, h: float) -> tuple[float, float]:
    """A rate that is linear in time at both points of Gauss' rule."""
    mean, bend = change / h, sqrt(3.0) * moment / h
    return mean - bend, mean + bend


def viscous_load(rates: tuple[float, float], forces: tuple[float, float], h: float) -> MeanLoad:
    """Load of a law of the rate that only brakes, from its forces at `gauss_rates`.

    Gauss' rule with two points is of order 4; the heat is a sum of the law's own at both, and never negative.
    """
    (before, after), (rate, later) = forces, rates
    heat = -0.5 * h * (before * rate + after * later)
    return MeanLoad(0.5 * (before + after), heat, 0.0, 0.5 * sqrt(3.0) * (after - before))


def remembered_path(m: StepMotion) -> Memory:
    """Memory after a step of order 4."""
    change, bend = m.end - m.start, 3.0 * m.moment
    begin, end, before = (change - bend) / m.h, (change + bend) / m.h, m.memory.end_rate
    jump = (begin - before) / (abs(begin) + abs(end) + abs(before) + LEAST_RATE)
    known = m.memory.roughness
    return Memory(change / m.h, end, known + ROUGHNESS_SHARE * (jump * jump - known))


def memories_after(
    motions: Sequence[StepMotion], rates: Sequence[float], *, is_paired: bool, is_impulse: bool
) -> tuple[Memory, ...]:
    """Memories after a step of either order, to these rates; after an impulse only the rates of its end are known."""
    if is_impulse:
        return tuple(Memory(rate, rate) for rate in rates)
    if is_paired:
        return tuple(remembered_path(m) for m in motions)
    return tuple(remembered(m, rate) for m, rate in zip(motions, rates, strict=True))
