"""Proof that an array restarts when stopped midway: runs from rest at positions within the travel."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...assembly import Assembly
from ...assembly.assemble import assemble
from ...cosim.settings import Settings
from ...results.key_figures import latch_times
from ...results.result import Result
from ...run.progress import Progress, followed, silent
from ...run.run import run
from ...scene import PlacedScene, SceneError
from ...scene.hinge_line_tables import HingeLine
from ...scene.units import to_si
from .rules import LineTorques, Torques
from .sweep import at_share, driven_lines, grouped, opened_lines, sweep, travel

_MOVED = 1e-2
"""Of the way left: beyond it a line moves, as strands of cable loops give way by a part of it."""
_LATE = 0.95
"""Part of a run after which it is towards its end."""
_SLOW = 0.02
"""Of the way made: a line that turns by less of it from there on has stopped; at a constant rate it makes 0.05."""
_AT_ONCE = 2.0
"""Times its static deflection that a spring gives way under a torque that acts at once."""
_POSITION = re.compile(r"\s*([-+.\deE]+)\s*(%|deg|rad)\s*")


@dataclass(frozen=True)
class Restart:
    """What a line did after a start from rest: angles in rad, rate in rad/s, time in s (None if it did not open).

    moves: it turned further than it gives way while friction sticks. still_opening: it moved towards the end too, and
    had not opened. opens: it latched, or reached its deployed angle where it has no latch. net: what opens it at the
    start, motor, harness and static friction without factors (N.m), with coupled lines together at the rate of the
    first; negative where friction holds it.
    """

    line: str
    start: float
    end: float
    fastest: float
    moves: bool
    still_opening: bool
    opened_at: float | None
    net: float

    @property
    def opens(self) -> bool:
        """Whether the line came to the end of its travel."""
        return self.opened_at is not None


class CaseRestart(NamedTuple):
    """A restart of one case of a scene from a position as it was asked for, its result file, and every line."""

    case: str
    position: str
    path: Path | None
    lines: list[Restart]

    def as_dicts(self) -> list[dict[str, object]]:
        """One plain record per line, for JSON."""
        output = None if self.path is None else str(self.path)
        place = {"case": self.case, "position": self.position, "output": output}
        return [{**place, **asdict(line), "opens": line.opens} for line in self.lines]


def restart_share(scene: PlacedScene, position: str) -> float:
    """Share of the travel (0 to 1) of "50%" or "45 deg", an angle of the first line that has a motor.

    SceneError where it is neither, or does not lie within the travel, or none is left.
    """
    line = driven_lines(scene)[0]
    found = _POSITION.fullmatch(position) if isinstance(position, str) else None
    try:
        if found is None:
            raise ValueError
        value = to_si(f"{found[1]} {found[2]}", "1" if found[2] == "%" else "rad")
    except ValueError:
        sentence = "give a share such as 50% or an angle such as 45deg"
        raise SceneError([f"{scene.file}: {position!r} is no position to restart from; {sentence}"]) from None
    share = value if found[2] == "%" else (value - line.initial_angle) / travel(scene, line)
    if not 0.0 <= share < 1.0:
        low, high = np.rad2deg((line.initial_angle, line.deployed_angle))
        raise SceneError(
            [
                f"{scene.file}: a restart from {position} is not within the travel of {line.name}, "
                f"which begins at {low:g} deg and ends before {high:g} deg"
            ]
        )
    return share


def restart_shares(scene: PlacedScene, positions: Sequence[str]) -> dict[str, float]:
    """Share of the travel by position; SceneError where two of them are the same, whose files would be one."""
    shares: dict[str, float] = {}
    for text in positions:
        share = restart_share(scene, text)
        same = next((other for other, known in shares.items() if _percent(known) == _percent(share)), None)
        if same is not None:
            raise SceneError([f"{scene.file}: the restarts from {same} and {text} are the same; give one"])
        shares[text] = share
    return shares


def _percent(share: float) -> str:
    """How a position is called in the name of a file."""
    return f"{100.0 * share:.4g}"


def restart_cases(
    cases: Mapping[str, PlacedScene],
    shares: Mapping[str, Mapping[str, float]],
    folder: Path | None,
    until: float | None = None,
    progress: Progress = silent,
) -> list[CaseRestart]:
    """Run every case from rest at its positions, see `restart_shares`; results in the folder, if there is one."""
    found = []
    for case, positions in shares.items():
        scene = cases[case]
        for text, share in positions.items():
            path = None if folder is None else folder / f"restart_{case}_{_percent(share)}.h5"
            if folder is not None:
                folder.mkdir(parents=True, exist_ok=True)
            with followed(progress, f"{case} from {text}", until or scene.header.until) as watch:
                found.append(CaseRestart(case, text, path, restart(scene, share, path, until, watch)))
    return found


def restart(
    scene: PlacedScene,
    share: float,
    output: Path | None = None,
    until: float | None = None,
    watch: Callable[[float, float], None] = lambda time, h: None,
) -> list[Restart]:
    """Run the scene, bodies rigid, from rest at a share of the travel; what every line that is to open did."""
    stopped = at_share(scene, share)
    torques = {one.line: one for one in sweep(scene, [share], "static", {})}
    together = {name: group for group in grouped(scene, torques) for name in group.rates}
    assembly = assemble(stopped, rigid={"all"})
    settings = Settings(tolerance=assembly.tolerance, largest_step=assembly.largest_step)
    result = run(assembly, output, settings, until, watch=watch).result
    return [
        _restarted(
            result,
            line,
            _give(assembly, line, torques[line.name]),
            together.get(line.name, torques[line.name]),
        )
        for line in opened_lines(stopped)
    ]


def _give(assembly: Assembly, line: HingeLine, torques: LineTorques) -> float:
    """Angle (rad) by which a line may turn while its friction sticks."""
    hinges = {hinge.name for hinge in line.hinges}
    stiffness = sum(
        float(np.ravel(part.start["presliding_stiffness"])[0])
        for part in assembly.parts
        if part.name in hinges
    )
    return _AT_ONCE * abs(float(torques.friction[0])) / stiffness if stiffness else 0.0


def _restarted(result: Result, line: HingeLine, give: float, torques: Torques) -> Restart:
    angle = result.signal(line.sensor, "angle")
    if line.latch is not None:
        opened = latch_times(result).get(line.name)
    else:
        there = np.flatnonzero(angle >= line.deployed_angle)
        opened = float(result.time[there[0]]) if there.size else None
    turned = float(np.max(angle)) - line.initial_angle
    moves = opened is not None or turned > _MOVED * (line.deployed_angle - line.initial_angle) + give
    late = float(np.ptp(angle[result.time >= _LATE * result.time[-1]]))
    return Restart(
        line=line.name,
        start=line.initial_angle,
        end=float(angle[-1]),
        fastest=float(np.max(result.signal(line.sensor, "angular_rate"))),
        moves=moves,
        still_opening=opened is None and moves and late > _SLOW * turned + give,
        opened_at=opened,
        net=float(torques.net[0]),
    )
