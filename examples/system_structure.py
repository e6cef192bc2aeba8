"""A panel as one SSP file, run in FMPy: a parameter of the file is changed, and a port commands the latch."""

from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv

import orchestrator as fanfold

fmu, ssp = fanfold.export("workbench", "panel", rigid="all", as_one=True, ssp="workbench.ssp")
system = read_ssd(str(ssp)).system
print("ports:", ", ".join(port.name for port in system.connectors if port.name.startswith("HL")))

parameters = read_ssv(str(ssp), system.parameterBindings[0].source)
parameters.parameters = [p for p in parameters.parameters if p.name == "workbench.hinge_left.motor_stiffness"]
parameters.parameters[0].value = "0.2"  # N.m/rad

options = {"stop_time": 4.3, "step_size": 0.1}
runs = {
    "as exported": simulate_ssp(str(ssp), **options),
    "stiffer spring": simulate_ssp(str(ssp), parameter_set=parameters, **options),
    "latch commanded": simulate_ssp(
        str(ssp), input={"HL_latch_command": lambda time: float(time > 0.95)}, **options
    ),
}
for name, rows in runs.items():
    print(f"{name}: latched at {rows['HL_latch_time'][-1]:.4f} s")
