"""How a spacecraft that its deploying wing turns comes back, with a controller of another tool in the loop."""

from pathlib import Path

import numpy as np
from pythonfmu.builder import FmuBuilder

import orchestrator as fanfold

CONTROLLER = Path(__file__).parent / "controllers" / "attitude_controller.py"
fmu = FmuBuilder.build_FMU(str(CONTROLLER), dest=".")

wing = fanfold.load("amos3", "free")
free = fanfold.simulate(wing, rigid="all", tolerance=1e-2, until=14, estimate=False)

wheel = wing.connection(
    "wheel", "load", ports={"body": {"body": "spacecraft", "point": "hl1"}},
    structure={"direction": (0, 1, 0), "frame": "body"},
)  # fmt: skip
wing.fmu(
    "controller", fmu, step="0.25 s", parameters={"damping": 600.0},
    inputs={"angle": "spacecraft.attitude[2]", "rate": "spacecraft.attitude_rate[2]"},
    outputs={"torque": f"{wheel}.added_torque"},
)  # fmt: skip
controlled = fanfold.simulate(wing, rigid="all", tolerance=1e-2, until=40, estimate=False)

attitude = {
    name: np.degrees(run["spacecraft", "attitude"][:, 1])
    for name, run in (("free", free), ("controlled", controlled))
}
for name, angle in attitude.items():
    print(f"{name}: {np.max(np.abs(angle)):.2f} deg at most, {angle[-1]:.3f} deg at the end")
torque = controlled["controller", "torque"]
print(f"the controller asks for up to {np.max(np.abs(torque[:])):.2f} N.m")
