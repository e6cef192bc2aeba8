"""How does a boom on a tape spring, a component of one's own, open and come to rest? Also as an FMU."""

from pathlib import Path

import numpy as np

import orchestrator as fanfold

PLUGIN = Path(__file__).parent / "plugins" / "tape_spring.py"
boom = fanfold.Scene("boom", until="12 s", tolerance=1e-3, plugins=[str(PLUGIN)])
base = boom.base(points={"root": (0, 0, 0)})
points = {"root": (0, 0, 0), "tip": (1, 0, 0)}
arm = boom.body(
    "arm", rigid={"mass": 1.0, "center_of_mass": (0.5, 0, 0), "inertia": (0.001, 0.1, 0.1), "points": points}
)
boom.hinge_line(
    "root_line", base, arm, axis="+y", aligned_angle="120 deg", latch_angle="230 deg", hinges={"root": "root"}
)
ports = {"inboard": {"body": base, "point": "root"}, "outboard": {"body": arm, "point": "root"}}
boom.connection("tape", "tape_spring", structure={"axis": (0, -1, 0)}, ports=ports)

run = fanfold.simulate(boom, estimate=False)
angle, torque = run["tape", "angle"], run["tape", "tape_torque"]
arrival = run.time[np.argmax(angle[:] < 0.1)]
print(f"straight after {arrival:.2f} s, then within {np.degrees(np.ptp(angle[:][run.time > 11.0])):.3f} deg")
print(
    f"torque up to {np.max(np.abs(torque[:])):.2f} N.m; {run['tape', 'dissipated_energy'][-1]:.3f} J of heat"
)
run.plot("tape_spring_loads").savefig("tape_spring_loads.png")
fmus = fanfold.export(boom, "fmus")
