"""Cable loops whose radii, axes or stiffness, and gears whose ratio, do not fit the lines that they couple."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import NamedTuple

from components.contract.frames import Vector3, cross, norm

from ..messages import coded
from ..scene.connection_tables import Ccl
from ..scene.loops.coupled_lines import body_between, gears, is_carried, turning
from ..scene.placed_scene import PlacedScene

_ASKEW = 1e-3
"""Sine of the angle between a loop's axis and a line's, from which on the loop does not lead the line."""
_WOUND = 0.01
"""Of the travel of a gear: ratios are rounded."""


def loop_warnings(scene: PlacedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-loop-data", _unlike_travels(scene))
    yield from coded("W-loop-data", _askew_loops(scene))
    yield from coded("W-loop-data", _unlike_ratios(scene))


class Travels(NamedTuple):
    """Rotations (rad) of both pulleys of a loop relative to the body between them, until full deployment."""

    first: float
    second: float

    def mismatch(self, loop: Ccl) -> float:
        """Difference (m) of the cable lengths that the two pulleys wind up and release."""
        return abs(loop.pulley_1.radius * self.first - loop.pulley_2.radius * self.second)


def loop_travels(scene: PlacedScene, loop: Ccl) -> Travels | None:
    """The travels that a loop couples; None if no single body is between its pulleys."""
    bodies = loop.pulley_1.body, loop.pulley_2.body
    carrier = loop.guide.body if loop.guide is not None else body_between(scene, bodies)
    if carrier is None:
        return None
    first, second = (_travel(scene, body, loop.axis) - _travel(scene, carrier, loop.axis) for body in bodies)
    return Travels(first, second)


def _travel(scene: PlacedScene, body: str, axis: Vector3) -> float:
    """Rotation (rad) of a body about an axis against the base, until full deployment."""
    travels = {line.name: line.deployed_angle - line.initial_angle for line in scene.hinge_lines}
    return sum((rate * travels[name] for name, rate in turning(scene, body, axis).items()), 0.0)


def _unlike_travels(scene: PlacedScene) -> Iterator[str]:
    """Loops whose radii do not fit their travels, so that a strand goes slack."""
    for loop in scene.loops:
        travels = loop_travels(scene, loop)
        if travels is None or travels.mismatch(loop) * loop.strand_stiffness <= loop.preload:
            continue
        first, second = (abs(degrees(turn)) for turn in travels)
        r1, r2, left = 1e3 * loop.pulley_1.radius, 1e3 * loop.pulley_2.radius, travels.mismatch(loop)
        fit = f" Radii in the ratio {second:g} to {first:g} would fit." if first and second else ""
        if travels.first * travels.second < 0.0:
            fit = " The pulleys turn in opposite senses: check the axes of the lines."
        yield (
            f"ccl.{loop.name}: its pulley radii do not fit the travels of the lines: {r1:g} mm by {first:g} deg "
            f"and {r2:g} mm by {second:g} deg stretch a strand by {1e3 * left:.3g} mm, "
            f"{left * loop.strand_stiffness:.3g} N at a preload of {loop.preload:g} N.{fit}"
        )


def _unlike_ratios(scene: PlacedScene) -> Iterator[str]:
    """Gears that the lines which they couple wind up on their way."""
    for gear in gears(scene):
        if not all(is_carried(scene, body) for body in (*gear.bodies, gear.guide or "")):
            continue
        first, second = (
            _travel(scene, body, axis) - _travel(scene, gear.guide or "", axis)
            for body, axis in zip(gear.bodies, gear.axes, strict=True)
        )
        ratio = gear.radii[1]
        wound = first - ratio * second
        if abs(wound) > _WOUND * max(abs(first), abs(ratio * second)):
            fit = f" A ratio of {first / second:g} would fit." if first and second else ""
            yield (
                f"connection.{gear.name}: its ratio of {ratio:g} does not fit the travels of the lines: its bodies "
                f"turn by {degrees(first):g} and {degrees(second):g} deg against the carrier, which winds the gear "
                f"by {degrees(abs(wound)):.3g} deg.{fit}"
            )


def _askew_loops(scene: PlacedScene) -> Iterator[str]:
    """Cable loops whose axis is not parallel to that of the lines between their pulleys."""
    for loop in scene.loops:
        ways = [list(scene.lines_inward(pulley.body)) for pulley in (loop.pulley_1, loop.pulley_2)]
        between = [line for way, other in (ways, ways[::-1]) for line in way if line not in other]
        askew = [line for line in between if norm(cross(loop.axis, line.axis)) > _ASKEW]
        if askew:
            yield (
                f"ccl.{loop.name}.axis: the axis of the pulleys, {_plain(loop.axis)}, is not parallel to that of "
                f"{askew[0].name}, {_plain(askew[0].axis)}. Give the loop the axis of its lines."
            )


def _plain(axis: Vector3) -> str:
    """Text of an axis."""
    return "(" + ", ".join(f"{x:.4g}" for x in axis) + ")"
