"""Links that their joints press towards Euler's load, which modes of first order know nothing of."""

import re
import warnings

import numpy as np
import pytest

import orchestrator as fanfold

LENGTH, MODULUS, WIDTH, HEIGHT = 2.0, 7e10, 0.04, 0.008
EULER = np.pi**2 * MODULUS * WIDTH * HEIGHT**3 / 12.0 / LENGTH**2


def column(share, pushed_along=(0.6, 0.0, 0.8), **keys):
    """A column on a pin, its top guided across; pressed there by a share of Euler's load."""
    scene = fanfold.Scene("column", until="20 ms", preload=True, tolerance=1e-3)
    x = np.array(pushed_along)
    base = scene.base(name="ground", points={"foot": (0, 0, 0)})
    rectangle = {
        "width": WIDTH,
        "height": HEIGHT,
        "youngs_modulus": MODULUS,
        "poisson_ratio": 0.3,
        "density": 2700.0,
    }
    beam = {"length": LENGTH, "rectangle": rectangle, "attachment_points": {"foot": 0, "top": LENGTH}}
    place = {"body": base, "point": "foot", "orientation": {"x": tuple(x), "z": (-x[2], 0.0, x[0])}}
    link = scene.body("link", fidelity="flexible", place=place, beam=beam, **keys)
    ends = {"inboard": (base, "foot"), "outboard": (link, "foot")}
    scene.connection("pin", preset="revolute", axes={"x": (0, 1, 0)}, ports=ends)
    scene.connection(
        "guide", "point_motion", ports={"inboard": (base, "foot"), "outboard": (link, "top")},
        parameters={"stiffness": 1e7, "damping": 100.0},
        structure={"axis": (-x[2], 0.0, x[0]), "law": [{"profile": "constant", "value": 0.0}]},
    )  # fmt: skip
    push = [{"profile": "constant", "value": share * EULER}]
    scene.connection(
        "push", "load", ports={"body": (link, "top")}, structure={"direction": tuple(-x), "force": push}
    )
    return scene


def told(scene):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        fanfold.simulate(scene, estimate=False)
    return [str(one.message) for one in found if "Euler" in str(one.message)]


def test_a_pressed_link_of_first_order_is_told_of():
    """Closed form: pi^2 E I / L^2 between pinned ends."""
    (sentence,) = told(column(0.5, second_order_modes=0))
    assert sentence.startswith("link: pin ")
    assert f" {0.5 * EULER:.4g} N" in sentence
    critical = float(re.search(r"\(([\d.e+]+) N\)", sentence)[1])
    assert critical == pytest.approx(EULER, rel=2e-3)


@pytest.mark.parametrize(
    ("share", "keys"),
    [
        (0.01, {"second_order_modes": 0}),
        (-0.5, {"second_order_modes": 0}),
        (0.5, {}),
        (0.5, {"second_order_modes": 8}),
    ],
)
def test_little_or_pulled_or_second_order_is_not(share, keys):
    assert told(column(share, **keys)) == []
