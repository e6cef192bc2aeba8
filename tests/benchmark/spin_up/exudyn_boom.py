"""The spin-up beam in Exudyn's own solution: geometrically exact beams in the plane, the root's turn prescribed.

Generalised-alpha with a modified Newton method and a module without range checks; nothing is written to files. The law
of the root is a function in Python, called a few times a step.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from math import cos, pi
from time import perf_counter
from typing import Any

import numpy as np

from components.contract.component import Vector
from tests.references.spin_up import LENGTH, RATE, RISE, SECTION

sys.exudynFast = getattr(sys, "exudynFast", True)  # type: ignore[attr-defined]
try:
    import exudyn
    from exudyn import itemInterface as item
except ImportError:
    raise SystemExit("Exudyn is missing; install it with: pip install '.[benchmark]'") from None

exudyn.config.printToConsole = False
_WAVE = 2.0 * pi / RISE


def _turn(_system: Any, t: float, _item: int, _offset: float) -> float:
    if t > RISE:
        return RATE * (t - 0.5 * RISE)
    return RATE / RISE * (0.5 * t * t + (cos(_WAVE * t) - 1.0) / _WAVE**2)


def _model(elements: int) -> tuple[Any, Any]:
    """The system, assembled at rest, and the sensor of the tip's displacement."""
    system = exudyn.SystemContainer().AddSystem()
    places = np.linspace(0.0, LENGTH, elements + 1)
    nodes = [system.AddNode(item.NodeRigidBody2D(referenceCoordinates=[x, 0, 0])) for x in places]
    for pair in pairwise(nodes):
        system.AddObject(
            item.ObjectBeamGeometricallyExact2D(
                nodeNumbers=list(pair),
                length=LENGTH / elements,
                massPerLength=SECTION["line_mass"],
                crossSectionInertia=SECTION["inertia_z"],
                bendingStiffness=SECTION["bending_z"],
                axialStiffness=SECTION["axial"],
                shearStiffness=SECTION["shear_y"],
            )
        )
    ground = system.AddNode(item.NodePointGround())
    still = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for coordinate in range(3):
        root = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
        law = {"offsetUserFunction": _turn} if coordinate == 2 else {}
        system.AddObject(item.ObjectConnectorCoordinate(markerNumbers=[still, root], **law))
    sensor = system.AddSensor(
        item.SensorNode(
            nodeNumber=nodes[-1],
            storeInternal=True,
            writeToFile=False,
            outputVariableType=exudyn.OutputVariableType.Position,
        )
    )
    system.Assemble()
    return system, sensor


def spin_up(elements: int, h: float, until: float) -> tuple[float, Vector, Vector]:
    """Wall time (s) of the solution, times (T,) and positions (T, 3) of the tip."""
    system, sensor = _model(elements)
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps = until, round(until / h)
    newton = integration.newton
    newton.useModifiedNewton = True
    # its own tolerance is below the round-off of the joints: twenty times the time, the same motion to 1e-6 m
    newton.relativeTolerance, newton.absoluteTolerance = 1e-6, 1e-5
    integration.generalizedAlpha.spectralRadius = 0.9
    integration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = h
    start = perf_counter()
    system.SolveDynamic(settings)
    wall = perf_counter() - start
    rows = system.GetSensorStoredData(sensor)
    return wall, rows[:, 0], rows[:, 1:4]
