"""Torque margin by three rules: driving over factored resisting torques, ECSS-E-ST-33-01C and GEVS.

Sum rule (Bagnoli 2007, equation 2.1): TM = sum D / sum k R >= 2, k the uncertainty factor of each resistance.
ECSS rule (2009 edition, clause 4.7.5.3.1): 0.8 T >= T_min = 2 sum k R + 1.25 T_D + T_L for a spring actuator, so
the margin that is held against the same limit is (0.8 T - 1.25 T_D - T_L) / sum k R.
GEVS rule (GSFC-STD-7000, section 2.4.5.3): TM = T_avail / (FS_k sum T_known + FS_v sum T_variable) - 1 > 0, where
T_D and T_L are known torques, and the factors follow from the phase of the program.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from components.contract.component import Vector

from ...results.round_off import noise_floor
from .standard import DEMANDS, DYNAMIC, SPRING_ACTUATOR

Rule = Literal["sum", "ECSS", "GEVS"]

RULE_TEXTS: Final[Mapping[Rule, str]] = {
    "sum": "driving torque over the sum of the resisting torques times their uncertainty factors",
    "ECSS": "ECSS-E-ST-33-01C, 4.7.5.3: 0.8 of the driving torque less 1.25 TD and TL over the same sum",
    "GEVS": "GSFC-STD-7000, 2.4.5.3: driving torque over known and variable torques times their factors, less 1",
}
"""What each rule sets against the limit, for people."""
LIMITS: Final[Mapping[Rule, float]] = {"sum": 2.0, "ECSS": 2.0, "GEVS": 0.0}
"""What a margin must reach; that of GEVS must exceed it."""
_SAGGING = 1e-6


@dataclass(frozen=True)
class LineTorques:
    """Torques (N.m) of a hinge line at angles (rad) of its travel, shape (N,); positive opening.

    friction: against opening, so never positive. extra: further torques of the line by ECSS symbol, constant.
    """

    line: str
    angle: Vector
    motor: Vector
    harness: Vector
    friction: Vector
    extra: Mapping[str, float]

    @property
    def rates(self) -> dict[str, float]:
        """Rate of the line over itself, beside those of `GroupTorques`."""
        return {self.line: 1.0}

    @property
    def net(self) -> Vector:
        """What opens the line from rest, without factors and extra torques; negative where friction holds it."""
        return self.motor + self.harness + self.friction

    @property
    def driving(self) -> Vector:
        """The motorisation spring where it opens; a harness is no motorisation (clause 4.7.5.3.2g)."""
        return np.maximum(self.motor, 0.0)

    def resisting(self) -> dict[str, Vector]:
        """Magnitudes of all resistances by ECSS symbol."""
        found = {
            symbol: np.full(self.angle.size, self.extra.get(symbol, 0.0))
            for symbol in ("I", "HM", "HY", "HD")
        }
        found["S"] = np.maximum(-self.motor, 0.0) + self.extra.get("S", 0.0)
        found["FR"] = np.maximum(-self.friction, 0.0) + self.extra.get("FR", 0.0)
        found["HA"] = np.maximum(-self.harness, 0.0) + self.extra.get("HA", 0.0)
        return found

    def at_rate(self, rate: float) -> LineTorques:
        """The torques at the rate of another line, over which this one's is `rate`, by their power."""
        extra = {symbol: abs(rate) * torque for symbol, torque in self.extra.items()}
        return replace(
            self,
            motor=rate * self.motor,
            harness=rate * self.harness,
            friction=abs(rate) * self.friction,
            extra=extra,
        )


@dataclass(frozen=True)
class GroupTorques:
    """Torques (N.m) of coupled lines together, at the rate of the first: what each has, at that rate, added up.

    angle: that of the first. A harness counts where it resists, line by line, as no harness is a motorisation.
    """

    lines: tuple[LineTorques, ...]
    rates: Mapping[str, float]
    """of every line, over that of the first"""

    @property
    def line(self) -> str:
        """Names of all lines."""
        return "+".join(self.rates)

    @property
    def angle(self) -> Vector:
        """Angles (rad) of the first line."""
        return self.lines[0].angle

    @property
    def motor(self) -> Vector:
        """Torque of the motors."""
        return _summed([line.motor for line in self._at_one_rate])

    @property
    def harness(self) -> Vector:
        """Torque of the harnesses."""
        return _summed([line.harness for line in self._at_one_rate])

    @property
    def friction(self) -> Vector:
        """Torque of the frictions, never positive."""
        return _summed([line.friction for line in self._at_one_rate])

    @property
    def extra(self) -> dict[str, float]:
        """Further torques by ECSS symbol."""
        lines = self._at_one_rate
        return {symbol: sum(line.extra.get(symbol, 0.0) for line in lines) for symbol in DEMANDS}

    @property
    def net(self) -> Vector:
        """What opens the lines from rest, without factors and extra torques; negative where friction holds them."""
        return _summed([line.net for line in self._at_one_rate])

    @property
    def driving(self) -> Vector:
        """The motors that open."""
        return _summed([line.driving for line in self._at_one_rate])

    def resisting(self) -> dict[str, Vector]:
        """Magnitudes of all resistances by ECSS symbol."""
        found = [line.resisting() for line in self._at_one_rate]
        return {symbol: _summed([one[symbol] for one in found]) for symbol in found[0]}

    @property
    def _at_one_rate(self) -> list[LineTorques]:
        return [line.at_rate(self.rates[line.line]) for line in self.lines]


