"""What drives a scene: the energy beside which errors are judged, and the load beside which iterations end."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import hypot

import numpy as np

from components.load import Load
from components.numerics.motion_law import NOTHING, MotionLaw

from ..scene.component_connections import component_values
from ..scene.connection_tables import Connection
from ..scene.hinge_line_tables import HingeLine
from ..scene.placed_scene import PlacedScene
from . import Driving

_SAMPLES = 65
"""Of a law, from which its largest value is taken: its size is what matters."""


def driving(scene: PlacedScene, lines: Sequence[HingeLine]) -> Driving:
    """By the motors of hinge lines, loads that follow laws and preloads of cable loops; weights tell by themselves.

    The usual load where nothing of this acts, or where FMUs with signals do whatever they do.
    """
    most, usual = driving_load(scene, lines), Driving().load
    return Driving(
        sum((line.motor_energy for line in lines), 0.0),
        min(usual, most) if most and not scene.fmus else usual,
    )


def driving_load(scene: PlacedScene, lines: Sequence[HingeLine]) -> float:
    """Sum of the largest torques (N.m) and forces (N) of motors, loads and preloads."""
    loads = [_motor_torque(line) for line in lines]
    loads += [loop.preload for loop in scene.loops]
    loads += [_size(one, scene.header.until) for one in scene.connections if one.kind == Load.kind]
    return sum(loads)


def _motor_torque(line: HingeLine) -> float:
    """Largest magnitude (N.m) on the way to the deployed angle."""
    angles = np.linspace(line.initial_angle, line.deployed_angle, _SAMPLES)
    return _largest(line.motor_law.value(float(angle)) for angle in angles)


def load_laws(load: Connection) -> tuple[MotionLaw, MotionLaw]:
    """Force (N) and torque (N.m) of a load over time."""
    structure, _ = component_values(load, "mean")
    return MotionLaw(structure.get("force") or NOTHING), MotionLaw(structure.get("torque") or NOTHING)


def _size(load: Connection, until: float) -> float:
    """Largest force (N) and torque (N.m) of a law up to a time (s), together."""
    times = np.linspace(0.0, until, _SAMPLES)
    return hypot(*(_largest(law.value(float(time)) for time in times) for law in load_laws(load)))


def _largest(values: Iterable[float]) -> float:
    return max(map(abs, values))
