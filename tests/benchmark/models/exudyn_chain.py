"""The chains of `chain` in Exudyn: a tree of ideal joints in minimal coordinates, and bodies on bushings."""

from __future__ import annotations

from math import pi
from time import perf_counter
from typing import Any, Literal, NamedTuple

import numpy as np

from components import rotation_matrix
from tests.benchmark.models import exudyn_model as model
from tests.benchmark.models.chain import FOLDED, INBOARD, OUTBOARD, Chain
from tests.benchmark.models.exudyn_model import WORLD, exudyn, item
from tests.benchmark.stability import MOTOR_STIFFNESS, MOTOR_WIND_UP

Solver = Literal["implicit", "explicit"]


class Outcome(NamedTuple):
    """Wall time of a run (s), and the angle of the outermost line at its end (rad)."""

    wall: float
    angle: float


def _solve(system: Any, h: float, steps: int, tolerance: float, solver: Solver) -> float:
    """Run with a fixed step; the wall time, NaN where the solver fails."""
    settings = model.quiet_settings(model.Steps(h, h, tolerance))
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps = steps * h, steps
    integration.automaticStepSize = False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    if solver == "explicit":
        integration.solverType = exudyn.DynamicSolverType.RK44
    start = perf_counter()
    try:
        system.SolveDynamic(settings)
    except exudyn.SolverError:
        return float("nan")
    return perf_counter() - start


def tree(chain: Chain, h: float, steps: int, tolerance: float, solver: Solver) -> Outcome:
    """Rigid panels on ideal revolute joints, one object in minimal coordinates."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    count, data = chain.count, chain.data
    to_joint = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    """Construction axes -> joint axes, whose z axis is our y axis."""
    inboard, outboard = chain.point(INBOARD["left"]), chain.point(OUTBOARD["left"])
    flat = np.array((1.0, 0.0, 1.0))
    offset = to_joint.T @ (flat * (outboard - inboard))
    center = to_joint.T @ (data.center_of_mass - flat * inboard)
    signs = np.array([FOLDED[k % 2][1] for k in range(count)])
    node = system.AddNode(
        item.NodeGenericODE2(
            numberOfODE2Coordinates=count,
            referenceCoordinates=[0.0] * count,
            initialCoordinates=list(-pi * signs),
            initialCoordinates_t=[0.0] * count,
        )
    )
    system.AddObject(
        item.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exudyn.JointType.RevoluteZ] * count,
            linkParents=list(range(-1, count - 1)),
            jointTransformations=exudyn.Matrix3DList([to_joint] + [np.eye(3)] * (count - 1)),
            jointOffsets=exudyn.Vector3DList([np.zeros(3)] + [offset] * (count - 1)),
            linkInertiasCOM=exudyn.Matrix3DList([to_joint.T @ data.inertia @ to_joint] * count),
            linkCOMs=exudyn.Vector3DList([center] * count),
            linkMasses=[data.mass] * count,
            jointPControlVector=[MOTOR_STIFFNESS] * count,
            jointDControlVector=[0.0] * count,
            jointPositionOffsetVector=list(signs * (MOTOR_WIND_UP - pi)),
            jointVelocityOffsetVector=[0.0] * count,
        )
    )
    system.Assemble()
    wall = _solve(system, h, steps, tolerance, solver)
    turned = system.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates)
    return Outcome(wall, pi + float(signs[-1] * np.atleast_1d(turned)[-1]))


def bushings(chain: Chain, h: float, steps: int, tolerance: float) -> Outcome:
    """Rigid or flexible panels in redundant coordinates on the same six-axis bushings as ours; implicit."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(item.ObjectGround())
    mirror = np.diag([1.0, -1.0, -1.0])
    points = (*INBOARD.values(), *OUTBOARD.values())
    hinges, inner = [], None
    for one in chain.placed():
        turn = WORLD @ rotation_matrix(one.orientation)
        body = model.add_body(system, chain.data, turn, WORLD @ np.array(one.position), points)
        axes = model.JOINT if one.axis[1] < 0.0 else model.JOINT @ mirror
        for side in INBOARD:
            if inner is None:
                place = chain.point(INBOARD[side]) * (0.0, 1.0, 0.0)
                marker = model.add_place(system, ground, place, axes)
            else:
                marker = model.add_marker(system, inner, OUTBOARD[side], axes)
            hinges.append(model.add_hinge(system, marker, body, INBOARD[side], side, axes))
        inner = body
    system.Assemble()
    wall = _solve(system, h, steps, tolerance, "implicit")
    angle = system.GetObjectOutput(hinges[-2], exudyn.OutputVariableType.Rotation)[2]
    return Outcome(wall, float(angle) + 0.5 * pi)
