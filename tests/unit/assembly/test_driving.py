"""What drives a scene, and runs of scenes that little drives."""

import warnings

import pytest

import orchestrator as fanfold
from orchestrator.assembly import Driving
from orchestrator.assembly.assemble import assemble

SLOWER = 1e4
"""Times as slow is a run at a torque this often smaller, squared: torque times time squared tells the angle."""


def flap(torque, until, **motor):
    scene = fanfold.Scene("flap", until=until, tolerance=1e-3, largest_step=0.02 * until)
    scene.base("ground", points={"o": [0, 0, 0]})
    scene.body(
        "flap",
        rigid={"mass": 2.0, "center_of_mass": [0.5, 0, 0], "inertia": [0.01, 0.2, 0.2], "points": {"p": [0, 0, 0]}},
    )  # fmt: skip
    if torque:
        motor["motor"] = {"stowed": torque, "deployed": 0.5 * torque}
    scene.hinge_line(
        "root", inboard="ground", outboard="flap", axis="+y", aligned_angle="90 deg",
        hinges=[{"name": "h", "inboard": "o", "outboard": "p"}], **motor,
    )  # fmt: skip
    return scene


def angle_at_end(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return fanfold.simulate(scene, estimate=False)["h", "angle"][-1]


def test_a_small_torque_is_no_round_off():
    """Similarity: a torque 1e8 times smaller turns as far in 1e4 times the time.

    Regression: wrenches were iterated to a part of 1 N.m, beside which this one was none: no line moved, with an error
    of zero.
    """
    usual, slow = flap(0.1, 2.0), flap(0.1 / SLOWER**2, 2.0 * SLOWER)
    assert angle_at_end(usual) > 0.1
    assert angle_at_end(slow) == pytest.approx(angle_at_end(usual), rel=1e-3)


@pytest.mark.thorough
def test_a_small_load_is_no_round_off():
    """Closed form: half of the angular acceleration times time squared, in the first degrees of a constant torque."""
    torque, until = 2e-10, 20000.0
    scene = flap(0.0, until)
    scene.connection(
        "push", "load", structure={"torque": [{"profile": "constant", "value": torque}], "direction": [0, 1, 0]},
        ports={"body": {"body": "flap", "point": "p"}},
    )  # fmt: skip
    assert angle_at_end(scene) == pytest.approx(0.5 * torque / (0.2 + 2.0 * 0.25) * until**2, rel=1e-3)


@pytest.mark.parametrize(("torque", "load"), [(0.0, 1.0), (4.0, 1.0), (0.25, 0.25), (1e-6, 1e-6)])
def test_iterations_end_beside_what_drives_but_no_more_than_one(torque, load):
    found = assemble(flap(torque, 1.0).check()).driving
    assert found == Driving(found.energy, load)
    assert bool(found.energy) == bool(torque)
