"""How stiffly the friction of a hinge line sticks: from the line, so that the user need not know a stiffness.

Friction breaks away after an elastic deflection. A deflection of 1e-4 of the line's travel cannot be seen in any angle,
and leaves the line softer than its joints and latches, so that it costs no smaller steps.
"""

from __future__ import annotations

from math import hypot, sqrt
from typing import NamedTuple

from ..scene.hinge_line_tables import HingeLine, Presliding
from ..scene.placed_scene import PlacedScene
from .driving import driving_load

_BREAKAWAY = 1e-4
"""Deflection at breakaway over the travel of the line."""
_LEAST_TRAVEL = 0.1
"""rad, of lines that open to nowhere, such as joints of a linkage."""
_LEAST_LOAD = 1.0
"""N, of scenes that nothing drives but the motion of their base."""


class Sticking(NamedTuple):
    """Stiffness (N.m/rad) and damping (N.m.s/rad) of a line while its friction sticks; zero where it does not."""

    stiffness: float
    damping: float


def sticking(scene: PlacedScene, line: HingeLine) -> Sticking:
    """Of a line, the total of its hinges."""
    if line.presliding is None and scene.friction.law == "smooth":
        return Sticking(0.0, 0.0)
    presliding = line.presliding or Presliding()
    stiffness = presliding.stiffness or _usual_friction(scene, line) / (_BREAKAWAY * _travel(line))
    if stiffness == 0.0:
        return Sticking(0.0, 0.0)
    inertia = presliding.effective_inertia or scene.effective_inertia(line)
    return Sticking(stiffness, 2.0 * presliding.damping_ratio * sqrt(stiffness * inertia))


def _travel(line: HingeLine) -> float:
    return max(_LEAST_TRAVEL, line.deployed_angle - line.initial_angle)


def _usual_friction(scene: PlacedScene, line: HingeLine) -> float:
    """Friction (N.m) of a line: what its tables say, and what its pins have under the loads that drive the scene."""
    loops = (table.loop for table in (line.motor, line.harness) if table is not None)
    hysteresis = sum(max(loop.half, default=0.0) for loop in loops if loop is not None)
    return line.friction_preload + hysteresis + _pin_friction(scene)


def _pin_friction(scene: PlacedScene) -> float:
    """Static friction (N.m) of pins under the sum of motors, preloads, loads and weights, each torque at 1 m."""
    pins = scene.friction
    if pins.coefficient == 0.0:
        return 0.0
    mass = sum(model.mass for model in scene.rigid_models.values())
    load = driving_load(scene, scene.hinge_lines) + hypot(*scene.header.gravity) * mass
    arm = pins.pin_radius * (1.0 + (1.0 / pins.bending_arm if pins.bending_arm else 0.0))
    return pins.static_ratio * pins.coefficient * arm * max(load, _LEAST_LOAD)
