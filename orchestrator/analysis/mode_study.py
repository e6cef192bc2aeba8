"""How many fixed-interface modes a body needs: latch-up against their number, and frequencies of the reduced body.

The study of Bagnoli (2007), section 3.2.2: the same scene with more and more modes, compared with the most; and
Tables 3-2 and 3-3, the free frequencies of the reduced body against those of the full finite-element model.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.catalogue import BODIES, finite_elements
from components.flexible.reduction import fixed_interface_frequencies, free_frequencies

from ..scene.bodies import body_model
from ..scene.body_tables import Body

Vector = NDArray[np.float64]

_LISTED = 8


class Frequencies(NamedTuple):
    """Frequencies (Hz) of one body: clamped and free of the full model, free of the reduced body by modes kept."""

    fixed: Vector
    free: Vector
    reduced: dict[int, Vector]


def frequencies(body: Body, counts: Sequence[int], listed: int = _LISTED) -> Frequencies:
    """The first frequencies of a catalogue body in full and reduced to each number of fixed-interface modes."""
    entry = str(body.catalogue)
    masses = tuple((attached.point, attached.mass) for attached in body.attached_masses)
    model = finite_elements(entry, masses)
    reduced = {}
    for count in counts:
        data = body_model(body.model_copy(update={"fixed_interface_modes": count}), flexible=True)
        reduced[count] = data.frequency[:listed] / (2.0 * np.pi)
    fixed = fixed_interface_frequencies(model, BODIES[entry].attachment_points, listed)
    return Frequencies(fixed / (2.0 * np.pi), free_frequencies(model, listed) / (2.0 * np.pi), reduced)
