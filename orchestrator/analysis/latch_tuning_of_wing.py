"""Tuning of a latch spring against the whole wing: the rigid wing gets a mode of the flexible one at its frequency.

Both wings are deployed and latched, in static equilibrium. The mode is the lowest of the rigid wing; in the flexible
one it is the lowest in the same direction of the base, that of its largest effective mass or, where the base is free
and modes have none, that in which the base itself has most kinetic energy. What the line's spring gets is the
compliance that all bodies lack, so springs of other lines should be what they will be.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import asdict, dataclass, replace
from math import log10

import numpy as np
import scipy

from ..assembly.statics.configuration import configuration
from ..records import short_repr
from ..scene import PlacedScene, SceneError
from ..scene.hinge_line_tables import HingeLine
from .latch_tuning import find_line
from .modes import Mode, Modes, find_modes
from .vibration import DIRECTIONS

_SOFTEST, _STIFFEST = 1.0 / 30.0, 1e4
"""Of the stiffness that the scene has, between which the spring is searched; the stiffer one is as good as a lock."""
_COUNT = 12
"""Modes among which one of the direction is looked for."""
_ACCURACY = 1e-9
"""Of the decimal logarithm of the stiffness."""


@short_repr
@dataclass(frozen=True, slots=True)
class WingTuning:
    """A latch spring (N.m/rad) of a line for the wing with all bodies rigid.

    frequency: of the flexible wing's mode, which it meets (Hz); direction: of the base that the mode moves in; present:
    frequency of the rigid wing's mode with the spring that the scene has; check: with the tuned one.
    """

    line: str
    direction: str
    frequency: float
    stiffness: float
    present: float
    check: float

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def tune_wing(
    scene: PlacedScene,
    name: str,
    rigid: Collection[str] = (),
    flexible: Collection[str] = (),
    frequency: float | None = None,
) -> WingTuning:
    """Tune the latch spring of a line to a frequency (Hz), by default that of the flexible wing's mode.

    rigid, flexible: of the wing that is to be met. SceneError where the line has no latch or no spring reaches it.
    """
    line = find_line(scene, name)
    if line.latch is None or line.held:
        raise SceneError([f"{scene.file}: hinge_line.{name}: it has no latch whose spring could be tuned"])
    given = line.latch.stiffness
    first = _modes(_with_spring(scene, line, given), ("all",), ())
    if first.turns:
        raise SceneError(
            [
                f"{scene.file}: on a base that turns modes have no effective mass by which the rigid one could be found"
            ]
        )
    direction = _direction(first, first.listed[0])

    def of_rigid(stiffness: float) -> float:
        return _lowest(_modes(_with_spring(scene, line, stiffness), ("all",), ()), direction, scene)

    wanted = frequency or _lowest(_modes(scene, rigid, flexible), direction, scene)
    low, high = of_rigid(_SOFTEST * given), of_rigid(_STIFFEST * given)
    if not low < wanted < high:
        raise SceneError(
            [
                f"{scene.file}: hinge_line.{name}: with any spring of this line the rigid wing has {low:.4g} to "
                f"{high:.4g} Hz in {DIRECTIONS[direction]}, and {wanted:.4g} Hz are to be met; tune the springs of "
                "other lines as well"
            ]
        )
    exponent = scipy.optimize.brentq(
        lambda e: of_rigid(given * 10.0**e) - wanted, log10(_SOFTEST), log10(_STIFFEST), xtol=_ACCURACY
    )
    stiffness = float(given * 10.0**exponent)
    return WingTuning(
        name, DIRECTIONS[direction], wanted, stiffness, first.frequencies[0].item(), of_rigid(stiffness)
    )


def _with_spring(scene: PlacedScene, line: HingeLine, stiffness: float) -> PlacedScene:
    assert line.latch is not None
    spring = {"kind": "spring", "stiffness": stiffness, "inboard_stiffness": None, "outboard_stiffness": None}
    latch = line.latch.model_copy(update={**spring, "measured": None})
    tuned = line.model_copy(update={"latch": latch})
    return replace(
        scene, hinge_lines=tuple(tuned if one.name == line.name else one for one in scene.hinge_lines)
    )


def _modes(scene: PlacedScene, rigid: Collection[str], flexible: Collection[str]) -> Modes:
    return find_modes(scene, rigid, flexible, configuration(scene, "deployed"), False, _COUNT)


def _direction(modes: Modes, mode: Mode) -> int:
    """Of the base, among `DIRECTIONS`, in which a mode moves most."""
    if modes.base != "free":
        return int(np.argmax(mode.effective_mass_fractions))
    rows = modes.model.base_rows
    motion = modes.shapes.shapes[rows, mode.number - 1]
    return int(np.argmax(motion * (modes.model.mass[np.ix_(rows, rows)] @ motion)))


def _lowest(modes: Modes, direction: int, scene: PlacedScene) -> float:
    """Frequency (Hz) of the lowest mode that moves mostly in a direction of the base."""
    for mode in modes.listed:
        if _direction(modes, mode) == direction:
            return mode.frequency
    raise SceneError(
        [
            f"{scene.file}: none of the first {len(modes.listed)} modes moves mostly in {DIRECTIONS[direction]}; "
            "give a frequency"
        ]
    )
