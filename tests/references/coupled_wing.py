"""A wing of three equal panels whose first and last line a coupler ties, and its equations of motion in the plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import orchestrator as fanfold

Vector = NDArray[np.float64]
RATIO, MOTORS = 0.5, (3.0, 0.4, -0.2)
"""HL1 per HL3; N.m of the lines, the last against opening."""
_TO_PANELS = np.array(((1.0, 0.0, 0.0), (1.0, -1.0, 0.0), (1.0, -1.0, 1.0)))
"""Turns of panels about +y per angle of lines about +y, -y, +y."""
_FREE = np.array(((RATIO, 0.0), (0.0, 1.0), (1.0, 0.0)))
"""Angles of lines by those of HL3 and HL2."""


def coupled_wing(until: float = 1.0, **gear: float) -> fanfold.Scene:
    """The wing, folded; gear: parameters of the coupler."""
    scene = fanfold.Scene("coupled_wing", until=until, preload=False)
    scene.base(points={"tip_left": (0, 0.2, 0), "tip_right": (0, -0.2, 0)})
    outer = "base"
    for number, (axis, torque) in enumerate(zip(("+y", "-y", "+y"), MOTORS, strict=True), 1):
        name = f"panel{number}"
        panel = {
            "length": 1.0, "width": 0.6, "areal_mass": 3.0, "hinge_lines": {"inboard": "root", "outboard": "tip"},
            "arm": {"y": 0.2, "length": 0.04, "patch": 0.06, "point_mass": 0.0},
            "sandwich": {"skin": "0.2 mm", "core": "20 mm", "youngs_modulus": "70 GPa", "poisson_ratio": 0.3},
        }  # fmt: skip
        scene.body(name, panel=panel)
        hinges = [
            {"name": f"hinge{number}", "inboard": "tip_left", "outboard": "root_left"},
            {
                "name": f"other{number}",
                "inboard": "tip_right",
                "outboard": "root_right",
                "kind": "cylindrical",
            },
        ]
        scene.hinge_line(
            f"HL{number}", outer, name, axis=axis, aligned_angle="90 deg" if number == 1 else "180 deg",
            motor={"stowed": torque, "deployed": torque}, hinges=hinges,
        )  # fmt: skip
        outer = name
    scene.connection(
        "coupler", "gear", structure={"second_carrier": True}, parameters={"ratio": RATIO, **gear},
        ports={"first": ("panel1", "root_left"), "carrier": ("base", "tip_left"),
               "second": ("panel3", "root_left"), "second_carrier": ("panel2", "tip_left")},
    )  # fmt: skip
    return scene


def motion(scene: fanfold.Scene, times: Vector) -> tuple[Vector, Vector]:
    """Angles (rad) of the lines over time (t, 3) with a rigid coupler, and the torque (N.m) in it on panel 1.

    Lagrange's equations of a chain of rigid panels in the plane, by their turns against space.
    """
    placed = scene.check()
    model, length = placed.rigid_models["panel1"], placed.points["panel1"]["tip_left"][0]
    mass, arm, inertia = model.mass, model.center_of_mass[0], model.inertia[1, 1]
    further = np.arange(3)[::-1] * length
    masses = mass * length * (arm + further[np.maximum.outer(range(3), range(3))])
    np.fill_diagonal(masses, inertia + mass * (arm**2 + length * further))
    torques = np.array(MOTORS)

    def turns(free: Vector) -> Vector:
        return _TO_PANELS @ (_FREE @ free - np.radians((90.0, 180.0, 180.0)))

    def terms(free: Vector, rates: Vector) -> tuple[Vector, Vector]:
        apart = np.subtract.outer(turns(free), turns(free))
        return masses * np.cos(apart), (masses * np.sin(apart)) @ (_TO_PANELS @ _FREE @ rates) ** 2

    def accelerations(free: Vector, rates: Vector) -> Vector:
        matrix, bias = terms(free, rates)
        ways = _TO_PANELS @ _FREE
        return np.linalg.solve(ways.T @ matrix @ ways, _FREE.T @ torques - ways.T @ bias)

    def change(_: float, state: Vector) -> Vector:
        return np.concatenate((state[2:], accelerations(state[:2], state[2:])))

    found = solve_ivp(change, (0.0, times[-1]), np.zeros(4), t_eval=times, rtol=1e-11, atol=1e-12).y.T
    carried = []
    for state in found:
        matrix, bias = terms(state[:2], state[2:])
        forces = matrix @ _TO_PANELS @ _FREE @ accelerations(state[:2], state[2:]) + bias
        carried.append((_TO_PANELS.T @ forces - torques)[0])
    return found[:, :2] @ _FREE.T, np.array(carried)
