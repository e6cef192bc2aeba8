"""How do two panels open on tape springs, and do the springs stay straight? They fold twice to the other side first."""

import numpy as np

import orchestrator as fanfold

TAPE = {  # a pair of carpenter's tapes back to back, SI units
    "radius": 0.0133, "subtended_angle": 1.5, "thickness": 1e-4, "length": 0.1,
    "youngs_modulus": 131e9, "poisson_ratio": 0.3, "opposite": 1, "equal": 1,
}  # fmt: skip
D = TAPE["youngs_modulus"] * TAPE["thickness"] ** 3 / (12 * (1 - TAPE["poisson_ratio"] ** 2))
steady = 2 * D * TAPE["subtended_angle"]  # of one tape in each sense, (1 + nu) D a + (1 - nu) D a

wing = fanfold.Scene("tape_spring_wing", until="16 s", tolerance=1e-3)
inboard = wing.base(points={"root": (0, 0, 0)})
points = {"root": (0, 0, 0), "tip": (0.4, 0, 0)}
rigid = {"mass": 0.3, "center_of_mass": (0.2, 0, 0), "inertia": (1e-3, 4e-3, 5e-3), "points": points}
for name, point, axis, folded in (("inner", "root", "+y", "90 deg"), ("outer", "tip", "-y", "180 deg")):
    panel, sign = wing.body(name, rigid=rigid), 1 if axis == "+y" else -1
    line = f"{name}_line"
    wing.hinge_line(line, inboard, panel, axis=axis, aligned_angle=folded, hinges=[
        {"name": f"{name}_hinge", "inboard": point, "outboard": "root"}])  # fmt: skip
    wing.connection(
        f"{name}_tape", "tape_hinge", structure={"axis": (0, -sign, 0), "tape": TAPE},
        parameters={"stowed_angle": folded, "damping": "2e-3 N.m.s/rad"},
        ports={"inboard": {"body": inboard, "point": point}, "outboard": {"body": panel, "point": "root"}},
    )  # fmt: skip
    inboard = panel

run = fanfold.simulate(wing, estimate=False)
for name in ("inner", "outer"):
    torque, straight = run[f"{name}_tape", "tape_torque"], run[f"{name}_tape", "straight"]
    arrival = run.time[np.argmax(straight[:] > 0.5)]
    print(
        f"{name}: opens at {abs(torque[0]):.4f} N.m (published {steady:.4f}), straight from {arrival:.2f} s"
    )
print(f"energy residual {run.headline.energy_residual:.1e}")
