"""State of an implicit run between two steps, as plain numbers, from which a run continues bit-identically.

It contains nothing that follows from other parts, such as interface Jacobians; a run that makes a snapshot drops these.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

Numbers = dict[str, Any]
"""Values that JSON can contain; it preserves every bit of a floating-point number."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """numbers: of the master. arrays: by name, of the coupling, its steps, and inputs and outputs of participants.

    states: serialised states of the participants, by name.
    """

    numbers: Numbers
    arrays: Mapping[str, np.ndarray[Any, np.dtype[np.float64]]]
    states: Mapping[str, bytes]
