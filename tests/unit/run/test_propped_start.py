"""A beam on a pin and a prop starts as it stays, whatever else the scene has: large deformation, what moves freely."""

import numpy as np
import pytest

import orchestrator as fanfold
from fmus import native_library

pytestmark = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")

LENGTH, WIDTH, HEIGHT, DENSITY = 2.0, 0.04, 0.008, 2700.0
HALF_WEIGHT = 0.5 * LENGTH * WIDTH * HEIGHT * DENSITY * 9.81
STIFFNESS = 1e7


def propped(pin="revolute", fidelity="flexible"):
    """A strip under gravity, a pin at its root and a law that keeps its tip level."""
    scene = fanfold.Scene("propped", until="20 ms", preload=True, gravity=(0, 0, -9.81))
    base = scene.base(name="ground", points={"root": (0, 0, 0), "far": (5, 0, 0)})
    rectangle = {
        "width": WIDTH,
        "height": HEIGHT,
        "youngs_modulus": 7e10,
        "poisson_ratio": 0.3,
        "density": DENSITY,
    }
    beam = {
        "length": LENGTH,
        "elements": 16,
        "rectangle": rectangle,
        "attachment_points": {"root": 0, "tip": LENGTH},
    }
    strip = scene.body("strip", fidelity=fidelity, place={"body": base, "point": "root"}, beam=beam)
    ends = {"inboard": (base, "root"), "outboard": (strip, "root")}
    scene.connection("pin", preset=pin, axes={"x": (0, 1, 0)}, ports=ends)
    directions = {"prop": (0, 0, 1)} | ({"guide": (0, 1, 0)} if pin == "spherical" else {})
    for name, axis in directions.items():
        scene.connection(
            name, "point_motion", ports={"inboard": (base, "root"), "outboard": (strip, "tip")},
            parameters={"stiffness": STIFFNESS, "damping": 100.0},
            structure={"axis": axis, "law": [{"profile": "constant", "value": 0.0}]},
        )  # fmt: skip
    return scene


def beside(scene, offset):
    """What turns on a joint of its own, far away: a balanced wheel, or a pendulum 30 degrees from hanging."""
    axes = {"x": (0.5, 0, -np.sqrt(0.75)), "z": (np.sqrt(0.75), 0, 0.5)}
    body = {
        "mass": 1.0,
        "center_of_mass": (offset, 0, 0),
        "inertia": (0.01,) * 3,
        "points": {"hub": (0, 0, 0)},
    }
    scene.body("bob", place={"body": "ground", "point": "far", "orientation": axes}, rigid=body)
    ends = {"inboard": ("ground", "far"), "outboard": ("bob", "hub")}
    scene.connection("pivot", preset="revolute", axes={"x": (0, 1, 0)}, ports=ends)
    return scene


CASES = {
    "alone": propped,
    "of large deformation": lambda: propped(fidelity="large_deformation"),
    "beside a wheel": lambda: beside(propped(), 0.0),
    "free along its pin": lambda: propped("cylindrical"),
    "free to roll": lambda: propped("spherical", "rigid"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_pin_carries_no_moment_from_the_start(case):
    """Statics: the prop bears half of the weight, and goes on to. Regression: all pins were held, 6.36 N for 8.48."""
    result = fanfold.simulate(CASES[case](), estimate=False)
    load = -STIFFNESS * result.signal("prop", "distance")
    assert load == pytest.approx(np.full(load.size, HALF_WEIGHT), rel=1e-3)


def test_what_falls_to_hang_before_the_start_is_told():
    """Statics: it hangs; the strip beside it is none the worse."""
    with pytest.warns(fanfold.FanfoldWarning, match="bob starts 30 deg .*W-preload"):
        result = fanfold.simulate(beside(propped(), 0.5), estimate=False)
    assert -STIFFNESS * result.signal("prop", "distance")[0] == pytest.approx(HALF_WEIGHT, rel=1e-3)
