"""Static equilibrium of a scene and its loads, and quasi-static sweeps over angles of hinge lines.

Newton's method on exact tangents, without friction. Held lines keep their angle by a stiff spring, whose torque
is what a drive or a hold-down would have to give.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from itertools import pairwise
from math import ceil, pi
from typing import NamedTuple

import click
import numpy as np

from components.contract.component import Vector
from components.contract.frames import exponential, multiply, rotate
from components.hinge_parts.state import State

from ..cli.options import SceneChoice, ordered_names, refuse_idle, scene_choice
from ..cli.types import Count
from ..scene import Scene, SceneError
from ..scene.locked_groups import joined
from ._configuration import (
    Configuration,
    ConfigurationChoice,
    angle_of,
    configuration_choice,
    hinges_of,
    lines_given,
    lines_named,
    placed,
)
from ._equilibrium_tables import Equilibrium, print_loads, print_sweep
from ._mechanism import Mechanism
from ._statics import settle
from ._tables import degrees_text

_LARGEST_STEP = pi / 36.0
"""rad that a swept line turns between two equilibria"""
_SMALLEST_STEP = _LARGEST_STEP / 100.0
"""rad; a cable that goes slack needs smaller steps, but what fails at these has no equilibrium"""
_LOAD_UNITS = ("N", "N.m")
_EXAMPLES = """\b
Examples:
  fanfold analyse equilibrium amos3 --rigid all --preload
  fanfold analyse equilibrium amos3 --rigid all --steps 6 \\
    --sweep HL1=0deg:90deg,HL2=0deg:180deg,HL3=0deg:180deg
"""


class Sweep(NamedTuple):
    """A line that is turned from one angle to another (rad)."""

    line: str
    start: float
    end: float


def equilibrium(
    scene: Scene,
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
    mechanism = placed(scene, rigid, flexible, target)
    mechanism.command("hold", 1.0, hinges_of(scene, held))
    if adjusted:
        mechanism.command("hold", 1.0, [n for n, c in mechanism.connections.items() if c.kind == "ccl"])
    settle(mechanism, _advice(scene, target, held, swept))
    return mechanism, _found(scene, mechanism, held)


def _advice(scene: Scene, target: Configuration, held: Collection[str], swept: Collection[str]) -> str:
    """What to do where there is no equilibrium."""
    free = _free_lines(scene, target, held)
    if not free:
        loops = " that stretch no cable loop" if scene.loops else ""
        return (
            f"its hinge lines are all held or latched, so choose other angles with --angle or --sweep{loops}"
        )
    kept = ",".join([*(name for name in held if name not in swept), *free])
    return f"nothing holds {', '.join(free)}; hold {'it' if len(free) == 1 else 'them'} with --hold {kept}"


def _free_lines(scene: Scene, target: Configuration, held: Collection[str]) -> list[str]:
    bound = {*target.latched, *held}
    return [line.name for line in scene.hinge_lines if not line.held and line.name not in bound]


def quasi_static(
    scene: Scene,
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
    scene: Scene,
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


def _turn(scene: Scene, mechanism: Mechanism, name: str, angle: float) -> None:
    """Turn everything outboard of a line about it, and hold its hinges there; a drive commands its new angle."""
    drives = [connection for connection in mechanism.connections.values() if connection.kind == "drive"]
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
        state = State.unpack(connection.state)
        connection.state = state._replace(hold_angle=state.hold_angle + angle).pack()
    mechanism.follow()
    for drive, angle_before in zip(drives, before, strict=True):
        for end in ("start_angle", "end_angle"):
            drive.set_parameter(end, drive.parameter(end) + drive.observe()["angle"] - angle_before)


def _outboard(scene: Scene, name: str) -> set[str]:
    """Bodies, or pieces of several, that a line carries."""
    roots = joined(scene)
    lines = [line for line in scene.hinge_lines if not line.held]
    found = {roots[line.outboard] for line in lines if line.name == name}
    while more := {roots[k.outboard] for k in lines if roots[k.inboard] in found} - found:
        found |= more
    return found


def _found(scene: Scene, mechanism: Mechanism, held: Collection[str]) -> Equilibrium:
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
    state = State.unpack(connection.state)
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


def sweeps_given(_: click.Context, __: click.Parameter, value: str) -> tuple[Sweep, ...]:
    """Sweeps such as HL1=0deg:90deg,HL2=0deg:180deg."""
    found = []
    for entry in ordered_names(_, __, value):
        name, equals, angles = entry.partition("=")
        start, colon, end = angles.partition(":")
        if not (equals and colon and name.strip()):
            raise click.BadParameter(f"{entry!r} is not of the form HL1=0deg:90deg")
        line = name.strip()
        found.append(Sweep(line, angle_of(line, start), angle_of(line, end)))
        if found[-1].start == found[-1].end:
            raise click.BadParameter(f"{entry!r}: the two angles are the same")
        if found[-1].line in {sweep.line for sweep in found[:-1]}:
            raise click.BadParameter(f"{entry!r}: {found[-1].line} is swept already")
    return tuple(found)


@click.command("equilibrium", epilog=_EXAMPLES)
@scene_choice
@configuration_choice
@click.option(
    "--hold", metavar="LINES", callback=lines_given,
    help="Held lines, with commas between, or all, or none; by default all that are not latched, in a sweep none.",
)  # fmt: skip
@click.option("--preload", is_flag=True, help="Cable loops have exactly their preload, as when a run begins.")
@click.option(
    "--sweep", "sweeps", default="", callback=sweeps_given, metavar="LINE=FROM:TO,...",
    help="Turn lines together through angles, each with deg or rad, such as HL1=0deg:90deg; other lines follow.",
)  # fmt: skip
@click.option(
    "--steps", type=Count(min=1, max=10_000), default=12, show_default=True, help="Steps of a sweep."
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    wanted: ConfigurationChoice,
    hold: str | None,
    preload: bool,
    sweeps: tuple[Sweep, ...],
    steps: int,
    as_json: bool,
) -> None:
    """Static equilibrium of SCENE and the loads of its connections, at one configuration or over a sweep."""
    refuse_idle("--steps", "--sweep")
    if preload and sweeps:
        raise click.UsageError("--preload is about one equilibrium; leave it or --sweep out")
    scene = choice.load_one_run()
    target = wanted.of(scene)
    swept = lines_named(scene, ",".join(sweep.line for sweep in sweeps))
    default = "none" if sweeps else ",".join(_free_lines(scene, target, ()))
    held = [name for name in lines_named(scene, default if hold is None else hold) if name not in swept]
    both = sorted({*swept, *held} & set(target.latched))
    if both:
        raise SceneError([f"{scene.file}: {', '.join(both)}: a line is latched, or held or swept, not both"])
    if sweeps:
        found = quasi_static(scene, choice.rigid, choice.flexible, target, held, sweeps, steps)
    else:
        found = [equilibrium(scene, choice.rigid, choice.flexible, target, held, preload)[1]]
    if as_json:
        content = {"scene": scene.header.name, "equilibria": [one.as_dict() for one in found]}
        click.echo(json.dumps(content))
    elif sweeps:
        print_sweep(found)
    else:
        print_loads(found[0])
