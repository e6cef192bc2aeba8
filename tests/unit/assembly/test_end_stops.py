"""End stops of hinge lines: where they begin, how stiff they are, and that a bounce without damping loses nothing."""

import re
import warnings
from math import pi, radians, sin

import numpy as np
import pytest
from scipy.optimize import brentq

import orchestrator as fanfold
from orchestrator.validity.travel import travel_warnings
from tests.unit.scene.scene_cases import TWO_PANELS


def one_panel(name, **options):
    """A scene with a base and a rigid panel, to be joined at their roots."""
    scene = fanfold.Scene(name, **options)
    rigid = {
        "mass": 8,
        "center_of_mass": (0.8, 0, 0),
        "inertia": (0.9, 1.8, 2.7),
        "points": {"root": (0, 0, 0)},
    }
    return scene, scene.base(points={"root": (0, 0, 0)}), scene.body("panel", rigid=rigid)


def test_stiffness_is_that_of_the_line():
    """Energy: the panel, driven by its motor alone, is thrown back by a stop without damping to where it came from.

    Closed form of the deepest turn: half k delta^2 + F^2 / 2 k_r = W + T delta, W the work of the motor up to the stop,
    T its torque there, and F the force m r (k delta - T) / J by which the joint gives way radially, with k_r.
    """
    scene, base, panel = one_panel("one_panel", until=4.0)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", start_angle="80 deg", hinges={"hinge": "root"},
        motor={"stowed": "1.6 N.m", "deployed": "1.0 N.m"}, end_stop={"stiffness": 2e4},
    )  # fmt: skip
    result = fanfold.simulate(scene, tolerance=1e-6, estimate=False)
    angle = result["hinge", "angle"]
    deepest = angle[:].max() - pi / 2
    work = radians(10) * (1.0 + 0.5 * 0.6 * 10 / 90)
    lever = 8 * 0.8 / (1.8 + 8 * 0.8**2)

    def excess(delta):
        force = lever * (2e4 * delta - 1.0)
        return 1e4 * delta**2 + force**2 / (2 * 5e6) - work - delta

    assert deepest == pytest.approx(brentq(excess, 1e-3, 1e-2), rel=2e-4)
    first = np.argmax(angle[:])
    back = angle[first:].min()
    assert back == pytest.approx(radians(80), abs=2e-4)
    assert result.warnings == ()


@pytest.mark.parametrize(("keys", "full"), [({}, 1e-3), ({"full_damping_penetration": "0.005 rad"}, 5e-3)])
def test_damping_rises_over_an_angle(keys, full):
    """Closed form: the torque of an instant is k d + c rate s(d / full), with the cubic step s of the handbook."""
    scene, base, panel = one_panel("one_panel", until=0.5)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", start_angle="89.9 deg", hinges={"hinge": "root"},
        motor={"stowed": "20 N.m", "deployed": "20 N.m"}, end_stop={"stiffness": 2e4, "damping": 300.0, **keys},
    )  # fmt: skip
    result = fanfold.simulate(scene, tolerance=1e-4, estimate=False)
    depth, rate = result["hinge_stop", "penetration"][:], result["hinge_stop", "angular_rate"][:]
    part = np.clip(depth / full, 0.0, 1.0)
    law = np.where(depth > 0.0, 2e4 * depth + 300.0 * rate * (3.0 - 2.0 * part) * part**2, 0.0)
    torque = result["hinge_stop", "stop_torque"][:]
    assert torque == pytest.approx(np.maximum(law, 0.0), abs=1e-2 * law.max())


@pytest.mark.filterwarnings("ignore:.*W-no-end")  # nothing stops it
@pytest.mark.filterwarnings("ignore:middle_line.*W-no-end")  # told, too
def test_a_line_without_one_is_told_when_it_passes(tmp_path):
    """It went through its deployed angle without a word."""
    (tmp_path / "wing.toml").write_text(TWO_PANELS, encoding="utf-8")
    with pytest.warns(fanfold.FanfoldWarning, match="root_line .*90 deg.*W-no-end"):
        result = fanfold.simulate(
            fanfold.load(tmp_path / "wing.toml", settings={"scene.until": 8.0}), estimate=False
        )
    found = result.headline.overruns["root_line"]
    angle = result["root", "angle"]
    assert (found.largest, found.last) == (angle[:].max(), angle[-1])
    assert angle.at(found.passed_at) == pytest.approx(found.deployed_angle + radians(1.0), abs=0.02)
    assert any(row.quantity == "largest angle, no latch" for row in result.headline.numbers())


