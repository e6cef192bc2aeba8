"""Torque margin of every hinge line over its travel, and proof that the array restarts when stopped midway.

Quasi-static: driving over resisting torques at rest, resistances with uncertainty factors; two rules, limit 2
(`rules`). What other connections do about a line is not counted: cable loops pass torque from line
to line, dampers give none at rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...scene import CheckedScene, SceneError
from ...scene.builder import Scene
from .rules import LIMIT, RULES, Found, margins
from .standard import FACTORS, FactorKind
from .sweep import FrictionKind, driven_lines, sweep
from .undriven import uncounted, without_margin

_BASE, _COLD = "base", "cold"


@dataclass(frozen=True)
class TorqueMargin:
    """Margins of every driven line in every case, and why other lines have none, by case and line."""

    factors: FactorKind
    friction: FrictionKind
    lines: tuple[Found, ...]
    without: Mapping[str, Mapping[str, str]]
    uncounted: Mapping[str, str] = field(default_factory=dict)
    """components that drive and are part of no margin, and why"""

    @property
    def passes(self) -> bool:
        """Whether every line keeps the limit by both rules over its whole travel, in every case."""
        return all(rule.passes for found in self.lines for rule in found.margins)

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "factors": self.factors,
            "friction": self.friction,
            "limit": LIMIT,
            "margins": [row for found in self.lines for row in found.as_dicts()],
            "without_margin": [
                {"case": case, "line": line, "reason": reason}
                for case, reasons in self.without.items()
                for line, reason in reasons.items()
            ],
            "uncounted": dict(self.uncounted),
        }


def margin_cases(scene: Scene, names: Sequence[str] = ()) -> dict[str, CheckedScene]:
    """Scenes by case: the variants named, "base" for none; by default the scene, and its variant "cold" if any.

    SceneError where it runs in phases and none is chosen, whose cases would not be one.
    """
    scene.check_one_run()
    if not names:
        has_cold = _COLD in scene.variants and _COLD not in scene.chosen
        names = (_BASE, _COLD) if has_cold else (_BASE,)
    own = _BASE in scene.variants
    return {
        name: (scene if name == _BASE and not own else scene.with_variants(name)).check() for name in names
    }


def torque_margin(
    cases: Mapping[str, CheckedScene],
    positions: int = 19,
    factors: FactorKind = "theoretical",
    friction: FrictionKind = "sliding",
    extra: Mapping[str, Mapping[str, float]] | None = None,
) -> TorqueMargin:
    """Margins of every driven line of every case; extra: further torques (N.m) by line and ECSS symbol."""
    _refuse_unknown_lines(cases, extra or {})
    found = find_margins(cases, positions, factors, friction, extra)
    without = {case: without_margin(one) for case, one in cases.items()}
    left_out = {name: why for one in cases.values() for name, why in uncounted(one).items()}
    return TorqueMargin(factors, friction, tuple(found), without, left_out)


def _refuse_unknown_lines(cases: Mapping[str, CheckedScene], extra: Mapping[str, object]) -> None:
    for case in cases.values():
        known = [line.name for line in driven_lines(case)]
        problems = [
            f"{case.file}: there is no hinge line {name!r} with a motor; lines are {', '.join(known)}"
            for name in extra
            if name not in known
        ]
        if problems:
            raise SceneError(problems)


def find_margins(
    cases: Mapping[str, CheckedScene],
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
