"""Plates without stretching that bend by more than their thickness, between what holds them."""

import warnings

import pytest

import orchestrator as fanfold

SIDE, RIM = 1.0, 0.05
FRAME = [
    {"x": [0.0, SIDE], "y": [-0.5 * SIDE, RIM - 0.5 * SIDE]},
    {"x": [0.0, SIDE], "y": [0.5 * SIDE - RIM, 0.5 * SIDE]},
    {"x": [0.0, RIM], "y": [-0.5 * SIDE, 0.5 * SIDE]},
    {"x": [SIDE - RIM, SIDE], "y": [-0.5 * SIDE, 0.5 * SIDE]},
]


def foil(insert):
    """A millimetre of aluminium under gravity, held at one rigid insert."""
    scene = fanfold.Scene("foil", until="1 ms", preload=True, gravity=(0, 0, -9.81))
    base = scene.base(points={"p": (0, 0, 0)})
    layer = {"thickness": 1e-3, "youngs_modulus": 7e10, "poisson_ratio": 0.3, "shear_modulus": 2.7e10}
    panel = {
        "length": SIDE, "width": SIDE, "start": 0, "areal_mass": 2.7, "element_size": 0.05, "layers": [layer],
        "face_sheets": {"thickness": 1e-3}, "inserts": [{"name": "hold", "x": 0.0, "y": 0.0, **insert}],
    }  # fmt: skip
    body = scene.body("foil", fidelity="flexible", place={"body": base, "point": "p"}, panel=panel)
    scene.connection("clamp", preset="fixed", ports={"inboard": (base, "p"), "outboard": (body, "hold")})
    return scene


def test_a_foil_in_a_frame_is_told_to_be_beyond_its_theory():
    """Clamped square plate: 0.00126 q L^4 / D. Regression: a frame of one piece was taken for a single point."""
    stiffness, load, free = 7e10 * 1e-9 / (12 * (1 - 0.09)), 2.7 * 9.81, SIDE - 2 * RIM
    with pytest.warns(fanfold.FanfoldWarning, match="foil .* 3.4 times .* 1 mm.*W-linear-plate") as told:
        fanfold.simulate(foil({"rectangles": FRAME}), estimate=False)
    (sentence,) = (str(one.message) for one in told if one.message.code == "W-linear-plate")
    assert float(sentence.split()[3]) * 1e-3 == pytest.approx(0.00126 * load * free**4 / stiffness, rel=0.1)


def test_a_foil_that_hangs_from_one_edge_bends_without_stretching():
    edge = [{"x": [0.0, RIM], "y": [-0.5 * SIDE, 0.5 * SIDE]}]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        fanfold.simulate(foil({"rectangles": edge}), estimate=False)
    assert not [one for one in told if "W-linear-plate" in str(one.message)]
