"""Does a coupler of the first and the last line of AMOS-3 keep the wing in step? HL2 is then free."""

import numpy as np

import orchestrator as fanfold


def wing(name):
    """AMOS-3 with its cable loops, or with a coupler in their place."""
    scene = fanfold.load("amos3", settings={} if name == "cable loops" else {"ccl": []})
    if name == "coupler":
        ports = {
            "carrier": ("spacecraft", "hl1"), "first": ("yoke", "hl1"),
            "second_carrier": ("panel1", "hl3_left"), "second": ("panel2", "hl3_left"),
        }  # fmt: skip
        values = {"ratio": 0.5, "stiffness": "2e4 N.m/rad", "damping": "2 N.m.s/rad"}
        scene.connection(
            "coupler", "gear", ports=ports, structure={"second_carrier": True}, parameters=values
        )
    return scene


for name in ("cable loops", "coupler"):
    run = fanfold.simulate(wing(name), rigid="all", until="16 s", tolerance=1e-3, estimate=False)
    moving = run.time < min(run.latch_times.values())
    shares = [run[hinge, "angle"][moving] / angle for hinge, angle in
              (("hl1_hinge", np.pi / 2), ("hl2_left", np.pi), ("hl3_left", np.pi))]  # fmt: skip
    apart = [f"{100 * np.abs(share - shares[0]).max():.0f} %" for share in shares[1:]]
    torque = (
        f", coupler {np.abs(run['coupler', 'gear_torque'][:]).max():.1f} N.m" if name == "coupler" else ""
    )
    times = ", ".join(f"{line} {time:.2f} s" for line, time in run.latch_times.items())
    print(f"{name}: {times}; HL2 and HL3 are up to {' and '.join(apart)} of the way from HL1{torque}")
