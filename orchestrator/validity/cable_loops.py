"""Cable loops whose radii, axes or stiffness, and gears whose ratio, do not fit the lines that they couple."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import NamedTuple

from components.contract.frames import Vector3, cross, norm

from ..messages import coded
from ..scene.loops.coupled_lines import Coupling, gears, jams, line_turns, loop_coupling
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
    yield from coded("W-loop-data", _jammed(scene))


class Travels(NamedTuple):
    """Rotations (rad) of both bodies of a cable loop or gear relative to their carriers, until full deployment.

    mismatch: cable length (m) that one pulley winds up and the other does not release, or twist (rad) of the gear.
    """

    first: float
    second: float
    mismatch: float


def coupled_travels(scene: PlacedScene, coupling: Coupling) -> Travels | None:
    """The travels that are coupled; None where lines alone do not tell them."""
    ways = {
        line.name: 0.0 if line.held else line.deployed_angle - line.initial_angle
        for line in scene.hinge_lines
    }
    turns = line_turns(scene, coupling)
    if not turns:
        return None
    first, second = (sum((rate * ways[name] for name, rate in turn.items()), 0.0) for turn in turns)
    return Travels(first, second, abs(coupling.radii[0] * first - coupling.radii[1] * second))


def _unlike_travels(scene: PlacedScene) -> Iterator[str]:
    """Loops whose radii do not fit their travels, so that a strand goes slack."""
    for loop in scene.loops:
        travels = coupled_travels(scene, loop_coupling(scene, loop))
        if travels is None or travels.mismatch * loop.strand_stiffness <= loop.preload:
            continue
        first, second = (abs(degrees(turn)) for turn in (travels.first, travels.second))
        r1, r2, left = 1e3 * loop.pulley_1.radius, 1e3 * loop.pulley_2.radius, travels.mismatch
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
        travels = coupled_travels(scene, gear)
        if travels is None:
            continue
        (first, second, wound), ratio = travels, gear.radii[1]
        if wound > _WOUND * max(abs(first), abs(ratio * second)):
            fit = f" A ratio of {first / second:g} would fit." if first and second else ""
            carriers = "the carrier" if len(set(gear.carriers or ())) == 1 else "their carriers"
            yield (
                f"{gear.key}: its ratio of {ratio:g} does not fit the travels of the lines: its bodies "
                f"turn by {degrees(first):g} and {degrees(second):g} deg against {carriers}, which winds the gear "
                f"by {degrees(wound):.3g} deg.{fit}"
            )


def _jammed(scene: PlacedScene) -> Iterator[str]:
    """Lines that cable loops and gears of unlike ratios, or with held lines, leave no motion."""
    for jam in jams(scene):
        yield (
            f"{' and '.join(jam.keys)}: with {'these' if len(jam.keys) > 1 else 'this'} {' and '.join(jam.lines)} "
            "cannot move, as ratios differ or a coupled line is held. Check radii, axes and ratios with their signs, "
            "and `held`."
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