@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before
def test_a_line_that_folds_back_is_told_of():
    """A pendulum let go beside its motor swings back to where the work of both is none; nothing said so.

    Closed form of the lowest angle: m g r sin(angle) = T angle, the motor's torque T being constant.
    """
    scene, base, panel = one_panel("pendulum", until=2.0, gravity=(0, 0, -9.81))
    scene.hinge_line(
        "HL", base, panel, axis="-y", aligned_angle="0 deg", start_angle="0 deg", hinges={"hinge": "root"},
        latch_angle="90 deg", motor={"stowed": "30.00003 N.m", "deployed": "30 N.m"},
        latch={"kind": "spring", "stiffness": 4e3, "damping_ratio": 0.02},
    )  # fmt: skip
    with pytest.warns(fanfold.FanfoldWarning, match="HL .*W-folded-back"):
        result = fanfold.simulate(scene, estimate=False)
    back = float(result.signal("hinge", "angle")[0] - result.signal("hinge", "angle").min())
    assert 8 * 9.81 * 0.8 * sin(back) == pytest.approx(30.0 * back, rel=1e-3)
    assert back > 1.0


def test_a_line_goes_as_far_into_its_stop_as_its_motor_presses():
    """Statics: k angle = T at any depth, here 17 deg, shared by two hinges; flat pads gave way and let go at 60 deg."""
    scene = fanfold.Scene("pressed", until=8.0)
    points = {"left": (0, 0.4, 0), "right": (0, -0.4, 0)}
    base = scene.base(points=points)
    rigid = {"mass": 8, "center_of_mass": (0.8, 0, 0), "inertia": (0.9, 1.8, 2.7), "points": points}
    scene.hinge_line(
        "HL", base, scene.body("panel", rigid=rigid), axis="-y", aligned_angle="90 deg", start_angle="89 deg",
        hinges={"left": "left", "right": "right"}, motor={"stowed": "60.00006 N.m", "deployed": "60 N.m"},
        end_stop={"stiffness": "200 N.m/rad", "damping": "100 N.m.s/rad"},
    )  # fmt: skip
    result = fanfold.simulate(scene, estimate=False)
    assert result.signal("left", "angle")[-1] - pi / 2 == pytest.approx(0.3, rel=1e-4)
    assert result.signal("left_stop", "stop_torque")[-1] == pytest.approx(30.0, rel=1e-4)
    found = fanfold.impacts(result)
    assert {impact.contact for impact in found} == {"left_stop", "right_stop"}
    assert all(impact.angular for impact in found)


@pytest.mark.parametrize(
    ("motor", "stop", "told"),
    [
        (None, {"stiffness": 2e4}, "HL .* 90 deg.* 80.00 deg"),
        ({"stowed": 1.0, "deployed": 1.0}, {"stiffness": 2e4}, ""),
        ({"stowed": 1.0, "deployed": 1.0}, {"stiffness": 0.1}, "HL .* deg .*W-stop-pressed"),
    ],
)
def test_a_line_that_its_stop_does_not_end_is_told(motor, stop, told):
    """Regression: a line with a stop and no latch that never opened was told nowhere; neither was a stop like none."""
    scene, base, panel = one_panel("ended", until=4.0)
    line = {"motor": motor} if motor else {}
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", start_angle="80 deg", hinges={"hinge": "root"},
        end_stop=stop, **line,
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = fanfold.simulate(scene, estimate=False)
    sentences = list(travel_warnings(found, found.headline))
    assert len(sentences) == bool(told)
    assert all(re.match(told, one) for one in sentences)


