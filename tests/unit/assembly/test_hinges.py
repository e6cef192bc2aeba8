"""Hinge lines of a scene as hinges: latches by fidelity, shares of the line's totals, stiffnesses by kind.

Against series of springs, the totals of the data sheet and the formulas of its damping ratios.
"""

from itertools import pairwise, product
from math import pi, sqrt

import numpy as np
import pytest

from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.hinges import contradicted_curves, line_latch, unfollowed_curves
from orchestrator.scene.builder import Scene
from orchestrator.scene.table import SceneError
from tests.references.edits import edited
from tests.unit.scene.scene_cases import AMOS3_BODIES, COMPLETE, amos3, load_text, parts_of


def series(line, side):
    """What is missing to the line stiffness where only one side is modelled."""
    return 1.0 / (1.0 / line - 1.0 / side)


EXPECTED_LATCHES = {
    "HL1": {(True, False): 2500.0, (True, True): None},
    "HL2": {
        (False, False): 1800.0,
        (True, False): series(1800.0, 3180.5),
        (False, True): series(1800.0, 4147.8),
        (True, True): None,
    },
    "HL3": {
        (False, False): 2074.0,
        (True, False): series(2074.0, 4147.8),
        (False, True): series(2074.0, 4147.8),
        (True, True): None,
    },
}


@pytest.mark.parametrize("flexible", list(product((False, True), repeat=3)), ids=str)
def test_latch_of_every_line_at_every_fidelity(flexible):
    """Springs in series: a latch holds the compliance that the bodies' models lack; 2 % of critical damping."""
    scene = amos3()
    sides = [True, *flexible]  # the fixed base counts as flexible
    for line, pair in zip(scene.hinge_lines, pairwise(sides), strict=True):
        expected = EXPECTED_LATCHES[line.name][pair]
        latch = line_latch(scene, line, dict(zip(AMOS3_BODIES, flexible, strict=True)), "mean")
        assert latch.kind == ("kinematic" if expected is None else "spring")
        assert latch.stiffness == pytest.approx(expected or 0.0, rel=1e-12)
        endpoint = line_latch(scene, line, dict(zip(AMOS3_BODIES, flexible, strict=True)), "endpoint")
        assert endpoint.kind == "spring"
        assert endpoint.stiffness == pytest.approx(expected or line.latch.stiffness, rel=1e-12)
        assert endpoint.damping == pytest.approx(
            2 * 0.02 * sqrt(endpoint.stiffness * line.latch.effective_inertia), rel=1e-12
        )


def test_latch_of_a_free_base_follows_the_same_rule():
    """Rule: a base, free or fixed, counts as flexible."""
    free = {"mass": "1500 kg", "inertia": [1500.0, 1500.0, 1500.0]}
    scene = Scene.load("amos3", settings={"base.free": free}).check()
    assert scene.base.free.mass == 1500.0
    for flexible, expected in ((True, ("kinematic", 0.0)), (False, ("spring", 2500.0))):
        latch = line_latch(scene, scene.hinge_lines[0], dict.fromkeys(AMOS3_BODIES, flexible), "mean")
        assert (latch.kind, latch.stiffness) == expected


def test_compliance_that_is_stated_of_a_base_is_in_the_latch():
    """Springs in series: no model has what the spacecraft gives way by. Regression: it was left out, as if one had."""
    scene = Scene.load(
        "amos3",
        settings={
            "hinge_line.HL1.latch.inboard_stiffness": "4000 N.m/rad",
            "hinge_line.HL1.latch.stiffness": "1500 N.m/rad",
        },
    ).check()
    for flexible, expected in ((True, series(1500.0, 2500.0)), (False, 1500.0)):
        latch = line_latch(scene, scene.hinge_lines[0], dict.fromkeys(AMOS3_BODIES, flexible), "mean")
        assert (latch.kind, latch.stiffness) == ("spring", pytest.approx(expected, rel=1e-12))


def test_a_measured_latch_that_is_not_followed_is_told():
    """Definition: it is the torque of hinges alone. Regression: with a rigid panel it did nothing, without a word."""
    scene = Scene.load("bepicolombo").check()
    (sentence,) = unfollowed_curves(scene, set())
    assert "hinge_line.HL2.latch.measured" in sentence
    assert " 2217 N.m/rad " in sentence
    assert not list(unfollowed_curves(scene, {body.name for body in scene.bodies}))