Torques = LineTorques | GroupTorques


def _summed(torques: Sequence[Vector]) -> Vector:
    total: Vector = np.sum(torques, axis=0)
    return total


@dataclass(frozen=True)
class Margins:
    """One rule over the travel of a line, shape (N,): what is available, what resists, what the rule requires.

    available: N.m, after its factor and the demands T_D, T_L. resisting: N.m, with uncertainty factors; by GEVS with
    these demands.
    required: torque that the spring must have, unfactored, N.m. margin: infinite where nothing but round-off of
    the driving torque resists, minus infinity if then the demands exceed what drives.
    """

    rule: Rule
    available: Vector
    resisting: Vector
    required: Vector
    margin: Vector

    @property
    def worst(self) -> int:
        """Index of the smallest margin."""
        return int(np.argmin(self.margin))

    @property
    def passes(self) -> bool:
        """Whether the limit is kept over the whole travel, as far as held lines, which sag a little, can tell."""
        margin, limit = self.margin[self.worst], LIMITS[self.rule]
        return bool(margin >= limit * (1.0 - _SAGGING) and margin > 0.0)


def margins(torques: Torques, rule: Rule, factors: Mapping[str, float]) -> Margins:
    """Margins over the travel by one rule, with its factors by ECSS symbol."""
    resisting = np.zeros(torques.angle.size)
    for symbol, torque in torques.resisting().items():
        resisting += factors[symbol] * torque
    share, demand, whole = 1.0, 0.0, 0.0
    demands = {symbol: torques.extra.get(symbol, 0.0) for symbol in DEMANDS}
    if rule == "ECSS":
        share, demand = SPRING_ACTUATOR, DYNAMIC * demands["TD"] + demands["TL"]
    elif rule == "GEVS":
        resisting += sum(factors[symbol] * torque for symbol, torque in demands.items())
        whole = 1.0
    available = share * torques.driving - demand
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = available / resisting - whole
    nothing_resists = np.where(available >= 0.0, np.inf, -np.inf)
    margin = np.where(resisting > noise_floor(torques.driving.tolist()), ratio, nothing_resists)
    required = ((LIMITS[rule] + whole) * resisting + demand) / share
    return Margins(rule, available, resisting, required, margin)


@dataclass(frozen=True, repr=False)
class Found:
    """The margins of a line, or of coupled lines together, in one case, by rule.

    counts: whether the verdict follows from it; not from a line alone that others are coupled to.
    """

    case: str
    torques: Torques
    margins: tuple[Margins, ...]
    counts: bool = True

    @property
    def line(self) -> str:
        """Name of the line, or of all of them."""
        return self.torques.line

    def __repr__(self) -> str:
        rules = ", ".join(f"{one.rule} {one.margin[one.worst]:.3g}" for one in self.margins)
        return f"<{self.line}, {self.case}: smallest margins {rules}>"

    def as_dicts(self) -> Iterator[dict[str, object]]:
        """One plain record per rule, at the worst angle; None for a margin without bound."""
        for found in self.margins:
            k = found.worst
            margin = float(found.margin[k])
            yield {
                "line": self.line,
                "rates": dict(self.torques.rates),
                "counts": self.counts,
                "case": self.case,
                "rule": found.rule,
                "limit": LIMITS[found.rule],
                "margin": margin if np.isfinite(margin) else None,
                "angle": float(self.torques.angle[k]),
                "motor_torque": float(self.torques.motor[k]),
                "harness_torque": float(self.torques.harness[k]),
                "friction_torque": float(self.torques.friction[k]),
                "net_torque": float(self.torques.net[k]),
                "available": float(found.available[k]),
                "resisting": float(found.resisting[k]),
                "required": float(found.required[k]),
                "passes": found.passes,
            }
