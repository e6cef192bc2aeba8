"""A strand or spring that only pulls, with a damper that never pushes and is none where the strand is slack."""

from __future__ import annotations

from .fourth_order_correction import workless_law
from .laws import SlackSpring, mean_force
from .stiff_coordinate import MeanLoad, StepMotion


def tension_at(strand: SlackSpring, damping: float, elongation: float, rate: float) -> float:
    """Tension (N) of an instant."""
    elastic = -strand.value(elongation)
    return max(elastic + damping * rate, 0.0) if elastic > 0.0 else 0.0


def damping_power(strand: SlackSpring, damping: float, elongation: float, rate: float) -> float:
    """Heat (W) of the damper at an instant."""
    return (tension_at(strand, damping, elongation, rate) + strand.value(elongation)) * rate


def mean_tension(
    strand: SlackSpring, damping: float, before: float, after: float, h: float
) -> tuple[float, float]:
    """Mean tension (N) over a step h (s) between two elongations, and the heat (J) of the damper."""
    elastic = mean_force(strand, before, after)
    rate = (after - before) / h
    tension = max(-elastic + damping * strand.taut_share(before, after) * rate, 0.0)
    return tension, (tension + elastic) * (after - before)


def strand_load(strand: SlackSpring, damping: float, motion: StepMotion) -> MeanLoad:
    """Load on the elongation at order 4; damping never turns the mean tension into a push."""
    elastic, change = workless_law(strand, 0.0, motion), motion.end - motion.start
    acting = damping * strand.taut_share(motion.start, motion.end)
    if change < 0.0 and -elastic.force * motion.h < -acting * change:
        acting = max(-elastic.force, 0.0) * motion.h / -change
    return workless_law(strand, acting, motion)
