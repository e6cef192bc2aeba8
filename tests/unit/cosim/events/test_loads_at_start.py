"""Loads of t = 0 without preload: what acts at once is there at once, and no step is early enough to see it."""

import pytest

import orchestrator as fanfold

MOTOR, FRICTION = 300.0, 40.0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_a_motor_loads_the_base_before_friction_of_its_line_has_grown(tolerance):
    """Definition: at rest smooth friction is zero, so that the base first bears all of the motor's torque.

    A line with little inertia leaves its rest within a microsecond. Regression: the first row bore nothing, and the
    peak was that of the first step, from 260 to 281 N.m by the tolerance, with an error of 1e-7.
    """
    scene = fanfold.Scene("flap", until=0.02, tolerance=tolerance)
    scene.base("ground", points={"o": [0, 0, 0]})
    scene.body(
        "flap",
        rigid={"mass": 0.3, "center_of_mass": [0.1, 0, 0], "inertia": [1e-3, 1e-2, 1e-2], "points": {"p": [0, 0, 0]}},
    )  # fmt: skip
    scene.hinge_line(
        "root", inboard="ground", outboard="flap", axis="+y", aligned_angle="172 deg", friction_preload=FRICTION,
        motor={"stowed": MOTOR, "deployed": 0.5 * MOTOR}, hinges=[{"name": "h", "inboard": "o", "outboard": "p"}],
    )  # fmt: skip
    scene.friction(law="smooth")
    run = fanfold.simulate(scene, estimate=False)
    assert run["ground", "interface_torque"][0, 1] == pytest.approx(-MOTOR, rel=1e-5)
    assert run.headline.interface_torque_peaks[1] == pytest.approx(MOTOR, rel=1e-5)
    assert run["h", "angle"][0] == 0.0
