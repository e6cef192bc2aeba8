"""Pieces of Exudyn models with the numbers of Fanfold: bodies of modal data, bushings, a fast and silent solver.

Exudyn at its best, as measured: module without range checks, modes orthonormal and invariants ready, motor and
latch inside the bushings (no user functions), three mesh nodes a point, modified Newton, generalised-alpha, no
files. The model's world is turned so that hinge lines are along x and no rotation parameter becomes singular.
"""

from __future__ import annotations

import sys
from math import pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from components.contract.frames import skew
from components.flexible.modal import ModalData
from tests.benchmark.models.one_panel import AXIAL, CROSS, RADIAL
from tests.benchmark.stability import JOINT_DAMPING, MOTOR_STIFFNESS, MOTOR_WIND_UP

sys.exudynFast = getattr(sys, "exudynFast", True)  # type: ignore[attr-defined]
try:
    import exudyn
    from exudyn import itemInterface as item
except ImportError:
    raise SystemExit("Exudyn is missing; install it with: pip install '.[benchmark]'") from None

WORLD = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Our world's axes -> those of the model here, whose x axis is along the hinge line."""
JOINT = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Axes of a joint at the base, in columns; z is the direction about which the panel opens."""
QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Turns the joint on the panel, so that its angle is the hinge angle minus pi/2 and never wraps."""
ARM = 0.02
exudyn.config.printToConsole = False


class Steps(NamedTuple):
    """Numbers of the solver: step sizes before and after the latch (s), Newton's relative tolerance."""

    free: float
    latched: float
    tolerance: float = 1e-5
    spectral_radius: float = 0.9


def pose(rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    """A homogeneous transformation."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, position
    return matrix


def add_place(system: Any, ground: Any, place: np.ndarray, axes: np.ndarray) -> Any:
    """A marker on the ground at a place (m, our world), its axes those of a joint."""
    return system.AddMarker(item.MarkerBodyRigid(bodyNumber=ground, localHT=pose(axes, WORLD @ place)))


def add_hinge(
    system: Any, inboard: Any, body: BodyIn, point: str, side: str, axes: np.ndarray = JOINT
) -> Any:
    """A hinge between a marker with the axes of the joint and a point of a body."""
    return _add_bushing(system, inboard, add_marker(system, body, point, axes @ QUARTER), side)


def _add_bushing(system: Any, inboard: Any, outboard: Any, side: str) -> Any:
    """A hinge with its motor spring; its angle is the hinge angle minus pi/2."""
    axial = AXIAL if side == "left" else 0.0
    stiffness = np.diag([RADIAL, RADIAL, axial, CROSS, CROSS, 0.0])
    damping = JOINT_DAMPING * stiffness
    stiffness[5, 5] = 0.5 * MOTOR_STIFFNESS
    return system.AddObject(
        item.ObjectConnectorRigidBodySpringDamper(
            markerNumbers=[inboard, outboard],
            stiffness=stiffness,
            damping=damping,
            offset=[0.0] * 5 + [MOTOR_WIND_UP - 0.5 * pi],
        )
    )


class BodyIn(NamedTuple):
    """A body in a model: its object, its data, and the points that markers can sit on, in order."""

    item: Any
    data: ModalData
    points: tuple[str, ...]


def add_body(
    system: Any, data: ModalData, turn: np.ndarray, origin: np.ndarray, points: tuple[str, ...]
) -> BodyIn:
    """A rigid or modal body whose construction frame has an orientation and an origin in the model's world."""
    angles = exudyn.rigidBodyUtilities.RotationMatrix2RotXYZ(turn)
    place = origin + turn @ data.center_of_mass
    frame = system.AddNode(item.NodeRigidBodyRxyz(referenceCoordinates=[*place, *angles]))
    if data.frequency.size:
        return BodyIn(system.AddObject(_modal_body(system, frame, data, points)), data, points)
    inertia = [data.inertia[i] for i in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    rigid = item.ObjectRigidBody(nodeNumber=frame, mass=data.mass, inertia=inertia)
    return BodyIn(system.AddObject(rigid), data, points)


def add_marker(system: Any, body: BodyIn, point: str, axes: np.ndarray) -> Any:
    """A marker at a point, its axes given in the model's world for the body in its construction pose."""
    turn = WORLD.T @ axes
    if not body.data.frequency.size:
        place = pose(turn, _arm(body.data, point))
        return system.AddMarker(item.MarkerBodyRigid(bodyNumber=body.item, localHT=place))
    first = 3 * body.points.index(point)
    return system.AddMarker(
        item.MarkerSuperElementRigid(
            bodyNumber=body.item,
            localHT=pose(turn, np.zeros(3)),
            meshNodeNumbers=[first, first + 1, first + 2],
            weightingFactors=[1.0 / 3.0] * 3,
        )
    )


def _arm(data: ModalData, point: str) -> np.ndarray:
    arm: np.ndarray = data.point_positions[data.point_names.index(point)] - data.center_of_mass
    return arm


def _modal_body(system: Any, frame: int, data: ModalData, points: tuple[str, ...]) -> Any:
    """Fanfold's modal data as a floating frame of reference: the same modes, damping and invariants.

    Exudyn's terms are the invariants I5, I8 and I9 with other signs and order. Each point becomes three nodes of
    an imagined mesh around it, which move as its translation and rotation say; a marker of equal weights on them
    is the point.
    """
    modes = data.frequency.size
    modal = system.AddNode(
        item.NodeGenericODE2(
            numberOfODE2Coordinates=modes,
            referenceCoordinates=[0.0] * modes,
            initialCoordinates=[0.0] * modes,
            initialCoordinates_t=[0.0] * modes,
        )
    )
    around = [(ARM, 0.0, 0.0), (-0.5 * ARM, 0.0, sqrt(0.75) * ARM), (-0.5 * ARM, 0.0, -sqrt(0.75) * ARM)]
    places, shapes = [], []
    for point in points:
        i = data.point_names.index(point)
        for arm in around:
            places.append(_arm(data, point) + arm)
            shapes.append(data.translation[i] - skew(np.array(arm)) @ data.rotation[i])
    matrix = exudyn.MatrixContainer
    return item.ObjectFFRFreducedOrder(
        nodeNumbers=[frame, modal],
        massMatrixReduced=matrix(np.eye(modes)),
        stiffnessMatrixReduced=matrix(np.diag(data.frequency**2)),
        dampingMatrixReduced=matrix(np.diag(2.0 * data.damping_ratio * data.frequency)),
        modeBasis=np.vstack(shapes),
        referencePositions=np.concatenate(places),
        mass=data.mass,
        inertia=data.inertia,
        centerOfMass=[0.0, 0.0, 0.0],
        mPsiTildePsi=-data.invariant5.reshape(3 * modes, modes),
        mPsiTildePsiTilde=-data.invariant9.transpose(0, 2, 1, 3).reshape(3 * modes, 3 * modes),
        mPhitTPsi=np.zeros((3, modes)),
        mPhitTPsiTilde=np.zeros((3, 3 * modes)),
        mXRefTildePsi=np.zeros((3, modes)),
        mXRefTildePsiTilde=-data.invariant8.transpose(1, 0, 2).reshape(3, 3 * modes),
    )


def quiet_settings(steps: Steps) -> Any:
    """Settings of the solver: fast and silent."""
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 0.0
    settings.solution.sensors.active = False
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.adaptiveStep = False
    integration.generalizedAlpha.spectralRadius = steps.spectral_radius
    integration.newton.relativeTolerance = steps.tolerance
    return settings
