"""Hinges about the y axis, motions of their ports, and what they show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from components.contract.component import Vector
from components.hinge import Hinge
from components.hinge_parts.state import Constants
from tests.references.coupled import Run
from tests.references.relative_motion import inputs, port_motion
from tests.unit.components.prepared import prepared

AXIS = (0.0, 1.0, 0.0)
STIFF = {
    "translational_stiffness": (1e7, 1e7, 1e7),
    "translational_damping": (1e3, 1e3, 1e3),
    "rotational_stiffness": (0.0, 1e5, 1e5),
    "rotational_damping": (0.0, 20.0, 20.0),
}
HARNESS = {"harness_angle": (-3.0, -1.0, 0.5, 3.0), "harness_torque": (0.3, 0.2, -0.1, -0.3)}
CONSTANT_TORQUE = {"harness_angle": (-3.0, 3.0), "harness_torque": (2.0, 2.0)}


def hinge(
    mode: str = "mean", structure: Mapping[str, Any] | None = None, **start: Any
) -> tuple[Hinge, Constants]:
    """A hinge and its constants, parameters by name."""
    component = Hinge(**{"axis": AXIS, "wrench_mode": mode, **(structure or {})})
    return component, prepared(component, **start)


def outboard(
    component: Hinge,
    turn: float = 0.0,
    place: Sequence[float] = (0.0, 0.0, 0.0),
    rate: float = 0.0,
    **commands: float,
) -> Vector:
    """Inputs: inboard port at rest at the origin, outboard port turned and turning about the axis."""
    moving = port_motion(place, (0.0, turn, 0.0), spin=(0.0, rate, 0.0))
    return inputs(component, port_motion(), moving, **commands)


def observed(component: Hinge, c: Constants, x: Vector, u: Vector) -> dict[str, float]:
    """Every scalar of the observations by name."""
    values = component.observe(c, x, u)
    return dict(zip(component.observation_layout.scalar_names(), values.tolist(), strict=True))


def at(run: Run, time: float) -> int:
    """Row of a run that was recorded nearest to a time; the first of those at an event."""
    return int(np.argmin(np.abs(np.array(run.times) - time)))
