"""Where an implicit run stands between two steps, as plain numbers, to go on from there in every bit as it would have.

What follows from the rest, such as interface Jacobians, is no part: a run that takes a snapshot forgets it as well.
"""

from __future__ import annotations

from collections.abc import Mapping
from ctypes import Array, Structure
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

Numbers = dict[str, Any]
"""What JSON holds; it gives back every bit of a floating-point number."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """numbers: of master and step control. arrays: by name, of solver, rows and participants' inputs and outputs.

    states: of the participants, as they serialise them, by name.
    """

    numbers: Numbers
    arrays: Mapping[str, np.ndarray[Any, np.dtype[np.float64]]]
    states: Mapping[str, bytes]


def plain(value: Any) -> Any:  # noqa: ANN401 - of any type that records are made of
    """Records, tuples and arrays as dictionaries and lists of numbers and texts."""
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {name: plain(one) for name, one in value._asdict().items()}
    if isinstance(value, Structure):
        return {name: plain(getattr(value, name)) for name, *_ in value._fields_}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple | Array):
        return [plain(one) for one in value]
    return value
