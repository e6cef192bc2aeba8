"""Torque margin of every hinge line over its travel, and proof that the array restarts when stopped midway.

Quasi-static: driving over resisting torques at rest, resistances with uncertainty factors; two rules, limit 2
(`rules`). What other connections do about a line is not counted: cable loops pass torque from line
to line, dampers give none at rest.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...scene import Scene
from .rules import FACTORS, RULES, FactorKind, Found, margins
from .sweep import FrictionKind, sweep


def find_margins(
    cases: Mapping[str, Scene],
    positions: int,
    factors: FactorKind = "theoretical",
    friction: FrictionKind = "sliding",
    extra: Mapping[str, Mapping[str, float]] | None = None,
) -> list[Found]:
    """Margins of every line of every case at equally spaced positions of the travel, its ends included."""
    shares = np.linspace(0.0, 1.0, positions).tolist()
    return [
        Found(case, torques, tuple(margins(torques, rule, FACTORS[factors]) for rule in RULES))
        for case, scene in cases.items()
        for torques in sweep(scene, shares, friction, extra or {})
    ]
