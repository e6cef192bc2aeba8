"""How a wing as one FMU turns the spacecraft of another tool, which holds mean loads from impulses over a step."""

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from scipy.spatial.transform import Rotation

import orchestrator as fanfold

MASS, INERTIA, CENTER = (
    500.0,
    200.0,
    np.array([-1.0, 0.0, 0.0]),
)  # kg; kg.m2 about any axis; m from the base's origin
UNTIL = 3.0
wing = fanfold.load("workbench").with_settings({"scene.tolerance": 1e-6})
(path,) = fanfold.export(wing, ".", rigid="all", as_one=True, driven_base=True)
description, folder = read_model_description(str(path)), extract(str(path))
references = {variable.name: variable.valueReference for variable in description.modelVariables}


def places(name):
    return [references[f"workbench_table.{name}[{axis}]"] for axis in (1, 2, 3)]


def deploy(step):
    """Turn of the spacecraft about y (rad) at the end, by communication steps of a size (s)."""
    identifier = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(
        guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="wing"
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    moves = ("velocity", "angular_velocity", "acceleration", "angular_acceleration")
    drives = [place for name in moves for place in places(name)]
    impulses = places("interface_impulse") + places("interface_angular_impulse")
    turn, velocity, spin = Rotation.identity(), np.zeros(3), np.zeros(3)  # of the centre of mass, world axes
    acceleration, spin_rate, before = np.zeros(3), np.zeros(3), np.zeros(6)
    for k in range(round(UNTIL / step)):
        arm = turn.apply(-CENTER)
        rates = velocity + np.cross(spin, arm)
        change = acceleration + np.cross(spin_rate, arm) + np.cross(spin, np.cross(spin, arm))
        fmu.setReal(drives, [*rates, *spin, *change, *spin_rate])
        fmu.doStep(k * step, step)
        now = np.array(fmu.getReal(impulses))
        load, before = (now - before) / step, now  # means over the step, axes of the base, about its origin
        middle = turn * Rotation.from_rotvec(turn.inv().apply(0.5 * step * spin))
        acceleration = middle.apply(load[:3]) / MASS
        spin_rate = middle.apply(load[3:] - np.cross(CENTER, load[:3])) / INERTIA
        turn = Rotation.from_rotvec(step * (spin + 0.5 * step * spin_rate)) * turn
        velocity, spin = velocity + step * acceleration, spin + step * spin_rate
    fmu.terminate()
    fmu.freeInstance()
    return turn.as_rotvec()[1]


free = {"mass": MASS, "center_of_mass": CENTER.tolist(), "inertia": [INERTIA] * 3}
whole = fanfold.simulate(wing.with_settings({"base.free": free}), rigid="all", until=UNTIL, estimate=False)
expected = whole["workbench_table", "attitude"][-1][1]
error = {step: abs(deploy(step) / expected - 1.0) for step in (0.04, 0.02)}
for step, found in error.items():
    print(f"steps of {step} s: the spacecraft's turn of {np.degrees(expected):.3f} deg within {found:.1e}")
