"""Elements of array variables of FMUs, by names such as "velocity[3]"."""

from __future__ import annotations

import re
from typing import Any

_ELEMENT = re.compile(r"(.+)\[([1-9]\d*)\]")


def element(name: str) -> tuple[str, int] | None:
    """Name of the array and place in it, from 0; None for the name of no element."""
    found = _ELEMENT.fullmatch(name)
    return (found[1], int(found[2]) - 1) if found else None


def length(variable: Any) -> int | None:  # noqa: ANN401 - of FMPy
    """Number of elements of a variable with one dimension that is fixed; None for any other."""
    if len(variable.dimensions or ()) != 1:
        return None
    start = variable.dimensions[0].start
    return int(start) if start else None
