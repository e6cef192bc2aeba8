"""What does play in the hinges of a panel change? Its vibration little, the loads of the hinges much."""

import numpy as np

import orchestrator as fanfold


def opened(clearance):
    """The run of a panel on two hinges whose pins have play in their holes and along the line."""
    scene = fanfold.Scene("loose_hinges", until="3 s", tolerance=1e-4)
    base = scene.base(points={"left": (0, -0.4, 0), "right": (0, 0.4, 0)})
    points = {"left": (0, -0.4, 0), "right": (0, 0.4, 0)}
    rigid = {"mass": 6, "center_of_mass": (0.6, 0, 0), "inertia": (0.5, 0.8, 1.3), "points": points}
    panel = scene.body("panel", rigid=rigid)
    scene.joint(
        axial_stiffness="2e6 N/m", radial_stiffness="5e6 N/m", cross_stiffness="2e4 N.m/rad",
        axial_clearance=clearance, radial_clearance=clearance,
    )  # fmt: skip
    scene.hinge_line(
        "HL", base, panel, axis="-y", aligned_angle="90 deg",
        motor={"stowed": "2 N.m", "deployed": "0.6 N.m"}, latch={"stiffness": "3000 N.m/rad"},
        hinges={"left": ("left", "left"), "right": ("right", "right")},
    )  # fmt: skip
    return fanfold.simulate(scene, estimate=False)


for clearance in ("0 mm", "0.1 mm", "0.5 mm"):
    run = opened(clearance)
    latched = run.time > run.latch_times["HL"]
    force = np.max([run[hinge, "radial_force"][:] for hinge in ("left", "right")], axis=0)
    torque = np.sum([run[hinge, "latch_torque"][:] for hinge in ("left", "right")], axis=0)[latched]
    crossings = run.time[latched][1:][np.diff(np.sign(torque)) != 0]
    print(
        f"{clearance}: latch torque up to {run.headline.latch_torque_peaks['HL']:.1f} N.m, vibration at "
        f"{0.5 / np.mean(np.diff(crossings)):.3f} Hz, hinge force up to {force[~latched].max():.0f} N while it "
        f"opens and {force[latched].max():.0f} N once it is latched"
    )
