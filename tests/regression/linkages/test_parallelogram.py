"""A parallelogram of four bars whose pivots are hinge lines that open to nowhere: closed forms of its motion."""

from __future__ import annotations

import warnings
from math import cos, radians, sqrt

import pytest

import orchestrator as fanfold
from components.numerics.scheme import INSTANT
from orchestrator.analysis.torque_margin.undriven import uncounted, without_margin
from orchestrator.scene import read_scene

CRANK, COUPLER, MASSES, INERTIA = 0.5, 1.0, (2.0, 3.0), 0.05
TORQUE, FROM, TO, END = 0.5, radians(30.0), radians(80.0), 1.5


def _bar(mass, length):
    return {
        "mass": mass,
        "center_of_mass": (0.5 * length, 0, 0),
        "inertia": (0.01, INERTIA, INERTIA),
        "points": {"root": (0, 0, 0), "tip": (length, 0, 0)},
    }


def _scene(latch="spring", closing="spherical"):
    """Two cranks on the base, one with a motor, and a coupler that stays parallel to the base, closed by a joint."""
    scene = fanfold.Scene("four_bar", until=END, tolerance=1e-6)
    scene.joint(axial_stiffness=1e7, radial_stiffness=1e7, cross_stiffness=1e5)
    base = scene.base(points={"a": (0, 0, 0), "b": (COUPLER, 0, 0)})
    near, far = (scene.body(name, rigid=_bar(MASSES[0], CRANK)) for name in ("near", "far"))
    coupler = scene.body("coupler", rigid=_bar(MASSES[1], COUPLER))
    angles = {"aligned_angle": "0 rad", "stowed_angle": f"{FROM} rad"}
    scene.hinge_line(
        "driven", base, near, axis="-y", hinges={"driven_hinge": ("a", "root")}, latch_angle=f"{TO} rad",
        motor={"stowed": TORQUE, "deployed": TORQUE}, latch={"stiffness": 500, "kind": latch}, **angles,
    )  # fmt: skip
    scene.hinge_line("pivot", base, far, axis="-y", hinges={"pivot_hinge": ("b", "root")}, **angles)
    scene.hinge_line("elbow", near, coupler, axis="+y", hinges={"elbow_hinge": ("tip", "root")}, **angles)
    scene.connection(
        "closing", preset=closing, axes={"x": (0, 1, 0), "z": (0, 0, 1)},
        ports={"inboard": ("coupler", "tip"), "outboard": ("far", "tip")},
    )  # fmt: skip
    return scene


def _inertia():
    """About the driven pivot, of all bars; the coupler only translates."""
    cranks = 2.0 * (INERTIA + MASSES[0] * (0.5 * CRANK) ** 2)
    return cranks + MASSES[1] * CRANK**2


def test_a_parallelogram_turns_as_one_crank():
    """Closed form: J = 2 (I + m l^2 / 4) + M l^2 with a coupler that only translates; t = sqrt(2 J angle / T).

    Joints of 1e7 N/m give way by 1e-6. Pivots pass the angle where axes are parallel without a word.
    """
    inertia = _inertia()
    with warnings.catch_warnings():
        warnings.filterwarnings("error")
        warnings.filterwarnings("ignore", message="driven.*W-not-opened")
        result = fanfold.simulate(_scene(), estimate=False)
    opened = 0.5 * TORQUE / inertia * END**2
    for hinge in ("driven_hinge", "pivot_hinge", "elbow_hinge"):
        assert result[hinge, "angle"][-1] == pytest.approx(FROM + opened, abs=2e-6)
    tip = result["coupler", "frame_position"][-1]
    assert tip[0] == pytest.approx(CRANK * cos(FROM + opened), abs=3e-6)
    later = fanfold.simulate(_scene().with_settings({"scene.until": "2.2 s"}), estimate=False)
    assert later.latch_times["driven"] == pytest.approx(sqrt(2.0 * inertia * (TO - FROM) / TORQUE), rel=3e-6)


@pytest.mark.parametrize("closing", ["spherical", "revolute"])
def test_a_kinematic_latch_stops_all_bars_in_one_impulse(closing):
    """Closed form: the impulse is J times the crank's rate, sqrt(2 T angle / J), and nothing moves just after it.

    Locks of 1e6 kg and kg.m2 give way by 1e-6 of what they hold, on arms of half a metre. A loop of four hinges in a
    plane has three constraints too many, whose impulses are not unique; this one is. Bushings leave hinges rates of
    3e-4 until the event.
    """
    scene = _scene(latch="kinematic", closing=closing).with_settings({"scene.until": "2.2 s"})
    result = fanfold.simulate(scene, estimate=False)
    rate = sqrt(2.0 * TORQUE * (TO - FROM) / _inertia())
    assert result.headline.latch_impulses["driven"] == pytest.approx(_inertia() * rate, rel=1e-5)
    after = int((result.time <= result.latch_times["driven"] + 1.5 * INSTANT).sum()) - 1
    for hinge in ("driven_hinge", "pivot_hinge", "elbow_hinge"):
        assert result[hinge, "angular_rate"][after - 1] ** 2 == pytest.approx(rate**2, rel=1e-3)
        assert result[hinge, "angular_rate"][after] == pytest.approx(0.0, abs=3e-5 * rate)


def test_joints_without_a_motor_drive_nothing():
    """Rule: the joint that closes the loop was said to drive; pivots have no margin."""
    scene = read_scene("four_bar.toml", _scene().tree)
    assert uncounted(scene) == {}
    assert sorted(without_margin(scene)) == ["elbow", "pivot"]
