"""Linkages with preload start in the equilibrium of their pins, which carry no torque; pendulums stay held."""

import numpy as np
import pytest

import orchestrator as fanfold


def carried(*, by_motion):
    """A bar of 10 kg under 1 g in a pin at its end, its centre of mass carried by a motion at rest, or by nothing."""
    scene = fanfold.Scene("carried", until="0.2 s", preload=True, gravity=(0, 0, -9.81))
    ground = scene.base("ground", points={"o": (0, 0, 0)})
    bar = scene.body(
        "bar", place={"body": ground, "point": "o"},
        rigid={
            "mass": 10, "center_of_mass": (0.5, 0, 0), "inertia": (0.1, 1, 1),
            "points": {"a": (0, 0, 0), "c": (0.5, 0, 0)},
        },
    )  # fmt: skip
    pin = {"inboard": (ground, "o"), "outboard": (bar, "a")}
    scene.connection("pin", preset="revolute", axes={"x": (0, 1, 0)}, ports=pin)
    if by_motion:
        law = [{"profile": "constant", "value": 0.0}]
        ports = {"inboard": (ground, "o"), "outboard": (bar, "c")}
        scene.connection("carrier", "point_motion", structure={"law": law}, ports=ports)
    return scene


def test_a_pin_is_free_where_something_else_carries_its_body():
    """Statics: the motion carries all 98.1 N. Regression: the pin was held, took 8 N and let go at t = 0: 108.5 N.

    To 1e-3: joints and drive of 1e7 N/m give way by 1e-5 of the lever.
    """
    run = fanfold.simulate(carried(by_motion=True), estimate=False)
    np.testing.assert_allclose(run["ground", "interface_force"][:, 2], -98.1, rtol=1e-3)


def test_the_equilibrium_with_preload_is_the_one_runs_begin_with():
    """Statics, as above, and 49.05 N.m of a pendulum that only its pin holds. Regression: 90.1 N, as pins were held."""
    found = fanfold.equilibrium(carried(by_motion=True), preload=True)
    assert found.loads["carrier"]["motion_force"][0] == pytest.approx(98.1, rel=1e-9)
    assert found.loads["pin"]["radial_force"][0] == pytest.approx(0.0, abs=1e-9)
    pendulum = fanfold.equilibrium(carried(by_motion=False), preload=True)
    assert pendulum.loads["pin"]["hinge_torque[1]"][0] == pytest.approx(-49.05, rel=1e-9)


def test_a_pendulum_starts_where_it_was_drawn():
    """A quarter of a turn from where it would hang: nothing but the hold of its pin keeps it there until t = 0."""
    run = fanfold.simulate(carried(by_motion=False), estimate=False)
    np.testing.assert_allclose(run["bar", "frame_orientation"][0], (1.0, 0.0, 0.0, 0.0), atol=1e-3)
