"""Analyses of a loop whose lines do not know where others lead them: a four-bar linkage with one driven line."""

from math import acos, atan2, cos, degrees, hypot, radians, sin

import pytest

import orchestrator as fanfold

CRANK, COUPLER, ROCKER, GROUND = 0.6, 1.2, 0.9, 1.3


def coupler_angle(crank):
    """Angle (deg) by which the second line turns the coupler back, of the upper triangle; textbook trigonometry."""
    x, z = GROUND - CRANK * cos(radians(crank)), -CRANK * sin(radians(crank))
    diagonal = hypot(x, z)
    inner = acos((COUPLER**2 + diagonal**2 - ROCKER**2) / (2.0 * COUPLER * diagonal))
    return crank - degrees(atan2(z, x) + inner)


def four_bar():
    scene = fanfold.Scene("four-bar", until=6.0)
    scene.base("deck", points={"o": [0, 0, 0], "d": [GROUND, 0, 0]})
    for name, length, end in (("crank", CRANK, "b"), ("coupler", COUPLER, "c")):
        points = {"a" if end == "b" else "b": [0, 0, 0], end: [length, 0, 0]}
        inertia = [0.01, 0.1, 0.1]
        scene.body(
            name,
            rigid={"mass": 2.0, "center_of_mass": [0.5 * length, 0, 0], "inertia": inertia, "points": points},
        )
    rocker = {
        "mass": 4.0,
        "center_of_mass": [0.5, 0, 0],
        "inertia": [0.02, 0.7, 0.7],
        "points": {"d": [0, 0, 0], "c": [ROCKER, 0, 0]},
    }
    placed = {"body": "deck", "point": "d", "orientation": {"x": [0.3, 0, 1], "z": [-1, 0, 0.3]}}
    scene.body("rocker", place=placed, rigid=rocker)
    scene.hinge_line(
        "drive", inboard="deck", outboard="crank", axis="-y", aligned_angle=0.0, start_angle="20 deg",
        latch_angle="110 deg", motor={"stowed": "3 N.m", "deployed": "2 N.m"},
        latch={"stiffness": "2000 N.m/rad", "effective_inertia": "2 kg.m2"},
        hinges=[{"name": "h1", "inboard": "o", "outboard": "a"}],
    )  # fmt: skip
    scene.hinge_line(
        "mid", inboard="crank", outboard="coupler", axis="+y", aligned_angle=0.0,
        start_angle=f"{coupler_angle(20.0)} deg", hinges=[{"name": "h2", "inboard": "b", "outboard": "b"}],
    )  # fmt: skip
    for name, inboard, outboard in (
        ("top", ("coupler", "c"), ("rocker", "c")), ("foot", ("deck", "d"), ("rocker", "d"))
    ):  # fmt: skip
        ports = {
            side: {"body": body, "point": point}
            for side, (body, point) in (("inboard", inboard), ("outboard", outboard))
        }
        scene.connection(name, preset="revolute", axes={"x": [0, 1, 0]}, ports=ports)
    return scene


def test_where_a_loop_leads_a_line_is_no_error_of_its_scene():
    """Regression: the check took the angle at which the second line is aligned for the one that it opens to."""
    assert fanfold.check_scene(four_bar()).warnings == ()


@pytest.mark.parametrize("as_posed", [False, True])
def test_angles_that_tear_a_loop_are_refused(as_posed):
    """Closed form: the other line's angle. Regression: modes of the torn loop, or no word of what was wrong."""
    with pytest.raises(fanfold.FanfoldError, match=r"connection\.top: .* mid at"):
        fanfold.modes(four_bar(), angles={"drive": radians(110.0)}, latched="drive", as_posed=as_posed)
    angles = {"drive": radians(110.0), "mid": radians(coupler_angle(110.0))}
    found = fanfold.modes(four_bar(), angles=angles, latched="drive", as_posed=as_posed)
    assert (found.frequencies > 0.0).all()
