"""A panel deploys by its spring, works while the spacecraft turns, and is folded back by a drive."""

import numpy as np

import orchestrator as fanfold

scene = fanfold.Scene("restow", until="60 s", tolerance=1e-3)
body = scene.base(
    "body",
    points={"left": [0, 0.565, 0], "right": [0, -0.565, 0]},
    free={"mass": "300 kg", "center_of_mass": [-0.5, 0, 0], "inertia": [60, 60, 60]},
)
panel = scene.body("panel", catalogue="workbench_panel", fidelity="rigid")
scene.hinge_line(
    "HL",
    body,
    panel,
    axis="+y",
    aligned_angle="180 deg",
    motor={"stowed": "2 N.m", "deployed": "1.2 N.m"},
    friction_preload="0.4 N.m",
    latch={"stiffness": "4000 N.m/rad", "damping_ratio": "10 %"},
    hinges={"hinge_left": ("left", "hl_left"), "hinge_right": ("right", "hl_right")},
)
thrust = [{"profile": "polyline", "times": [0, 15, 15.5, 16, 16.5, 17], "values": [0, 0, 2, 0, -2, 0]}]
scene.connection("thruster", "load", structure={"torque": thrust, "direction": [0, 1, 0], "frame": "body"},
    ports={"body": {"body": body, "point": "left"}})  # fmt: skip
scene.connection("fold", "drive", structure={"axis": [0, 1, 0], "profile": "step5"},
    parameters={"stiffness": 0, "aligned_angle": "180 deg", "start_time": "25 s", "duration": "20 s"},
    ports={"inboard": {"body": body, "point": "left"}, "outboard": {"body": panel, "point": "hl_left"}})  # fmt: skip
engaged = {"stiffness": "500 N.m/rad", "damping": "50 N.m.s/rad", "start_angle": "180 deg"}  # to end_angle
scene.event("restow", time="25 s", set={"HL": {"unlatch_command": 1}, "fold": engaged})

result = fanfold.simulate(scene, estimate=False)
angle, drive = result["hinge_left", "angle"], result["fold", "drive_torque"]
print(result.headline.verdict)
print(
    f"Angle {np.degrees(angle[-1]):.2f} deg at the end; the drive needs {abs(drive[:]).max():.2f} {drive.unit}."
)
