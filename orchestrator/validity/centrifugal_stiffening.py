"""Spinning flexible bodies of first order, which tension does not stiffen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from components.flexible.modal import ModalData

from ..assembly import Assembly
from ..assembly.second_order import FELT, fastest_turn, held_frequency, joint_places, second_order_modes
from ..scene.placed_scene import PlacedScene


def unstiffened_spins(scene: PlacedScene, assembly: Assembly, until: float | None = None) -> Iterator[str]:
    """A sentence for each flexible body with first-order modes that a motion law spins fast.

    until: s; by default the end of the scene.
    """
    yield from unstiffened_rates(
        scene, assembly, dict.fromkeys(assembly.flexible, fastest_turn(scene, until))
    )


def unstiffened_rates(
    scene: PlacedScene, assembly: Assembly, rates: Mapping[str, float], how: str = "up to"
) -> Iterator[str]:
    """A sentence for each flexible body with first-order modes that spins fast.

    rates: of bodies by name, rad/s. how: words for these rates.
    """
    bodies = {body.name: body for body in scene.bodies}
    for part in assembly.parts:
        if part.name not in assembly.flexible:
            continue
        modal, rate = part.structure["modal"], rates.get(part.name, 0.0)
        modes, second = np.size(modal["frequency"]), second_order_modes(part)
        if not rate or second == modes or np.size(modal["tension_forms"]):
            continue
        first = held_frequency(ModalData.from_arrays(modal), joint_places(scene, bodies[part.name]))
        if rate**2 > FELT * first**2:
            yield (
                f"body.{part.name}: it spins at {how} {rate:.3g} rad/s, its first mode clamped at a joint is at "
                f"{first:.3g} rad/s, and tension does not stiffen {modes - second} of its {modes} modes, which are of "
                "first order. Remove second_order_modes, or set it to the number of modes."
            )