def test_a_measured_latch_beside_other_stiffnesses_is_told():
    """Springs in series: 2,217 N.m/rad with sides of 3,000 and 9,000 leave 150 kN.m/rad, measured are 2,939."""
    scene = Scene.load("bepicolombo")
    assert not list(contradicted_curves(scene.check()))
    sides = {"inboard_stiffness": "3000 N.m/rad", "outboard_stiffness": "9000 N.m/rad"}
    keys = {f"hinge_line.HL2.latch.{side}": stiffness for side, stiffness in sides.items()}
    (sentence,) = contradicted_curves(scene.with_settings(keys).check())
    assert sentence.startswith("hinge_line.HL2.latch: ")


def test_hinges_share_the_totals_of_their_line():
    """Data sheet of AMOS-3, HL2: torques of the line, stowed and deployed; both hinges together have them."""
    parts = parts_of(assemble(amos3(), rigid={"all"}))
    left, right = parts["hl2_left"], parts["hl2_right"]
    wind_up = pi * 1.591 / (1.591 - 0.937)
    for hinge in (left, right):
        stiffness = hinge.start["motor_stiffness"]
        assert 2 * stiffness * hinge.start["motor_wind_up"] == pytest.approx(1.591, rel=1e-12)
        assert 2 * stiffness * (hinge.start["motor_wind_up"] - pi) == pytest.approx(0.937, rel=1e-12)
        assert hinge.start["motor_wind_up"] == pytest.approx(wind_up, rel=1e-12)
        assert 2 * hinge.start["friction_preload"] == pytest.approx(0.05, rel=1e-12)
        assert 2 * hinge.start["latch_stiffness"] == pytest.approx(1800.0, rel=1e-12)
        assert hinge.start["friction_coefficient"] == 0.10  # acts on each hinge's own reaction
    assert left.structure["harness_torque"] == (-0.15, 0.08)  # resists when stowed, on the +y side only
    assert "harness_torque" not in right.structure


def test_kinds_of_hinge_are_settings_of_the_six_stiffnesses():
    parts = parts_of(assemble(amos3(), rigid={"all"}))
    revolute, cylindrical = parts["hl2_left"].start, parts["hl2_right"].start
    assert revolute["translational_stiffness"] == (2e6, 5e6, 5e6)
    assert cylindrical["translational_stiffness"] == (0.0, 5e6, 5e6)
    assert revolute["rotational_stiffness"] == (0.0, 2e4, 2e4)
    assert revolute["rotational_damping"][1] == pytest.approx(2 * 0.05 * 2e4 / (2 * pi * 184), rel=1e-12)


def test_stiffnesses_of_a_hinge_can_be_overridden(tmp_path):
    override = 'kind = "spherical", translational_stiffness = ["1 N/mm", 2, 3]'
    parts = parts_of(assemble(load_text(tmp_path, edited(COMPLETE, ('kind = "cylindrical"', override)))))
    assert parts["middle_right"].start["translational_stiffness"] == (1000.0, 2.0, 3.0)
    assert parts["middle_right"].start["rotational_stiffness"] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
def test_stiction_velocity_of_smooth_friction_is_raised_next_to_a_flexible_body(mode):
    """Rule of the thesis; friction that sticks has one velocity at any fidelity."""
    rigid = {"yoke", "panel1"}
    smooth = Scene.load("amos3", settings={"friction.law": "smooth"}).check()
    parts = parts_of(assemble(smooth, rigid=rigid, wrench_mode=mode))
    assert parts["hl2_left"].start["stiction_velocity"] == 0.0167
    assert parts["hl3_left"].start["stiction_velocity"] == pytest.approx(0.167, rel=1e-12)
    assert parts["hl3_left"].start["presliding_stiffness"] == 0.0
    assert parts["hl3_left"].start["latch_automatic"] == (mode == "endpoint")
    sticking = parts_of(assemble(amos3(), rigid=rigid, wrench_mode=mode))
    assert {sticking[f"{line}_left"].start["stiction_velocity"] for line in ("hl2", "hl3")} == {
        parts["hl3_left"].start["stiction_velocity"]
    }


