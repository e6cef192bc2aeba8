"""Cable loops whose radii, axes or stiffness do not fit the lines between their pulleys."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import NamedTuple

from components.contract.frames import Vector3, cross, norm

from ..messages import coded
from ..scene.connection_tables import Ccl
from ..scene.loops.coupled_lines import body_between, turning
from ..scene.placed_scene import PlacedScene

_ASKEW = 1e-3
"""Sine of the angle between a loop's axis and a line's, from which on the loop does not lead the line."""


def loop_warnings(scene: PlacedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-loop-data", _unlike_travels(scene))
    yield from coded("W-loop-data", _askew_loops(scene))


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
    travels = {line.name: line.deployed_angle - line.initial_angle for line in scene.hinge_lines}
    first, second, middle = (
        sum((rate * travels[name] for name, rate in turning(scene, body, loop.axis).items()), 0.0)
        for body in (*bodies, carrier)
    )
    return Travels(first - middle, second - middle)


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