@pytest.mark.parametrize("motor", [None, {"stowed": 1.0, "deployed": 1.0}])
def test_a_line_that_nothing_ends_and_that_stays_short_is_told(motor):
    """Rule: of one that a motor is to open in a sentence, of others by where it stands, as of a drive's or a pivot.

    Regression: lines without latch and stop that did not open were told nowhere.
    """
    scene, base, panel = one_panel("short", until=0.5)
    line = {"motor": motor} if motor else {}
    scene.hinge_line("HL", base, panel, axis="+y", aligned_angle="90 deg", hinges={"hinge": "root"}, **line)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = fanfold.simulate(scene, estimate=False)
    found = result.headline
    sentences = list(travel_warnings(result, found))
    assert len(sentences) == bool(motor)
    assert all(re.match(r"HL .*90 deg.*W-not-opened", one) for one in sentences)
    (stands,) = (number for number in found.numbers() if number.quantity == "final angle, no latch")
    assert (stands.of, stands.value) == ("HL", found.short_of_deployed["HL"].last)


def test_what_a_stop_does_not_take_is_refused_before_the_run():
    """Regression: `check` passed it, and `run` refused it without the file's name."""
    scene, base, panel = one_panel("sharp", until=4.0)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", hinges={"hinge": "root"},
        end_stop={"stiffness": 2e4, "full_damping_penetration": 1e-12},
    )  # fmt: skip
    report = fanfold.check_scene(scene)
    assert any(
        "sharp" in one and "hinge_stop: full_damping_penetration = 1e-12" in one for one in report.problems
    )


def test_names_of_stops_are_taken():
    """Message. Regression: a bolt of that name went with the hinge, or a variable was "declared twice"."""
    scene, base, panel = one_panel("taken", until=1.0)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", hinges={"hinge": "root"},
        end_stop={"stiffness": 2e4},
    )  # fmt: skip
    ports = {"inboard": (base, "root"), "outboard": (panel, "root")}
    scene.connection("hinge_stop", "hold_down", ports=ports)
    with pytest.raises(fanfold.FanfoldError, match=r"HL.end_stop .*'hinge_stop'"):
        scene.check()


def test_a_stop_goes_with_its_hinge():
    """Release of a line: nothing turns its bodies any more, so the panel keeps its rate for good."""
    scene, base, panel = one_panel("lost", until=6.0)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", start_angle="80 deg", hinges={"hinge": "root"},
        motor={"stowed": "1.6 N.m", "deployed": "1.0 N.m"}, end_stop={"stiffness": 2e4},
    )  # fmt: skip
    scene.event("lost", time=0.5, release=["HL"])
    result = fanfold.simulate(scene, estimate=False)
    rate = result.signal("hinge", "angular_rate")[result.time > 0.51]
    assert result.signal("hinge_stop", "penetration")[-1] > 0.1
    assert fanfold.impacts(result) == []
    assert np.ptp(rate) < 1e-9 * abs(rate).max()


@pytest.mark.parametrize(("deployed", "as_posed"), [("1.0 N.m", False), ("0 N.m", False), ("1.0 N.m", True)])
def test_a_line_at_its_stop_swings_on_its_whole_stiffness(deployed, as_posed):
    """Closed form sqrt(k / J), pressed or just touching. Regression: half of it, a difference across the touch."""
    scene, base, panel = one_panel("rests", until=1.0)
    scene.joint(axial_stiffness=1e9, radial_stiffness=1e9, cross_stiffness=1e9)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", hinges={"hinge": "root"},
        motor={"stowed": "1.6 N.m", "deployed": deployed}, end_stop={"stiffness": 2e4, "damping": 50},
    )  # fmt: skip
    found = fanfold.modes(scene, "deployed", as_posed=as_posed)
    exact = np.sqrt(2e4 / (1.8 + 8 * 0.8**2)) / (2 * pi)
    assert found.frequencies[0] == pytest.approx(exact, rel=1e-4)
    if deployed != "0 N.m" and not as_posed:
        depth = 1.0 / 2e4 / 1e-3  # over the depth of full damping
        damping = 50 * depth**2 * (3 - 2 * depth)
        assert found.damping_ratios[0] == pytest.approx(damping / (2 * 2e4) * 2 * pi * exact, rel=1e-2)
