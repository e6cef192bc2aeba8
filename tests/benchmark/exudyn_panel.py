"""The panel of `one_panel` as a monolithic Exudyn model: modal floating frame, six-axis bushings, same latch.

    python -m tests.benchmark.exudyn_panel

prints how its latch time and latch torque peak converge to Fanfold's. Exudyn at its best, as measured: module
without range checks, modes orthonormal and invariants ready, motor and latch inside the bushings (no user
functions, two connectors), three mesh nodes a hinge, modified Newton, generalised-alpha, no files, sensors after
latch-up only, a step size before the latch and one after it. The run stops a step before the latch angle,
a secant iteration finds the instant, and the solver starts again with the latch in the bushings.
"""

from __future__ import annotations

import sys
from math import pi, sqrt
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from components._frames import skew
from components.modal import ModalData
from orchestrator.master import Settings
from orchestrator.run import as_fmus
from tests.benchmark.one_panel import (
    AXIAL,
    CROSS,
    RADIAL,
    SIDES,
    UNTIL,
    Subject,
    Trial,
    couple,
    crest,
    subjects,
)
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
ANGLE, RATE = exudyn.OutputVariableType.Rotation, exudyn.OutputVariableType.AngularVelocityLocal


class Steps(NamedTuple):
    """Numbers of the solver: step sizes before and after the latch (s), Newton's relative tolerance."""

    free: float
    latched: float
    tolerance: float = 1e-5
    spectral_radius: float = 0.9


class Panel:
    """The model, assembled, stowed and at rest."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        ground = self.system.AddObject(item.ObjectGround())
        markers = self._body(subject.data)
        self.bushings = [
            self._bushing(ground, marker, side) for side, marker in zip(SIDES, markers, strict=True)
        ]
        self.sensors = [[self._sensor(bushing, kind) for kind in (ANGLE, RATE)] for bushing in self.bushings]
        self.system.Assemble()

    def _body(self, data: ModalData) -> list[Any]:
        """The panel in its stowed pose; returns its markers on the hinge line."""
        turn = WORLD @ np.diag([-1.0, 1.0, -1.0])
        center = turn @ data.center_of_mass
        angles = exudyn.rigidBodyUtilities.RotationMatrix2RotXYZ(turn)
        frame = self.system.AddNode(item.NodeRigidBodyRxyz(referenceCoordinates=[*center, *angles]))
        arms = {
            side: data.point_positions[data.point_names.index(f"hl_{side}")] - data.center_of_mass
            for side in SIDES
        }
        if data.frequency.size:
            body = self.system.AddObject(modal_body(self.system, frame, data))
            return [
                self.system.AddMarker(
                    item.MarkerSuperElementRigid(
                        bodyNumber=body,
                        localHT=pose(WORLD.T @ JOINT @ QUARTER, np.zeros(3)),
                        meshNodeNumbers=[3 * k, 3 * k + 1, 3 * k + 2],
                        weightingFactors=[1.0 / 3.0] * 3,
                    )
                )
                for k in range(len(SIDES))
            ]
        entries = [data.inertia[i] for i in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
        body = self.system.AddObject(item.ObjectRigidBody(nodeNumber=frame, mass=data.mass, inertia=entries))
        turned = WORLD.T @ JOINT @ QUARTER
        return [
            self.system.AddMarker(item.MarkerBodyRigid(bodyNumber=body, localHT=pose(turned, arm)))
            for arm in arms.values()
        ]

    def _bushing(self, ground: Any, marker: Any, side: str) -> Any:
        place = pose(JOINT, WORLD @ (0.0, SIDES[side], 0.0))
        on_ground = self.system.AddMarker(item.MarkerBodyRigid(bodyNumber=ground, localHT=place))
        axial = AXIAL if side == "left" else 0.0
        stiffness = np.diag([RADIAL, RADIAL, axial, CROSS, CROSS, 0.0])
        damping = JOINT_DAMPING * stiffness
        stiffness[5, 5] = 0.5 * MOTOR_STIFFNESS
        return self.system.AddObject(
            item.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=[on_ground, marker],
                stiffness=stiffness,
                damping=damping,
                offset=[0.0] * 5 + [MOTOR_WIND_UP - 0.5 * pi],
            )
        )

    def _sensor(self, bushing: Any, kind: Any) -> Any:
        return self.system.AddSensor(
            item.SensorObject(
                objectNumber=bushing, storeInternal=True, writeToFile=False, outputVariableType=kind
            )
        )

    def gap(self) -> float:
        """Angle still to go to the latch, at the sensor hinge (rad)."""
        return 0.5 * pi - float(self.system.GetObjectOutput(self.bushings[0], ANGLE)[2])

    def latch(self) -> None:
        """Put the latch into the bushings, beside the motor."""
        motor, latch = 0.5 * MOTOR_STIFFNESS, 0.5 * self.subject.stiffness
        free = (motor * (MOTOR_WIND_UP - 0.5 * pi) + latch * 0.5 * pi) / (motor + latch)
        for bushing in self.bushings:
            stiffness = np.array(self.system.GetObjectParameter(bushing, "stiffness"))
            damping = np.array(self.system.GetObjectParameter(bushing, "damping"))
            stiffness[5, 5] = motor + latch
            damping[5, 5] = 0.5 * self.subject.damping
            self.system.SetObjectParameter(bushing, "stiffness", stiffness)
            self.system.SetObjectParameter(bushing, "damping", damping)
            self.system.SetObjectParameter(bushing, "offset", [0.0] * 5 + [free])

    def latch_torque(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and magnitudes of the line's latch torque, from latch-up on."""
        torque: Any = 0.0
        for angle, rate in self.sensors:
            turned, turning = (self.system.GetSensorStoredData(sensor) for sensor in (angle, rate))
            torque = torque + 0.5 * self.subject.stiffness * (turned[:, 3] - 0.5 * pi)
            torque = torque + 0.5 * self.subject.damping * turning[:, 3]
        return turned[:, 0], np.abs(torque)


