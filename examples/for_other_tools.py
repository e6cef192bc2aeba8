"""The components of a scene as FMUs for other tools: written, checked, and one of them run in FMPy."""

from fmpy import read_model_description, simulate_fmu

import orchestrator as fanfold

paths = fanfold.export("amos3", "fmus", rigid="all")
damper = next(path for path in paths if path.stem == "damper")
problems = fanfold.check(damper)
description = read_model_description(str(damper))
names = [variable.name for variable in description.modelVariables if variable.causality == "output"]
inputs = {f"outboard.angular_velocity[{k + 1}]": value for k, value in enumerate((0.0, 0.5, 0.0))}
run = simulate_fmu(
    str(damper), fmi_type="CoSimulation", stop_time=0.1, output_interval=0.05, start_values=inputs,
    output=["damper_torque"],
)  # fmt: skip
torque = float(run["damper_torque"][-1])
print(f"{len(paths)} FMUs; the damper turned at 0.5 rad/s gives {torque:.3f} N.m")
