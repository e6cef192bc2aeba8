"""Spacecraft that rotate by more than a full turn, which a rotation vector cannot represent."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from components.contract.roles import ATTITUDE

from .result import Result


def turned_over(result: Result) -> Iterator[str]:
    """A sentence for each spacecraft whose attitude begins anew in a run, from a full turn one way to one the other."""
    for name, variable in result.in_role(ATTITUDE):
        if result.unit(name, variable) != "rad":
            continue
        jumps = np.abs(np.diff(result.signal(name, variable), axis=0)).max(axis=1, initial=0.0) > np.pi
        if jumps.any():
            yield (
                f"{name} turns by more than a full turn: at {result.time[int(np.argmax(jumps)) + 1]:.4g} s its "
                "attitude, a rotation vector, jumps. Use frame_orientation, which is continuous."
            )
