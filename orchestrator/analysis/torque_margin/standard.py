"""Factors and symbols of the torque margin in ECSS-E-ST-33-01C, 2009 edition, and in GSFC-STD-7000 (GEVS)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal

FactorKind = Literal["theoretical", "measured"]
GevsPhase = Literal["preliminary", "critical", "test"]

SPRING_ACTUATOR: Final = 0.8
"""Clause 4.7.5.3.2e."""
DYNAMIC: Final = 1.25
"""Factor on the torque for a specified acceleration, T_D."""
FACTORS: Final[Mapping[FactorKind, Mapping[str, float]]] = {
    "theoretical": {"I": 1.1, "S": 1.2, "HM": 1.5, "FR": 3.0, "HY": 3.0, "HA": 3.0, "HD": 3.0},
    "measured": {"I": 1.1, "S": 1.2, "HM": 1.2, "FR": 1.5, "HY": 1.5, "HA": 1.5, "HD": 3.0},
}
"""Table 4-2: inertia, spring, motor magnetic losses, friction, hysteresis, others (harness), adhesion."""
DEMANDS: Final = ("TD", "TL")
"""Torque for a specified acceleration, and specified output torque; no resistances."""
_KNOWN: Final = ("I", "S", *DEMANDS)
"""Torques that are known and quantifiable by GEVS, such as accelerated inertias; all others vary over life."""
_GEVS: Final[Mapping[GevsPhase, tuple[float, float]]] = {
    "preliminary": (2.0, 4.0),
    "critical": (1.5, 3.0),
    "test": (1.5, 2.0),
}
"""FS_k and FS_v of the preliminary and the critical design review, and of the acceptance or qualification test."""
GEVS_FACTORS: Final[Mapping[GevsPhase, Mapping[str, float]]] = {
    phase: {symbol: known if symbol in _KNOWN else variable for symbol in (*FACTORS["theoretical"], *DEMANDS)}
    for phase, (known, variable) in _GEVS.items()
}
"""GSFC-STD-7000, section 2.4.5.3: factor of every torque by its ECSS symbol."""
