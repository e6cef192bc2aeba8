"""Spinning flexible bodies of first order, which tension does not stiffen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..assembly import Assembly
from ..scene.bodies import motions
from ..scene.schema import CheckedScene

_SAMPLES = 257
_FELT = 0.1
"""Rate of the spin over the lowest free frequency, from which on frequencies are off by its square or more."""


def unstiffened_spins(scene: CheckedScene, assembly: Assembly, until: float | None = None) -> Iterator[str]:
    """A sentence for each flexible body without second-order modes that a motion law spins fast.

    until: s; by default the end of the scene.
    """
    times = np.linspace(0.0, scene.header.until if until is None else until, _SAMPLES).tolist()
    turns = [turn for _, turn in (motion.laws for motion in motions(scene).values())]
    fastest = max((abs(turn.rate(time)) for turn in turns for time in times), default=0.0)
    yield from unstiffened_rates(scene, assembly, dict.fromkeys(assembly.flexible, fastest))


def unstiffened_rates(
    scene: CheckedScene, assembly: Assembly, rates: Mapping[str, float], how: str = "up to"
) -> Iterator[str]:
    """A sentence for each flexible body without second-order modes that spins fast.

    rates: of bodies by name, rad/s. how: words for these rates.
    """
    first_order = {body.name for body in scene.bodies if not body.second_order_modes}
    for part in assembly.parts:
        if part.name not in assembly.flexible or part.name not in first_order:
            continue
        frequencies, rate = np.asarray(part.structure["modal"]["frequency"]), rates.get(part.name, 0.0)
        if frequencies.size and rate > _FELT * frequencies.min():
            yield (
                f"body.{part.name}: it spins at {how} {rate:.3g} rad/s with a first free mode at "
                f"{frequencies.min():.3g} rad/s, and first-order modes do not stiffen under tension. Set "
                "second_order_modes."
            )