def test_friction_that_sticks_is_damped_on_the_inertia_of_the_bodies():
    """Half of critical of one mass on its spring, 2 x 0.5 sqrt(k J), shared by the hinges of the line."""
    settings = {"hinge_line.HL2.presliding": {"stiffness": 900.0, "effective_inertia": 4.0}}
    parts = parts_of(assemble(Scene.load("amos3", settings=settings).check(), rigid={"all"}))
    for name in ("hl2_left", "hl2_right"):
        assert parts[name].start["presliding_stiffness"] == pytest.approx(450.0, rel=1e-12)
        assert parts[name].start["presliding_damping"] == pytest.approx(30.0, rel=1e-12)


def test_friction_breaks_away_after_a_small_part_of_the_travel():
    """Definition: 1e-4 of it, of the friction that tables say; one of pins adds that under the scene's loads."""
    settings = {"friction.coefficient": 0.0, "hinge_line.HL3.friction_preload": "0.5 N.m"}
    parts = parts_of(assemble(Scene.load("amos3", settings=settings).check(), rigid={"all"}))
    assert parts["hl3_left"].start["presliding_stiffness"] == pytest.approx(0.25 / (1e-4 * pi), rel=1e-12)
    assert parts["hl1_hinge"].start["presliding_stiffness"] == pytest.approx(0.05 / (0.5e-4 * pi), rel=1e-12)
    with_pins = parts_of(assemble(amos3(), rigid={"all"}))["hl1_hinge"].start["presliding_stiffness"]
    assert with_pins > 1.5 * parts["hl1_hinge"].start["presliding_stiffness"]


def test_a_motor_of_constant_torque_has_no_spring():
    settings = {"hinge_line.HL2.motor": {"stowed": "1.2 N.m", "deployed": "1.2 N.m"}}
    parts = parts_of(assemble(Scene.load("amos3", settings=settings).check(), rigid={"all"}))
    start = parts["hl2_left"].start
    assert start["motor_constant_torque"] == pytest.approx(0.6, rel=1e-12)
    assert start.get("motor_stiffness", 0.0) == 0.0


def test_tables_of_motor_and_harness_with_hysteresis_are_shared():
    """Means of both ways, and half of their differences in sum over the angles of both; the harness is on one hinge."""
    motor = {"angle": ["0 deg", "180 deg"], "torque": [1.6, 1.0], "closing_torque": [1.8, 1.2]}
    settings = {
        "hinge_line.HL2.motor": motor,
        "hinge_line.HL2.harness.angle": ["0 deg", "180 deg"],
        "hinge_line.HL2.harness.resisting_torque": [0.15, -0.08],
        "hinge_line.HL2.harness.closing_torque": [0.05, -0.08],
    }
    scene = Scene.load("amos3", settings=settings)
    parts = parts_of(assemble(scene.check(), rigid={"all"}))
    left, right = parts["hl2_left"].structure, parts["hl2_right"].structure

    def at_ends(structure, name):
        return np.interp((0.0, pi), structure[f"{name}_angle"], structure[f"{name}_torque"])

    for structure in (left, right):
        assert at_ends(structure, "motor") == pytest.approx((0.85, 0.55))
    assert at_ends(left, "harness") == pytest.approx((-0.1, 0.08))
    assert at_ends(left, "hysteresis") == pytest.approx((0.1, 0.05))
    assert at_ends(right, "hysteresis") == pytest.approx((0.05, 0.05))
    line = next(line for line in scene.check().hinge_lines if line.name == "HL2")
    assert line.motor_energy == pytest.approx(1.3 * pi)


NINETY = {"angle": ["0 deg", "90 deg"]}


@pytest.mark.parametrize(
    ("motor", "text"),
    [
        ({"stowed": 1.0, "deployed": 1.1}, "stowed.*deployed"),
        (NINETY | {"torque": [1.0]}, "two angles"),
        (NINETY | {"torque": [1.0, 1.0], "closing_torque": [1.0, 0.9]}, "closing_torque"),
        (NINETY | {"torque": [1.0, 1.0], "closing_torque": [1.0]}, "1 torques for 2 angles"),
    ],
)
def test_motors_that_are_none_are_told(motor, text):
    with pytest.raises(SceneError, match=text):
        Scene.load("amos3", settings={"hinge_line.HL2.motor": motor}).check()
