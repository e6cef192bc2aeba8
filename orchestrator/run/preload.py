"""Warnings about the static equilibrium in which a scene with preload starts."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees

import numpy as np

from components.contract.frames import norm, normalized, rotation_between
from components.rail import Rail

from ..assembly import Assembly, Part
from ..assembly.statics.start import Start
from ..results.result import Result

_STARTED = {"initial_position": "frame_position", "initial_orientation": "frame_orientation"}
"""Parameters of bodies that say where they start, by what is recorded of them."""
_MOVED = 0.05
"""rad, by which equilibrium may turn a body before that is told: cables give way by a degree."""
_SLID = 5e-3
"""m along a rail, by which the search may move what it guides before that is told: ropes lean a little."""
_LOST = 0.1
"""Of a preload, by which equilibrium may change it before that is told: stacks give way a little."""


def let_go_at_start(start: Start) -> Iterator[str]:
    """A sentence for joints that are held in the search alone, as loads would drive what they carry away."""
    if joints := ", ".join(start.held):
        yield (
            f"{start.assembly.name}: there is no static equilibrium while {joints} can turn, so the search holds it "
            "and it is released at t = 0. Start without preload, or from an equilibrium position."
        )


def lost_preloads(assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for each hold-down that static equilibrium leaves far from the preload that it was given."""
    for part in assembly.parts if assembly.preload else ():
        given = float(np.ravel(part.start.get("preload", 0.0))[0]) if part.kind == "hold_down" else 0.0
        if not given or not result.has(part.name, "force"):
            continue
        axis = np.array(part.component().structure["axis"], dtype=float)
        pull = -float(result.signal(part.name, "force")[0] @ axis) / float(np.linalg.norm(axis))
        if abs(pull - given) > _LOST * given:
            left = f"{pull:.4g} N" if pull >= 0.0 else f"a push of {-pull:.4g} N"
            yield (
                f"{part.name} starts in static equilibrium with {left} instead of its preload of {given:.4g} N. "
                "Give it something stiff to pull against, such as a snubber."
            )


def moved_starts(assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for what static equilibrium turns most from where it is placed, where that is far."""
    turns = {part.name: _turned(part, result) for part in assembly.parts} if assembly.preload else {}
    name = max(turns, key=lambda part: turns[part], default="")
    if turns.get(name, 0.0) > _MOVED:
        yield (
            f"{name} starts {degrees(turns[name]):.3g} deg from its place, in static equilibrium under the loads "
            "at the start. Start without preload to keep its place."
        )
    rails = [part for part in assembly.parts if assembly.preload and part.kind == Rail.kind]
    trolleys = {link.connection[0]: link.body[0] for link in assembly.links}
    for trolley, rail in {trolleys[rail.name]: rail for rail in rails}.items():
        yield from _slid_start(assembly, trolley, rail, result)


def _slid_start(assembly: Assembly, name: str, rail: Part, result: Result) -> Iterator[str]:
    """A sentence where a trolley has slid in the search, because its rail cannot hold it there."""
    (body,) = (part for part in assembly.parts if part.name == name)
    parameter = "initial_position"
    if parameter not in body.start or not result.has(name, _STARTED[parameter]):
        return
    normal = np.array(rail.structure["normal"], dtype=float)
    shift = result.signal(name, _STARTED[parameter])[0] - np.ravel(body.start[parameter])
    along = float(np.linalg.norm(shift - (shift @ normal) / (normal @ normal) * normal))
    if along > _SLID:
        yield (
            f"{name} starts {1e3 * along:.3g} mm along {rail.name} from its place, because the loads at the start "
            "exceed the friction of the rail or its friction is smooth. Start without preload, or hold it with a "
            "spring."
        )


def _turned(part: Part, result: Result) -> float:
    """How far (rad) a body is turned where the run starts."""
    parameter = "initial_orientation"
    if parameter not in part.start or not result.has(part.name, _STARTED[parameter]):
        return 0.0
    placed = normalized(tuple(np.ravel(part.start[parameter]).tolist()))
    return norm(rotation_between(placed, tuple(result.signal(part.name, _STARTED[parameter])[0].tolist())))
