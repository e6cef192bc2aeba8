"""A slider-crank on a rail against an independent solution.

That is in one coordinate: Lagrange's equation of the crank angle by DOP853; rail and revolutes are stiff.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import orchestrator as fanfold

GRAVITY = 9.81
CRANK, ROD, SLIDER = (0.2, 1.2, 0.006), (0.5, 2.0, 0.05), 1.5
"""Length (m), mass (kg) and inertia about the middle (kg.m2); mass of the slider."""


def slider_crank(angle, rate, until):
    """Crank angle over time: T = m(q) q'^2 / 2 in the plane x-z, gravity along -z, slider along x."""
    (r, m1, j1), (rod, m2, j2) = CRANK, ROD

    def tilt(q):
        """Of the rod below x, sin b = r sin q / l, and db/dq with its derivative."""
        sine = r * np.sin(q) / rod
        cosine = np.sqrt(1.0 - sine**2)
        slope = r * np.cos(q) / (rod * cosine)
        return sine, cosine, slope, (-r * np.sin(q) / rod + sine * slope**2) / cosine

    def middle(q):
        """First and second derivative by q of the rod's middle, and of the slider's place."""
        sine, cosine, slope, bend = tilt(q)
        x = -r * np.sin(q) - 0.5 * rod * sine * slope
        xx = -r * np.cos(q) - 0.5 * rod * (cosine * slope**2 + sine * bend)
        z, zz = 0.5 * r * np.cos(q), -0.5 * r * np.sin(q)
        s = -r * np.sin(q) - rod * sine * slope
        ss = -r * np.cos(q) - rod * (cosine * slope**2 + sine * bend)
        return x, xx, z, zz, s, ss

    def rates(t, y):
        q, w = y
        *_, slope, bend = tilt(q)
        x, xx, z, zz, s, ss = middle(q)
        mass = j1 + 0.25 * m1 * r**2 + m2 * (x * x + z * z) + j2 * slope**2 + SLIDER * s * s
        change = m2 * (x * xx + z * zz) + j2 * slope * bend + SLIDER * s * ss
        push = -GRAVITY * (0.5 * m1 * r * np.cos(q) + m2 * z)
        return w, (push - change * w * w) / mass

    return solve_ivp(
        rates, (0.0, until), (angle, rate), method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True
    )


def link(name, length, mass, inertia, start, angle):
    """A bar from `start` at an angle from x towards z; its inertia about y is what the plane feels."""
    ends = {"a": (0.0, 0.0, 0.0), "b": (length, 0.0, 0.0)}
    rigid = {
        "mass": mass,
        "center_of_mass": (0.5 * length, 0, 0),
        "inertia": (1e-3, inertia, inertia),
        "points": ends,
    }
    along = (float(np.cos(angle)), 0.0, float(np.sin(angle)))
    place = {"body": "base", "point": "pivot", "offset": start, "orientation": {"x": along}}
    return {"name": name, "rigid": rigid, "place": place}


def pinned(scene, name, first, second):
    """A revolute about y."""
    ports = {
        side: {"body": body, "point": point}
        for side, (body, point) in zip(("inboard", "outboard"), (first, second), strict=True)
    }
    scene.connection(name, "hinge", ports=ports, preset="revolute", axes={"x": (0, 1, 0)})


@pytest.mark.parametrize("angle", [40.0, 120.0])
def test_a_slider_crank_falls(angle):
    """Independent solution in the crank's angle, over a half turn and loads of 100 N.

    What is left is the joints' give: 9.8e-4 rad with 5e6 N/m, 1.8e-4 with 5e7, so below 1e-4 of the way.
    """
    until, q = 0.5, np.radians(angle)
    (r, m1, j1), (rod, m2, j2) = CRANK, ROD
    tilt = np.arcsin(r * np.sin(q) / rod)
    tip = (r * float(np.cos(q)), 0.0, r * float(np.sin(q)))
    scene = fanfold.Scene(
        "slider_crank", until=until, largest_step=5e-3, gravity=(0, 0, -GRAVITY), tolerance=1e-4
    )
    scene.joint(radial_stiffness=5e7, axial_stiffness=5e7)
    scene.base(points={"pivot": (0, 0, 0)})
    scene.body(**link("crank", r, m1, j1, (0, 0, 0), q))
    scene.body(**link("rod", rod, m2, j2, tip, -tilt))
    place = {"body": "base", "point": "pivot", "offset": (tip[0] + rod * float(np.cos(tilt)), 0, 0)}
    points = {"pin": (0.0, 0.0, 0.0)}
    scene.body("slider", rigid={"mass": SLIDER, "inertia": (1e-2,) * 3, "points": points}, place=place)
    pinned(scene, "main", ("base", "pivot"), ("crank", "a"))
    pinned(scene, "crank_pin", ("crank", "b"), ("rod", "a"))
    pinned(scene, "slider_pin", ("rod", "b"), ("slider", "pin"))
    scene.connection(
        "rail", "rail", ports={"trolley": {"body": "slider", "point": "pin"}}, structure={"normal": (0, 0, 1)},
        parameters={
            "normal_stiffness": 1e8, "normal_damping": 1e4, "rotational_stiffness": 1e5, "rotational_damping": 10.0,
        },
    )  # fmt: skip
    result = fanfold.simulate(scene, estimate=False)
    turned = result["main", "angle"]
    expected = slider_crank(q, 0.0, until).sol(turned.time)[0] - q
    # about y, what turns from x to z turns to minus
    assert np.abs(turned[:] + expected).max() < 1e-4 * np.ptp(expected)
    assert np.ptp(expected) > 1.0
    assert np.abs(result["slider", "frame_position"][:][:, 2]).max() < 2e-5
