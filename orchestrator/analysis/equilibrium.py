"""Static equilibrium of a scene and its loads, and quasi-static sweeps over angles of hinge lines.

Newton's method on exact tangents, without friction. Held lines keep their angle by a stiff spring, whose torque
is what a drive or a hold-down would have to give.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from math import ceil, pi
from typing import NamedTuple

import click
import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from components._component import Vector
from components._frames import exponential, multiply, rotate
from components._hinge_state import State

from ..cli_options import fidelity_options, ordered_names, scene_layers, scene_of_one_run
from ..noise import NOISE, noise_floor
from ..scene import Scene, SceneError
from ..scene_pieces import joined
from ._configuration import (
    Configuration,
    Named,
    angle_of,
    configuration,
    configuration_options,
    hinges_of,
    lines_named,
    placed,
)
from ._mechanism import Mechanism
from ._statics import settle

_LARGEST_STEP = pi / 36.0
"""rad that a swept line turns between two equilibria"""
_LOAD_UNITS = ("N", "N.m")
_BASE_LOADS = (("force", "N"), ("torque", "N.m"))
_NUMBER = 7

Column = tuple[str, list[str]]
"""Heading and cells of a table"""


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """One equilibrium: angles (rad) and holding torques (N.m, opening) of lines, loads of connections, base load."""

    angles: Mapping[str, float]
    holding_torques: Mapping[str, float]
    loads: Mapping[str, Mapping[str, tuple[float, str]]]
    """value and unit by connection and name"""
    base_load: tuple[float, ...]
    """force (N) and torque (N.m) of the structure on the base about its reference point, world axes"""

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
) -> tuple[Mechanism, Equilibrium]:
    """The equilibrium in a configuration with the named lines held; SceneError where there is none.

    adjusted: cable loops have exactly their preload, as when a run begins with static equilibrium.
    """
    mechanism = placed(scene, rigid, flexible, target)
    mechanism.command("hold", 1.0, hinges_of(scene, held))
    if adjusted:
        mechanism.command("hold", 1.0, [n for n, c in mechanism.connections.items() if c.kind == "ccl"])
    settle(mechanism, ", ".join(_free_lines(scene, target, held)))
    return mechanism, _found(scene, mechanism, held)


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
    mechanism, first = equilibrium(scene, rigid, flexible, target, kept)
    free = ", ".join(_free_lines(scene, target, kept))
    parts = ceil(max(abs(sweep.end - sweep.start) for sweep in sweeps) / steps / _LARGEST_STEP)
    found = [first]
    for _ in range(steps):
        for _ in range(parts):
            for sweep in sweeps:
                _turn(scene, mechanism, sweep.line, (sweep.end - sweep.start) / (steps * parts))
            settle(mechanism, free)
        found.append(_found(scene, mechanism, kept))
    return found


def _turn(scene: Scene, mechanism: Mechanism, name: str, angle: float) -> None:
    """Turn everything outboard of a line about it, and hold its hinges there."""
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
    )


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
        found.append(Sweep(name.strip(), angle_of(start), angle_of(end)))
        if found[-1].start == found[-1].end:
            raise click.BadParameter(f"{entry!r}: the two angles are the same")
        if found[-1].line in {sweep.line for sweep in found[:-1]}:
            raise click.BadParameter(f"{entry!r}: {found[-1].line} is swept already")
    return tuple(found)


@click.command("equilibrium")
@click.argument("scene")
@scene_layers
@fidelity_options
@configuration_options
@click.option(
    "--hold", metavar="LINES",
    help="Held lines, with commas between, or all, or none; by default all that are not latched, in a sweep none.",
)  # fmt: skip
@click.option("--preload", is_flag=True, help="Cable loops have exactly their preload, as when a run begins.")
@click.option(
    "--sweep", "sweeps", default="", callback=sweeps_given, metavar="LINE=FROM:TO,...",
    help="Turn lines together through angles, such as HL1=0deg:90deg.",
)  # fmt: skip
@click.option("--steps", type=click.IntRange(min=1), default=12, show_default=True, help="Steps of a sweep.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    scene: str,
    variants: tuple[str, ...],
    settings: tuple[str, ...],
    rigid: frozenset[str],
    flexible: frozenset[str],
    named: Named,
    angles: dict[str, float],
    latched: str | None,
    hold: str | None,
    preload: bool,
    sweeps: tuple[Sweep, ...],
    steps: int,
    as_json: bool,
) -> None:
    """Static equilibrium of SCENE and the loads of its connections, at one configuration or over a sweep."""
    loaded_scene = scene_of_one_run(scene, variants, settings)
    target = configuration(loaded_scene, named, angles, latched)
    swept = lines_named(loaded_scene, ",".join(sweep.line for sweep in sweeps))
    default = "none" if sweeps else ",".join(_free_lines(loaded_scene, target, ()))
    held = [
        name for name in lines_named(loaded_scene, default if hold is None else hold) if name not in swept
    ]
    both = sorted({*swept, *held} & set(target.latched))
    if both:
        raise SceneError(
            [f"{loaded_scene.file}: {', '.join(both)}: a line is latched, or held or swept, not both"]
        )
    if sweeps:
        found = quasi_static(loaded_scene, rigid, flexible, target, held, sweeps, steps)
    else:
        found = [equilibrium(loaded_scene, rigid, flexible, target, held, preload)[1]]
    if as_json:
        content = {"scene": loaded_scene.header.name, "equilibria": [one.as_dict() for one in found]}
        click.echo(json.dumps(content))
    elif sweeps:
        _print_sweep(found)
    else:
        _print_loads(found[0])


def _print_loads(found: Equilibrium) -> None:
    table = _table("static equilibrium")
    table.add_column("connection")
    table.add_column("load")
    table.add_column("value", justify="right", min_width=_NUMBER)
    table.add_column("unit")
    for line, torque in found.holding_torques.items():
        angle = np.rad2deg(found.angles[line])
        table.add_row(line, f"holding torque at {angle:.3f} deg", f"{torque:.5g}", "N.m")
    rows = list(_load_rows(found))
    floors = {unit: noise_floor(value for _, _, value, kind in rows if kind == unit) for unit in _LOAD_UNITS}
    shown = [row for row in rows if abs(row[2]) > floors[row[3]]]
    previous = ""
    for connection, name, value, unit in shown:
        table.add_row("" if connection == previous else connection, name, f"{value:.5g}", unit)
        previous = connection
    console = Console()
    console.print(table)
    if len(shown) < len(rows):
        console.print(
            f"{len(rows) - len(shown)} loads are left out: zero, or below {NOISE:g} of the largest of their unit"
        )


def _load_rows(found: Equilibrium) -> Iterator[tuple[str, str, float, str]]:
    """Connection, load, value and unit; the base last."""
    for connection, loads in found.loads.items():
        for name, (value, unit) in loads.items():
            yield connection, name.replace("_", " "), value, unit
    names = [(f"{what} {axis}", unit) for what, unit in _BASE_LOADS for axis in "xyz"]
    for (name, unit), value in zip(names, found.base_load, strict=True):
        yield "base", name, value, unit


def _print_sweep(found: list[Equilibrium]) -> None:
    first = found[0]
    columns = [
        (f"hold\n{line},\nN.m", [f"{one.holding_torques[line]:.5g}" for one in found])
        for line in first.holding_torques
    ]
    columns += [
        (f"{name}\n{load.rpartition('_')[2]}, N", [f"{one.loads[name][load][0]:.5g}" for one in found])
        for name, loads in first.loads.items()
        for load in loads
        if load.startswith("tension")
    ]
    angles = [
        (f"{line},\ndeg", [f"{np.rad2deg(one.angles[line]) + 0.0:.2f}" for one in found])
        for line in first.angles
    ]
    console = Console()
    for part in _that_fit(angles, columns, console.width):
        table = _table("quasi-static sweep: angles, torques to hold them, tensions of strands a and b")
        for heading, _ in part:
            table.add_column(heading, justify="right", no_wrap=True)
        for row in zip(*(cells for _, cells in part), strict=True):
            table.add_row(*row)
        console.print(table)


def _that_fit(angles: list[Column], columns: list[Column], width: int) -> Iterator[list[Column]]:
    """Tables as wide as the terminal at most, each with all angles in front and at least one more column."""
    part = list(angles)
    for column in columns:
        if len(part) > len(angles) and 1 + sum(2 + _width(one) for one in (*part, column)) > width:
            yield part
            part = list(angles)
        part.append(column)
    yield part


def _width(column: Column) -> int:
    heading, cells = column
    return max(map(len, (*heading.split("\n"), *cells)))


def _table(title: str) -> Table:
    return Table(title=title, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
