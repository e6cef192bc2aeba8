"""Friction that sticks: an elastic deflection before sliding, whose force never exceeds the friction.

A spring and a damper in series with a Coulomb slider: the contact deflects by z with the motion s of its body until the
force is that of friction, and then slides (an elasto-plastic model without its blend, Dupont, Hayward, Armstrong and
Altpeter 2002; Prandtl's element). Unlike the models of Dahl and LuGre, nothing slides below the friction, so that a
load that swings does not make it drift. With friction F and the rate v constant over a step,

    force = -min(k z + c v, F),   dz = ds until k z = F      (for v > 0),

whose mean over the step is exact, as are spring energy k z^2 / 2 and heat: what the force takes, less what the spring
keeps. Friction that falls lets the spring go down to it, which is heat as well. So none of it can make energy. The mean
force is continuous in the motion, and so is its derivative but where a contact that slides turns around.
"""

from __future__ import annotations

from typing import NamedTuple


class Presliding(NamedTuple):
    """Force against the motion (N, N.m), its heat (J over a step, W of an instant), deflection (m, rad)."""

    force: float
    heat: float
    deflection: float


def within(value: float, limit: float) -> float:
    """The value, at most the limit in size."""
    return max(-limit, min(limit, value))


def step_force(
    stiffness: float, damping: float, friction: float, deflection: float, change: float, h: float
) -> Presliding:
    """Mean force over a step of size h, with the deflection at its end. stiffness: above 0; friction: not negative."""
    limit = friction / stiffness
    side, way = (1.0, change) if change >= 0.0 else (-1.0, -change)
    begin = side * within(deflection, limit)
    let_go = 0.5 * stiffness * (deflection * deflection - begin * begin)
    viscous = damping * way / h
    sticking = (friction - viscous) / stiffness - begin
    if way <= sticking:
        force = stiffness * (begin + 0.5 * way) + viscous
        return Presliding(-side * force, viscous * way + let_go, side * (begin + way))
    force = friction
    if sticking > 0.0:
        force -= 0.5 * stiffness * sticking * (sticking / way)
    end = min(begin + way, limit)
    kept = 0.5 * stiffness * (end - begin) * (end + begin)
    return Presliding(-side * force, force * way - kept + let_go, side * end)


def instant_force(
    stiffness: float, damping: float, friction: float, deflection: float, rate: float
) -> Presliding:
    """Force of one instant; heat as power (W)."""
    held = within(deflection, friction / stiffness)
    force = -within(stiffness * held + damping * rate, friction)
    slides = held * rate > 0.0 and stiffness * abs(held) >= friction
    stored = 0.0 if slides else stiffness * held * rate
    return Presliding(force, -force * rate - stored, held)
