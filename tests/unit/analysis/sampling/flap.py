"""A flap about a line through its centre of mass, opened by a constant torque and caught by a spring: closed forms.

From rest it takes t = sqrt(2 angle J / T) to its latch, which it meets with the energy T angle.
"""

from math import pi, sqrt

import orchestrator as fanfold

INERTIA, ANGLE, STIFFNESS = 2.0, 0.5 * pi, 100.0
ENDS = ("hinge_line.line.motor.stowed", "hinge_line.line.motor.deployed")
MOTOR = ",".join(ENDS)


def flap(torque: float = 1.0, inertia: float = INERTIA, damping_ratio: float | None = None) -> fanfold.Scene:
    """Torque (N.m), inertia about the line (kg.m2), damping ratio of the latch where the default is not wanted."""
    scene = fanfold.Scene("flap", until="5 s", tolerance=1e-6)
    points = {"left": (0, 0.5, 0), "right": (0, -0.5, 0)}
    base = scene.base(points=points)
    body = scene.body(
        "flap", rigid={"mass": 5.0, "center_of_mass": (0, 0, 0), "inertia": (1, inertia, 1), "points": points}
    )
    scene.hinge_line(
        "line", base, body, axis="+y", aligned_angle=f"{ANGLE} rad", hinges={"left": "left", "right": "right"},
        motor={"stowed": torque, "deployed": torque},
        latch={"stiffness": STIFFNESS, "effective_inertia": inertia, "damping_ratio": damping_ratio},
    )  # fmt: skip
    return scene


def latch_time(torque: float = 1.0, inertia: float = INERTIA) -> float:
    """From release, s."""
    return sqrt(2.0 * ANGLE * inertia / torque)


def undamped_peak(torque: float = 1.0) -> float:
    """Of the latch's torque (N.m), where the motor goes on: k x with k x^2 / 2 = T (angle + x)."""
    return torque + sqrt(torque**2 + 2.0 * STIFFNESS * torque * ANGLE)