def pose(rotation: np.ndarray, position: np.ndarray) -> np.ndarray:
    """A homogeneous transformation."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, position
    return matrix


def modal_body(system: Any, frame: int, data: ModalData) -> Any:
    """Fanfold's modal data as a floating frame of reference: the same modes, damping and invariants.

    Exudyn's terms are the invariants I5, I8 and I9 with other signs and order. Each hinge point becomes three
    nodes of an imagined mesh around it, which move as its translation and rotation say; a marker of equal
    weights on them is the point.
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
    for side in SIDES:
        i = data.point_names.index(f"hl_{side}")
        for arm in around:
            places.append(data.point_positions[i] - data.center_of_mass + arm)
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


def deploy(subject: Subject, steps: Steps, until: float = UNTIL) -> Trial:
    """One run; building and assembling the model is not timed."""
    panel = Panel(subject)
    settings = quiet_settings(steps)
    start = perf_counter()
    try:
        latch = _reach_latch(panel, settings, steps.free)
        panel.latch()
        settings.solution.sensors.active = True
        _solve(panel, settings, latch, until, steps.latched)
    except ValueError:  # what a solver that fails raises
        return Trial(np.nan, np.nan, perf_counter() - start, 0)
    wall = perf_counter() - start
    count = round(latch / steps.free) + round((until - latch) / steps.latched)
    return Trial(latch, crest(*panel.latch_torque()), wall, count)


def _solve(panel: Panel, settings: Any, start: float, end: float, h: float, *, keep: bool = True) -> None:
    integration = settings.timeIntegration
    integration.startTime, integration.endTime = start, end
    integration.numberOfSteps = max(1, int(np.ceil((end - start) / h - 1e-9)))
    panel.system.SolveDynamic(settings, updateInitialValues=keep)


def _reach_latch(panel: Panel, settings: Any, h: float) -> float:
    """Step freely until the next step would pass the latch angle, then end a step on it; returns the time."""
    gaps = [panel.gap(), panel.gap()]

    def goes_on(system: Any, time: float) -> bool:
        """Called before every step; a step refused here is still made, so it looks one further ahead."""
        gaps[:] = gaps[1], panel.gap()
        return gaps[1] + 2.1 * (gaps[1] - gaps[0]) > 0.0

    panel.system.SetPreStepUserFunction(goes_on)
    _solve(panel, settings, 0.0, h * np.ceil(2.0 * UNTIL / h), h)
    panel.system.SetPreStepUserFunction(0)
    start, before = panel.system.systemData.GetTime(), panel.gap()
    tried, found, trial = 0.0, before, before * h / (gaps[1] - before)
    for _ in range(8):
        _solve(panel, settings, start, start + trial, trial, keep=False)
        gap = panel.gap()
        if abs(gap) < 1e-12 or gap == found:
            break
        tried, found, trial = trial, gap, trial - gap * (trial - tried) / (gap - found)
        if abs(trial - tried) < 1e-9 * h:
            break
    _solve(panel, settings, start, start + trial, trial)
    return float(start + trial)


def main() -> None:
    """Print the convergence of every subject."""
    for subject in subjects().values():
        assembly = subject.assembly()
        _, tight = couple(as_fmus(assembly), assembly, Settings(tolerance=1e-6))
        print(f"\n{subject.name}; Fanfold at 1e-6: latch {tight.latch:.7f} s, peak {tight.peak:.4f} N.m")
        print(
            f"{'free step':>10}{'latched':>10}{'latch, s':>12}{'error':>10}{'peak':>11}{'error':>10}{'wall, s':>9}"
        )
        for steps in (Steps(1e-2, 3e-3), Steps(5e-3, 2e-3), Steps(2e-3, 1e-3), *tight_steps()):
            found = deploy(subject, steps)
            print(
                f"{steps.free:>10g}{steps.latched:>10g}{found.latch:>12.7f}{found.latch / tight.latch - 1.0:>10.1e}"
                f"{found.peak:>11.4f}{found.peak / tight.peak - 1.0:>10.1e}{found.wall:>9.3f}"
            )


def tight_steps() -> tuple[Steps, Steps]:
    """Two runs whose difference shows that the second has converged."""
    return Steps(1e-3, 5e-4, 1e-6), Steps(5e-4, 2.5e-4, 1e-6)


if __name__ == "__main__":
    main()
