"""Where an implicit run stands between two steps, as plain numbers, to go on from there in every bit as it would have.

What follows from the rest, such as interface Jacobians, is no part: a run that takes a snapshot forgets it as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

Numbers = dict[str, Any]
"""What JSON holds; it gives back every bit of a floating-point number."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """numbers: of the master. arrays: by name, of the coupling, its steps, and participants' inputs and outputs.

    states: of the participants, as they serialise them, by name.
    """

    numbers: Numbers
    arrays: Mapping[str, np.ndarray[Any, np.dtype[np.float64]]]
    states: Mapping[str, bytes]
