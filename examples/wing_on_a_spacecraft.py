"""A rigid spacecraft that carries the AMOS-3 wing as one FMU, in NumPy and FMPy: the recipe by impulses."""

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from scipy.spatial.transform import Rotation

import orchestrator as fanfold

MASS, INERTIA = 1200.0, np.diag([800.0, 800.0, 800.0])  # kg, kg.m2
CENTRE = np.array([-1.0, 0.0, 0.0])  # m, centre of mass from the origin of the frame, body axes
STEP, END = 10e-3, 14.0  # s

(fmu,) = fanfold.export("amos3", "driven", rigid="all", as_one=True, driven_base=True)
description = read_model_description(fmu)
references = {variable.name: variable.valueReference for variable in description.modelVariables}
wing = FMU2Slave(
    guid=description.guid,
    unzipDirectory=extract(fmu),
    modelIdentifier=description.coSimulation.modelIdentifier,
)


def vector(name):
    """Value references of a vector of the base."""
    return [references[f"spacecraft.{name}[{axis}]"] for axis in (1, 2, 3)]


def impulses():
    """Impulse (N.s) and angular impulse (N.m.s) on the spacecraft since the start, body axes."""
    return np.array([wing.getReal(vector(f"interface_{name}")) for name in ("impulse", "angular_impulse")])


def accelerations(turn, rate, force, torque):
    """Acceleration of the centre, world axes, and of the rotation, body axes."""
    torque = torque - np.cross(CENTRE, force)
    return turn.apply(force) / MASS, np.linalg.solve(INERTIA, torque - np.cross(rate, INERTIA @ rate))


wing.instantiate()
wing.setupExperiment(startTime=0.0)
wing.enterInitializationMode()
wing.exitInitializationMode()
velocity, rate, turn = np.zeros(3), np.zeros(3), Rotation.identity()  # rate in body axes
force, torque, before = np.zeros(3), np.zeros(3), impulses()
for index in range(round(END / STEP)):
    # 1. The wing makes the step first, with the motion of the frame at its start.
    linear, angular = accelerations(turn, rate, force, torque)
    arm, spin, turning = turn.apply(CENTRE), turn.apply(rate), turn.apply(angular)
    centripetal = np.cross(spin, np.cross(spin, arm))
    wing.setReal(vector("velocity"), velocity - np.cross(spin, arm))
    wing.setReal(vector("angular_velocity"), spin)
    wing.setReal(vector("acceleration"), linear - np.cross(turning, arm) - centripetal)
    wing.setReal(vector("angular_acceleration"), turning)
    wing.doStep(index * STEP, STEP)
    # 2. The mean load of the step is the growth of the impulses over the step, divided by the step.
    after = impulses()
    (force, torque), before = (after - before) / STEP, after
    # 3. The spacecraft makes the same step under this load (midpoint rule).
    middle = turn * Rotation.from_rotvec(0.5 * STEP * rate)
    linear, angular = accelerations(middle, rate, force, torque)
    _, angular = accelerations(middle, rate + 0.5 * STEP * angular, force, torque)
    turn = turn * Rotation.from_rotvec(STEP * (rate + 0.5 * STEP * angular))
    velocity, rate = velocity + STEP * linear, rate + STEP * angular

lines = ("HL3", "HL2", "HL1")
latch_times = dict(
    zip(lines, wing.getReal([references[f"{line}.latch_time"] for line in lines]), strict=True)
)
for line, time in latch_times.items():
    print(line, f"{time:.6f} s")
print("attitude at the end, deg:", np.degrees(turn.as_rotvec()).round(4))
wing.terminate()
wing.freeInstance()
