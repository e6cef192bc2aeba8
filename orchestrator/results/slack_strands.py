"""Strands of cables that went slack, and when."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from components.contract.roles import LOAD

from .result import Result
from .round_off import noise_floor


class Slack(NamedTuple):
    """A strand without tension: component and signal, from when to when (s) at the longest."""

    component: str
    strand: str
    start: float
    end: float


def slack_strands(result: Result) -> tuple[Slack, ...]:
    """The longest stretch in which each strand of a cable is slack, of strands that were taut at some time.

    A spring that pushes has negative tensions, and is never slack.
    Between rows a strand is slack from the first row without tension to the last one.
    """
    found = []
    for name, variable in result.in_role(LOAD):
        if not variable.startswith("tension"):
            continue
        tension = result.signal(name, variable)
        slack, pushes = tension <= noise_floor(tension), tension.min() < -noise_floor(tension)
        edges = np.flatnonzero(np.diff(slack, prepend=False, append=False)).reshape(-1, 2)
        if tension.ndim == 1 and edges.size and not slack.all() and not pushes:
            times = result.time[edges - [0, 1]]
            longest = int(np.argmax(times[:, 1] - times[:, 0]))
            found.append(Slack(name, variable, *times[longest].tolist()))
    return tuple(found)
