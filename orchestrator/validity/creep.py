"""Trolleys that creep although friction should hold them, because the friction of their rail is smooth at rest."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from components.rail import Rail

from ..assembly import Assembly, Part
from ..results.result import Result

_LATE = 0.9
"""Of the run, from where on it is looked at."""
_STEADY = 0.05
"""Relative change of a speed up to which it is one at which friction is in balance with what pulls."""
_FELT = 0.01
"""Of the speed of full friction; below, what creeps stands for people."""


def creep_warnings(assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for each rail whose trolley slides steadily at the end, below the speed of full friction."""
    late = result.time >= _LATE * result.time[-1]
    for rail in (part for part in assembly.parts if part.kind == Rail.kind):
        smooth = _start(rail, "friction_force") > 0.0 and _start(rail, "breakaway_deflection") == 0.0
        if not smooth or not result.has(rail.name, "sliding_speed") or late.sum() < 2:
            continue
        full = _start(rail, "stiction_velocity")
        speed = result.signal(rail.name, "sliding_speed")[late]
        if _FELT * full < speed.min() and speed.max() < min(full, (1.0 + _STEADY) * speed.min()):
            yield (
                f"{rail.name}: its trolley creeps at {1e3 * speed[-1]:.3g} mm/s at the end, because friction is "
                f"below its full force at speeds below stiction_velocity ({1e3 * full:g} mm/s). Set "
                "breakaway_deflection, or a smaller stiction_velocity."
            )


def _start(rail: Part, name: str) -> float:
    """A parameter's start value, as it is declared where none is given."""
    layout = Rail().parameter_layout
    return float(np.ravel(rail.start.get(name, layout.start_values()[layout[name]]))[0])
