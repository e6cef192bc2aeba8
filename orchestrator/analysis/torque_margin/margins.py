"""Torque margin of every hinge line over its travel, and proof that the array restarts when stopped midway.

Quasi-static: driving over resisting torques at rest, resistances with uncertainty factors, by the rules of
`rules`. Lines that cable loops or gears couple have their margin together: their torques at one rate
(`GroupTorques`), as an actuator's torque is counted at the shaft where it is required. Dampers give no torque at rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...scene import PlacedScene, SceneError
from ...scene.builder import Scene
from .rules import Found, Rule, Torques, margins
from .standard import FACTORS, GEVS_FACTORS, FactorKind, GevsPhase
from .sweep import FrictionKind, grouped, opened_lines, sweep
from .undriven import uncounted, with_motor, without_margin

_BASE, _COLD = "base", "cold"


@dataclass(frozen=True, repr=False)
class TorqueMargin:
    """Margins of every driven line and of coupled ones together in every case, and why other lines have none."""

    factors: FactorKind
    friction: FrictionKind
    lines: tuple[Found, ...]
    without: Mapping[str, Mapping[str, str]]
    uncounted: Mapping[str, str] = field(default_factory=dict)
    """components that drive and are part of no margin, and why"""
    gevs: GevsPhase | None = None
    """phase of the program by whose factors the GEVS rule counts; None without this rule"""

    @property
    def passes(self) -> bool:
        """Whether all lines, coupled ones together, keep the limit by all rules over their travel in every case."""
        return all(rule.passes for found in self.lines if found.counts for rule in found.margins)

    def __repr__(self) -> str:
        verdict = "passes" if self.passes else "fails"
        return f"<TorqueMargin {verdict}: {', '.join(map(repr, self.lines))}>"

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return {
            "factors": self.factors,
            "friction": self.friction,
            "gevs": self.gevs,
            "margins": [row for found in self.lines for row in found.as_dicts()],
            "without_margin": [
                {"case": case, "line": line, "reason": reason}
                for case, reasons in self.without.items()
                for line, reason in reasons.items()
            ],
            "uncounted": dict(self.uncounted),
        }


def margin_cases(scene: Scene, names: Sequence[str] = ()) -> dict[str, PlacedScene]:
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
    cases: Mapping[str, PlacedScene],
    positions: int = 19,
    factors: FactorKind = "theoretical",
    friction: FrictionKind = "sliding",
    extra: Mapping[str, Mapping[str, float]] | None = None,
    gevs: GevsPhase | None = None,
) -> TorqueMargin:
    """Margins of every driven line of every case; extra: further torques (N.m) by line and ECSS symbol."""
    _refuse_unknown_lines(cases, extra or {})
    found = find_margins(cases, positions, factors, friction, extra, gevs)
    without = {case: without_margin(one) for case, one in cases.items()}
    left_out = {name: why for one in cases.values() for name, why in uncounted(one).items()}
    return TorqueMargin(factors, friction, tuple(found), without, left_out, gevs)


def _refuse_unknown_lines(cases: Mapping[str, PlacedScene], extra: Mapping[str, object]) -> None:
    for case in cases.values():
        known = [line.name for line in opened_lines(case)]
        problems = [
            f"{case.file}: there is no hinge line {name!r} with a motor; lines are {', '.join(known)}"
            for name in extra
            if name not in known
        ]
        if problems:
            raise SceneError(problems)


def find_margins(
    cases: Mapping[str, PlacedScene],
    positions: int,
    factors: FactorKind = "theoretical",
    friction: FrictionKind = "sliding",
    extra: Mapping[str, Mapping[str, float]] | None = None,
    gevs: GevsPhase | None = None,
) -> list[Found]:
    """Margins of every line of every case at equally spaced positions of the travel, its ends included.

    First of the lines with a motor, each alone, then of coupled lines together, whether or not they have one.
    """
    shares = np.linspace(0.0, 1.0, positions).tolist()
    rules: dict[Rule, Mapping[str, float]] = {"sum": FACTORS[factors], "ECSS": FACTORS[factors]}
    if gevs is not None:
        rules["GEVS"] = GEVS_FACTORS[gevs]
    found = []
    for case, scene in cases.items():
        torques = {one.line: one for one in sweep(scene, shares, friction, extra or {})}
        alone, groups = [torques[line.name] for line in with_motor(scene)], grouped(scene, torques)
        coupled = {name for group in groups for name in group.rates}
        everything: list[Torques] = [*alone, *groups]
        for one in everything:
            by_rule = tuple(margins(one, rule, own) for rule, own in rules.items())
            found.append(Found(case, one, by_rule, one.line not in coupled))
    return found
