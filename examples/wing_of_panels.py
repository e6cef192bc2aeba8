"""A wing of any number of panels, built in a loop: folded like an accordion, opened by springs, latched one by one."""

import orchestrator as fanfold

EDGE = {"left": (0.0, 0.8, 0.0), "right": (0.0, -0.8, 0.0)}
TIP = {"tip_left": (1.5, 0.8, 0.0), "tip_right": (1.5, -0.8, 0.0)}
PANEL = {"mass": "8 kg", "center_of_mass": [0.75, 0, 0], "inertia": [2.7, 1.5, 4.2], "points": EDGE | TIP}
MOTOR = {"stowed": "1.2 N.m", "deployed": "0.8 N.m"}
LATCH = {"stiffness": "2000 N.m/rad", "effective_inertia": "2 kg.m2"}


def wing(count):
    """A scene of so many panels on a fixed spacecraft."""
    scene = fanfold.Scene(f"wing_of_{count}", until="30 s", tolerance=1e-3)
    body = scene.base("spacecraft", points={"tip_left": EDGE["left"], "tip_right": EDGE["right"]})
    for k in range(count):
        panel = scene.body(f"panel{k + 1}", rigid=PANEL)
        hinges = {f"{side}{k + 1}": (f"tip_{side}", side) for side in EDGE}
        turn = {"axis": "-y" if k % 2 else "+y", "aligned_angle": "180 deg" if k else "90 deg"}
        keys = {"motor": MOTOR, "latch": LATCH, "friction_preload": "0.05 N.m"}
        scene.hinge_line(f"HL{k + 1}", body, panel, hinges=hinges, **turn, **keys)
        body = panel
    return scene


result = fanfold.simulate(wing(4))
