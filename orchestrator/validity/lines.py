"""Probable mistakes in hinge lines: motors, resistances, latches, stops."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from math import degrees, pi, sqrt
from typing import NamedTuple

import numpy as np

from components.contract.component import Vector
from components.end_stop import EndStop
from components.numerics.laws import Linear
from components.tape_hinge import TapeHinge

from ..assembly.hinges import contradicted_curves
from ..messages import coded, message
from ..scene.connection_tables import Connection
from ..scene.hinge_line_tables import HingeLine
from ..scene.loops.coupled_lines import CoupledLines
from ..scene.placed_scene import PlacedScene
from ..scene.plausible import Plausible
from .bodies import panel_of

_ANGLES = 181
"""Places on a line's way that are looked at."""
_NOTHING = 1e-9
"""Of a motor's largest torque: rounding where it gives none."""
_TURNED = 0.2
"""rad; places are written to a few degrees, and loops close from there; tables may end as early."""
_FLAT = 1e-3
"""rad; how far from half a turn two panels are still folded onto each other."""
_WOUND = Plausible("W-end-data", "deg", most=3.0, reason="milliradians are usual")
_PRESSED = Plausible("W-end-data", "deg", most=30.0)


def line_warnings(scene: PlacedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-no-end", _unstopped(scene))
    yield from coded("W-motor-short", _held_by_friction(scene))
    yield from coded("W-table-range", _beyond_tables(scene))
    yield from coded("W-overlap", _through_one_another(scene))
    yield from _ends_and_friction(scene)
    yield from coded("W-latch-inertia", _damped_by_few(scene))
    yield from coded("W-latch-curve", contradicted_curves(scene))
    yield from coded("W-free-slide", _free_along_the_line(scene))


def _unstopped(scene: PlacedScene) -> Iterator[str]:
    """Lines that a motor opens, without a latch or a stop, also none that is a connection between their bodies."""
    ends_by = (EndStop.kind, TapeHinge.kind)
    stopped = [{seat.body for seat in one.ports.values()} for one in scene.connections if one.kind in ends_by]
    for line in scene.hinge_lines:
        ends = line.latch is not None or line.end_stop is not None or line.held
        if line.motor is not None and not ends and {line.inboard, line.outboard} not in stopped:
            yield (
                f"hinge_line.{line.name}: a motor opens it, but no latch or end stop ends its travel at "
                f"{degrees(line.deployed_angle):g} deg. Add a latch or an end_stop."
            )


def _ends_and_friction(scene: PlacedScene) -> Iterator[str]:
    """End stops before the latch or too soft, presliding friction that is too soft or none."""
    for line in scene.hinge_lines:
        key, stop = f"hinge_line.{line.name}", line.end_stop
        if line.latch is not None and line.stop_angle is not None and line.stop_angle < line.deployed_angle:
            yield message(
                "W-stop-before-latch",
                f"{key}: its end stop at {degrees(line.stop_angle):g} deg is before its latch at "
                f"{degrees(line.deployed_angle):g} deg, so it may not latch. Move the end stop beyond the latch.",
            )
        if stop is not None:
            pressed = degrees(sqrt(2.0 * line.motor_energy / stop.stiffness))
            yield from _PRESSED.warnings(f"{key}.end_stop.stiffness: the motor presses the stop by", pressed)
        if line.presliding is not None and line.presliding.stiffness:
            wound = degrees(line.friction_preload / line.presliding.stiffness)
            yield from _WOUND.warnings(f"{key}.presliding.stiffness: before it slides it winds up by", wound)
        if line.presliding is not None and not line.has_friction and not scene.friction.coefficient:
            words = "the line has no friction. Set its friction_preload, or friction.coefficient."
            yield message("W-friction-data", f"{key}.presliding: {words}")


def _held_by_friction(scene: PlacedScene) -> Iterator[str]:
    """Lines, coupled lines together, whose friction and harness exceed the motor torque at some angle."""
    motors = [line.name for line in scene.hinge_lines if line.motor is not None and not line.held]
    groups = [group for group in scene.coupled_lines if not group.drives]
    coupled = {name for group in groups for name in group.rates}
    alone = [CoupledLines({name: 1.0}, (), ()) for name in motors if name not in coupled]
    for group in [*alone, *groups]:
        if group.rates.keys() & motors and (short := _first_short(scene, group.rates)) is not None:
            first, *others = group.rates
            rates = " : ".join(f"{rate:.4g}" for rate in group.rates.values())
            couple = f"coupled with {' and '.join(others)} at rates {rates}, " if others else ""
            yield (
                f"hinge_line.{first}: {couple}at {degrees(short.angle):.4g} deg the motor torque of {short.given:.4g} "
                f"N.m is below friction and harness, {short.taken:.4g} N.m, so it may stop there. Increase the motor "
                "torque, or reduce friction."
            )


class _Short(NamedTuple):
    """Angle (rad) of a line, driving and resisting torque there (N.m), coupled lines at its rate."""

    angle: float
    given: float
    taken: float


def _first_short(scene: PlacedScene, rates: Mapping[str, float]) -> _Short | None:
    """The first angle at which resistance exceeds the drive; rates: of all coupled lines, relative to the first."""
    lines = {line.name: line for line in scene.hinge_lines}
    given, taken = np.zeros(_ANGLES), np.zeros(_ANGLES)
    for name, rate in rates.items():
        motor, resistance = _torques(lines[name], rate)
        given, taken = given + motor, taken + resistance
    short = np.flatnonzero(given < taken - _NOTHING * np.abs(given).max())
    if not short.size:
        return None
    k = int(short[0])
    return _Short(float(_angles(lines[next(iter(rates))])[k]), float(given[k]), float(taken[k]))


def _torques(line: HingeLine, rate: float) -> tuple[Vector, Vector]:
    """Motor torque, and torque of friction and harness (N.m) over the travel, at the rate of another line."""
    angles = _angles(line).tolist()
    opening = Linear(0.0) if line.harness is None else line.harness.opening_law
    motor = np.array([line.motor_law.value(angle) for angle in angles])
    harness = np.array([opening.value(angle) for angle in angles])
    return rate * motor, abs(rate) * line.friction_preload - rate * harness


def _angles(line: HingeLine) -> Vector:
    """Angles (rad) over the travel of a line."""
    return np.linspace(line.initial_angle, max(line.initial_angle, line.deployed_angle), _ANGLES)


def _beyond_tables(scene: PlacedScene) -> Iterator[str]:
    """Lines that travel beyond the tables of their motor or harness."""
    for line in scene.hinge_lines:
        low, high = sorted((line.initial_angle, line.deployed_angle))
        for name, table in (("motor", line.motor), ("harness", line.harness)):
            if table is None or not table.angle:
                continue
            for end, beyond in (
                (table.angle[0], low - table.angle[0]),
                (table.angle[-1], table.angle[-1] - high),
            ):
                if beyond < -_TURNED:
                    yield (
                        f"hinge_line.{line.name}.{name}: its table ends at {degrees(end):.4g} deg, but the line "
                        f"turns from {degrees(low):.4g} to {degrees(high):.4g} deg, and the last slope is "
                        "extrapolated. Extend the table."
                    )


def _damped_by_few(scene: PlacedScene) -> Iterator[str]:
    """Latches of lines in closed loops whose damping counts only bodies that hinge lines carry."""
    if scene.structural_damping is not None:
        return
    placed = {body.name for body in scene.bodies if body.place is not None}
    for line in scene.hinge_lines:
        latch, carried = line.latch, {b.name for b in scene.bodies if line in scene.lines_inward(b.name)}
        if latch is None or line.held or latch.effective_inertia is not None or latch.damping_ratio == 0.0:
            continue
        joints = (c for c in scene.connections if c.preset is not None)
        beside = {seat.body for joint in joints if _joins(joint, carried) for seat in joint.ports.values()}
        if moved := sorted(beside & placed):
            words = f"{', '.join(moved)} {'move' if len(moved) > 1 else 'moves'} with the line"
            yield (
                f"hinge_line.{line.name}.latch.effective_inertia: {words}, but the latch damping counts only "
                "bodies that hinge lines carry. Set it to the inertia of all moving bodies."
            )


def _joins(joint: Connection, bodies: Collection[str]) -> bool:
    return any(seat.body in bodies for seat in joint.ports.values())


def _free_along_the_line(scene: PlacedScene) -> Iterator[str]:
    """Lines with cylindrical hinges only, whose body slides, as nothing else holds it."""
    if scene.loops or scene.connections:
        return
    for line in scene.hinge_lines:
        if not line.held and {hinge.kind for hinge in line.hinges} == {"cylindrical"}:
            yield (
                f"hinge_line.{line.name}: all its hinges are cylindrical, so {line.outboard} slides along the "
                "line. Make one of them revolute."
            )


def _through_one_another(scene: PlacedScene) -> Iterator[str]:
    """Folded panels that open through each other."""
    points, panels = scene.points, {body.name for body in scene.bodies if panel_of(body) is not None}
    for line in scene.hinge_lines:
        folded = abs(line.aligned_angle - line.initial_angle - pi) < _FLAT
        if line.held or not folded or not {line.inboard, line.outboard} <= panels:
            continue
        first = line.hinges[0]
        apart = points[line.inboard][first.inboard][2] + points[line.outboard][first.outboard][2]
        if apart * line.axis[1] < 0.0:
            side = "above" if apart > 0.0 else "below"
            yield (
                f"hinge_line.{line.name}: {line.outboard} lies {1e3 * abs(apart):.4g} mm {side} {line.inboard} "
                "(along its z) and opens through it. Change the sign of panel.hinge_line_offsets, or of axis."
            )
