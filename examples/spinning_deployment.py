"""Two booms deploy by the spin of their spacecraft; angular momentum says how fast it turns afterwards."""

import orchestrator as fanfold

INERTIA = [0.002, 0.24, 0.24]  # kg.m2
BOOM = {"mass": "2 kg", "center_of_mass": ["0.6 m", 0, 0], "inertia": INERTIA, "points": {"root": [0, 0, 0]}}
# axis, aligned angle, x of the hinge
SIDES = {"right": ("+y", "90 deg", 0.5), "left": ("-y", "-90 deg", -0.5)}

scene = fanfold.Scene("spinning_deployment", until="4 s")
hub = scene.base(
    "hub",
    points={side: [x, 0, 0] for side, (_, _, x) in SIDES.items()},
    free={"mass": "80 kg", "inertia": [6, 6, 9], "angular_velocity": [0, 0, "20 rpm"]},
)
for side, (axis, aligned, _) in SIDES.items():
    boom = scene.body(f"boom_{side}", rigid=BOOM)
    scene.hinge_line(
        f"HL_{side}",
        hub,
        boom,
        axis=axis,
        aligned_angle=aligned,
        latch_angle="90 deg",  # the booms point along z when stowed
        start_rate="2 deg/s",
        friction_preload="0.05 N.m",
        latch={"stiffness": "2000 N.m/rad", "damping_ratio": "10 %"},
        hinges={f"hinge_{side}": (side, "root")},
    )

start = fanfold.check_scene(scene).start_motion
result = fanfold.simulate(scene, estimate=False)
spin = result["hub", "attitude_rate"][:][:, 2]
deployed = 9.0 + 2.0 * (0.24 + 2.0 * 1.1**2)  # kg.m2 about z: hub and booms
print(result.headline.verdict)
print(
    f"spin {spin[0]:.3f} rad/s before, {spin[-1]:.4f} after, {start.angular_momentum[2] / deployed:.4f} expected"
)
