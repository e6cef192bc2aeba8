"""Static equilibrium of a scene and its loads, and quasi-static sweeps over angles of hinge lines.

Newton's method on exact tangents, without friction. Held lines keep their angle by a stiff spring, whose torque
is what a drive or a hold-down would have to give.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, pi
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.contract.frames import exponential, multiply, rotate
from components.contract.roles import HOLD
from components.hinge import Hinge

from ..assembly.statics.configuration import Configuration, free_lines, hinges_of, lines_named, placed
from ..assembly.statics.equilibrium_search import settle
from ..assembly.statics.mechanism import Mechanism
from ..records import short_repr
from ..scene import PlacedScene, SceneError
from ..scene.builder import Names
from ..scene.units import degrees_text

_LARGEST_STEP = pi / 36.0
"""rad that a swept line turns between two equilibria"""
_SMALLEST_STEP = _LARGEST_STEP / 100.0
"""rad; a cable that goes slack needs smaller steps, but what fails at these has no equilibrium"""
_LOAD_UNITS = ("N", "N.m")


class Sweep(NamedTuple):
    """A line that is turned from one angle to another (rad)."""

    line: str
    start: float
    end: float


@short_repr
@dataclass(frozen=True, slots=True)
class Equilibrium:
    """One equilibrium: angles (rad) and holding torques (N.m, opening) of lines, loads of connections, base load."""

    angles: Mapping[str, float]
    holding_torques: Mapping[str, float]
    loads: Mapping[str, Mapping[str, tuple[float, str]]]
    """value and unit by connection and name"""
    base_load: tuple[float, ...]
    """force (N) and torque (N.m) of the structure on the base about its reference point, world axes"""
    reach: float
    """m, largest distance between ports and centres of mass"""

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        loads = {
            connection: {
                f"{name}_{'nm' if unit == 'N.m' else 'n'}": value for name, (value, unit) in found.items()
            }
            for connection, found in self.loads.items()
        }
        return {
            "angles_rad": dict(self.angles),
            "holding_torques_nm": dict(self.holding_torques),
            "loads": loads,
            "base_force_n": list(self.base_load[:3]),
            "base_torque_nm": list(self.base_load[3:]),
        }


def equilibrium(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    held: Collection[str],
    adjusted: bool = False,
    swept: Collection[str] = (),
) -> tuple[Mechanism, Equilibrium]:
    """The equilibrium in a configuration with the named lines held; SceneError where there is none.

    adjusted: cable loops have exactly their preload, as when a run begins with static equilibrium. swept: those of
    the held lines that a sweep holds, which the advice of an error leaves out.
    """
    advice = _advice(scene, target, held, swept)
    # as in a run, joints carry no torque about their lines, unless nothing else keeps them in place
    for joints_held in (False, True) if adjusted else (True,):
        mechanism = placed(scene, rigid, flexible, target)
        mechanism.command(HOLD.name, 1.0, hinges_of(scene, held))
        if adjusted:
            mechanism.command(HOLD.name, 1.0, _besides_lines(scene, mechanism, joints=joints_held))
        try:
            settle(mechanism, advice)
        except SceneError:
            if joints_held:
                raise
        else:
            break
    return mechanism, _found(scene, mechanism, held)


def _besides_lines(scene: PlacedScene, mechanism: Mechanism, *, joints: bool) -> set[str]:
    """Connections that are no hinges of lines; joints: those of a preset among them."""
    lines = hinges_of(scene, [line.name for line in scene.hinge_lines])
    return {
        name
        for name, one in mechanism.connections.items()
        if name not in lines and (joints or one.component.kind != Hinge.kind)
    }


def _advice(scene: PlacedScene, target: Configuration, held: Collection[str], swept: Collection[str]) -> str:
    """What to do where there is no equilibrium."""
    free = free_lines(scene, target, held)
    if not scene.hinge_lines:
        return (
            "it has no hinge lines to turn or hold, so what moves needs springs, or something that holds it"
        )
    if not free:
        loops = " that stretch no cable loop" if scene.loops else ""
        return f"its hinge lines are all held or latched, so choose other angles or sweeps{loops}"
    kept = ",".join([*(name for name in held if name not in swept), *free])
    return f"nothing holds {', '.join(free)}; hold {'it' if len(free) == 1 else 'them'} as well, hold: {kept}"


def lines_held(
    scene: PlacedScene, target: Configuration, hold: Names | None, sweeps: Collection[Sweep]
) -> list[str]:
    """Lines to hold: the named ones, "all" or "none"; SceneError where that cannot be.

    By default all that are not latched, beside a sweep none. Swept lines are no part of them.
    """
    swept = lines_named(scene, [sweep.line for sweep in sweeps])
    default = () if sweeps else free_lines(scene, target)
    held = [name for name in lines_named(scene, default if hold is None else hold) if name not in swept]
    both = sorted({*swept, *held} & set(target.latched))
    if both:
        raise SceneError([f"{scene.file}: {', '.join(both)}: a line is latched, or held or swept, not both"])
    return held


def quasi_static(
    scene: PlacedScene,
    rigid: Collection[str],
    flexible: Collection[str],
    target: Configuration,
    held: Collection[str],
    sweeps: Collection[Sweep],
    steps: int,
) -> list[Equilibrium]:
    """Equilibria at `steps` + 1 angles of the swept lines, which turn together; other lines follow or are held."""
    angles = {**target.angles, **{sweep.line: sweep.start for sweep in sweeps}}
    target = Configuration(angles, target.latched)
    kept = (*held, *(sweep.line for sweep in sweeps))
    names = [sweep.line for sweep in sweeps]
    mechanism, first = equilibrium(scene, rigid, flexible, target, kept, swept=names)
    advice = _advice(scene, target, kept, names)
    size = max(abs(sweep.end - sweep.start) for sweep in sweeps)
    parts = ceil(size / steps / _LARGEST_STEP)
    shares = np.linspace(0.0, 1.0, steps * parts + 1).tolist()
    found = [first]
    for k, (start, end) in enumerate(pairwise(shares), 1):
        _follow(scene, mechanism, sweeps, (start, end), size, advice)
        if k % parts == 0:
            found.append(_found(scene, mechanism, kept))
    return found


def _follow(
    scene: PlacedScene,
    mechanism: Mechanism,
    sweeps: Collection[Sweep],
    way: tuple[float, float],
    size: float,
    advice: str,
) -> None:
    """Turn the swept lines from one share of their sweeps to another and settle; in halves where that fails.

    size: largest angle (rad) of the whole sweep. SceneError with the angles where even small steps fail.
    """
    start, end = way
    before = mechanism.pose()
    try:
        for sweep in sweeps:
            _turn(scene, mechanism, sweep.line, (end - start) * (sweep.end - sweep.start))
        settle(mechanism, advice)
        return
    except SceneError as error:
        if (end - start) * size < _SMALLEST_STEP:
            raise SceneError([f"at {_place(sweeps, end)}: {problem}" for problem in error.problems]) from None
    mechanism.come_back(before)
    middle = 0.5 * (start + end)
    for half in ((start, middle), (middle, end)):
        _follow(scene, mechanism, sweeps, half, size, advice)


def _place(sweeps: Collection[Sweep], share: float) -> str:
    """Angles of the swept lines at a share of their sweeps."""
    angles = [degrees_text(sweep.start + share * (sweep.end - sweep.start), 2) for sweep in sweeps]
    return ", ".join(f"{sweep.line} = {angle} deg" for sweep, angle in zip(sweeps, angles, strict=True))


def _turn(scene: PlacedScene, mechanism: Mechanism, name: str, angle: float) -> None:
    """Turn everything outboard of a line about it, and hold its hinges there; a drive commands its new angle."""
    drives = [connection for connection in mechanism.connections.values() if connection.commands_angle]
    before = [drive.observe()["angle"] for drive in drives]
    line = next(line for line in scene.hinge_lines if line.name == name)
    motion = mechanism.connections[line.hinges[0].name].motions[0]
    w, x, y, z = motion[3:7].tolist()
    axis = rotate((w, x, y, z), line.axis)
    turn = exponential((angle * axis[0], angle * axis[1], angle * axis[2]))
    for body in _outboard(scene, name):
        moved = mechanism.bodies[body]
        moved.position = motion[:3] + np.array(rotate(turn, tuple((moved.position - motion[:3]).tolist())))
        moved.orientation = multiply(turn, moved.orientation)
    for hinge in line.hinges:
        connection = mechanism.connections[hinge.name]
        state = Hinge.states.read(connection.state)
        connection.state = Hinge.states.write(state._replace(hold_angle=state.hold_angle + angle))
    mechanism.follow()
    for drive, angle_before in zip(drives, before, strict=True):
        for end in ("start_angle", "end_angle"):
            drive.set_parameter(end, drive.parameter(end) + drive.observe()["angle"] - angle_before)


def _outboard(scene: PlacedScene, name: str) -> set[str]:
    """Bodies, or pieces of several, that a line carries."""
    roots = scene.group_roots
    lines = [line for line in scene.hinge_lines if not line.held]
    found = {roots[line.outboard] for line in lines if line.name == name}
    while more := {roots[k.outboard] for k in lines if roots[k.inboard] in found} - found:
        found |= more
    return found


def _found(scene: PlacedScene, mechanism: Mechanism, held: Collection[str]) -> Equilibrium:
    observed = {name: connection.observe() for name, connection in mechanism.connections.items()}
    lines = {line.name: line for line in scene.hinge_lines if not line.held}
    return Equilibrium(
        angles={name: observed[line.sensor]["angle"] for name, line in lines.items()},
        holding_torques={
            name: sum(_holding_torque(mechanism, hinge.name) for hinge in lines[name].hinges) for name in held
        },
        loads={name: _loads(mechanism, name, values) for name, values in observed.items()},
        base_load=tuple(_base_load(mechanism).tolist()),
        reach=_reach(mechanism),
    )


def _reach(mechanism: Mechanism) -> float:
    """Largest distance (m) between ports and centres of mass along a world axis."""
    places = [connection.motions[:, :3] for connection in mechanism.connections.values()]
    places += [body.position[None] for body in mechanism.bodies.values()]
    return float(np.ptp(np.concatenate(places), axis=0).max())


def _holding_torque(mechanism: Mechanism, hinge: str) -> float:
    """Torque (N.m) of the spring that holds a hinge, positive opening."""
    connection = mechanism.connections[hinge]
    state = Hinge.states.read(connection.state)
    return -connection.parameter("hold_stiffness") * (state.angle - state.hold_angle)


def _loads(mechanism: Mechanism, name: str, values: Mapping[str, float]) -> dict[str, tuple[float, str]]:
    layout = mechanism.connections[name].component.observation_layout
    units = {name: q.unit for q in layout.quantities for name in q.scalar_names()}
    return {
        key: (value + 0.0, units[key])
        for key, value in values.items()
        if units[key] in _LOAD_UNITS and not key.startswith("friction")
    }


def _base_load(mechanism: Mechanism) -> Vector:
    start = mechanism.rows[mechanism.base].start
    result: Vector = mechanism.forces()[start : start + 6]
    return result
