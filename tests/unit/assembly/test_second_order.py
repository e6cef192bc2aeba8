"""How many modes of second order a body gets where its scene states none."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.second_order import (
    held_frequency,
    joint_places,
    low_second_order,
    second_order_modes,
    ways_through,
)
from orchestrator.scene.bodies import body_model

LENGTH, BENDING, LINE_MASS = 1.2, 700.0, 1.5
SECTION = {
    "axial": 3e6, "shear_y": 1e8, "shear_z": 1e8, "torsion": 900.0, "bending_y": BENDING, "bending_z": 9e4,
    "line_mass": LINE_MASS, "inertia_y": 1e-7, "inertia_z": 1e-2,
}  # fmt: skip
FIRST_CLAMPED = 3.51602 * np.sqrt(BENDING / LINE_MASS) / LENGTH**2


def wing(preload=0.0, spin=0.0, **keys):
    """Two beams in a row behind a base, strands of a cable loop along the first."""
    scene = fanfold.Scene("wing", until="1 s")
    law = [{"profile": "ramp", "duration": 100.0, "change": 100.0 * spin}]
    base = scene.base(points={"h": (0, 0, 0)}, **({"motion": {"rotation": law}} if spin else {}))
    beam = {"length": LENGTH, "attachment_points": {"root": 0, "tip": LENGTH}, "section": SECTION}
    inner = scene.body("inner", beam=beam, **keys)
    outer = scene.body("outer", like="inner")
    scene.hinge_line("L1", base, inner, axis="+y", aligned_angle="180 deg", hinges={"h1": ("h", "root")})
    scene.hinge_line("L2", inner, outer, axis="-y", aligned_angle="180 deg", hinges={"h2": ("tip", "root")})
    if preload:
        pulleys = {
            "pulley_1": {"body": base, "point": "h", "radius": 0.03},
            "pulley_2": {"body": outer, "point": "root", "radius": 0.03},
        }
        scene.ccl("loop", preload=preload, strand_stiffness=4000.0, **pulleys)
    return scene


def chosen(scene):
    """Of both beams."""
    return [second_order_modes(part) for part in assemble(scene.check()).parts if part.kind == "body"]


def way_of(scene):
    """Between both joints of the inner beam."""
    checked = scene.check()
    body = checked.bodies[0]
    (way,) = ways_through(low_second_order(body, 0), joint_places(checked, body))
    return way


def test_eulers_load_of_a_pinned_beam():
    """Closed form: pi^2 E I / L^2; modes from the third on bend out at the next one, by four times as much or more."""
    way, euler = way_of(wing()), np.pi**2 * BENDING / LENGTH**2
    assert way.span == pytest.approx(LENGTH)
    assert way.euler() == pytest.approx(euler, rel=1e-3)
    assert way.euler(2) > 3.0 * euler


def test_eulers_load_of_a_pinned_panel():
    """Closed form of a narrow strip without Poisson's effect: pi^2 D B / L^2."""
    rigidity, width = 50.0, 0.1
    scene = fanfold.Scene("strip", until="1 s")
    base = scene.base(points={"h": (0, 0, 0)})
    edges = [
        {"name": name, "x": x, "y": 0.0, "rectangles": [{"x": [x - 0.01, x + 0.01], "y": [-0.05, 0.05]}]}
        for name, x in (("root", 0.01), ("tip", 0.99))
    ]
    layer = {"thickness": (12 * rigidity / 7e10) ** (1 / 3), "youngs_modulus": 7e10, "poisson_ratio": 0.0}
    panel = {
        "length": 1.0,
        "width": width,
        "start": 0,
        "areal_mass": 2.0,
        "element_size": 0.025,
        "inserts": edges,
    }
    strip = scene.body("strip", panel={**panel, "layers": [{**layer, "shear_modulus": 3.5e10}]})
    scene.hinge_line("L", base, strip, axis="+y", aligned_angle="180 deg", hinges={"h": ("h", "root")})
    scene.connection("end", "load", ports={"body": (strip, "tip")}, structure={"direction": (1.0, 0.0, 0.0)})
    # rigid inserts leave 0.96 m to bend, pinned in their middles; the closed form is within their share of the length
    assert way_of(scene).euler() == pytest.approx(np.pi**2 * rigidity * width / 0.96**2, rel=0.05)


def test_modes_are_chosen_by_what_presses():
    """Definition: up to the last mode that both strands take 1 % of; none where nothing presses, or of the tip."""
    assert chosen(wing()) == [0, 0]
    taken = np.diag(way_of(wing()).taken)
    for preload in (15.0, 40.0, 400.0):
        shares = 2.0 * preload * np.abs(taken)
        (last,) = np.flatnonzero(shares > 0.01)[-1:] if (shares > 0.01).any() else (-1,)
        assert chosen(wing(preload)) == [last + 1, 0]
    assert chosen(wing(15.0)) == [0, 0]
    assert chosen(wing(40.0))[0] == 1


@pytest.mark.parametrize("stated", [0, 5])
def test_a_stated_number_stays(stated):
    assert chosen(wing(400.0, second_order_modes=stated)) == [stated, stated]


def test_the_first_frequency_of_a_clamped_beam():
    """Closed form: 3.516 root(E I / m) / L^2."""
    data = body_model(wing().check().bodies[0], flexible=True)
    assert held_frequency(data, [["root"]]) == pytest.approx(FIRST_CLAMPED, rel=1e-3)


@pytest.mark.parametrize(("share", "all_of_them"), [(0.2, True), (0.05, False)])
def test_spin_takes_all(share, all_of_them):
    """Definition: a rate whose square is over 1 % of that of the first mode, clamped at a joint."""
    scene = wing(spin=share * FIRST_CLAMPED)
    modes = [
        np.size(part.structure["modal"]["frequency"])
        for part in assemble(scene.check()).parts
        if part.kind == "body"
    ]
    assert chosen(scene) == (modes if all_of_them else [0, 0])


def test_fewer_than_all_are_warned_of_in_spin():
    with pytest.warns(fanfold.FanfoldWarning, match=r"\[W-spin\]"):
        fanfold.modes(wing(spin=0.2 * FIRST_CLAMPED, second_order_modes=8))
