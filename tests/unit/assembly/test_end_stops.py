"""End stops of hinge lines: where they begin, how stiff they are, and that a bounce without damping loses nothing."""

from math import pi, radians, sin, sqrt

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.frames import exponential, rotate, scaled
from orchestrator.assembly.end_stops import share_of_stiffness, stop_attachments, stop_parts
from tests.unit.scene.scene_cases import TWO_PANELS, load_text

STOP = "end_stop = { angle = '100 deg', stiffness = 2e4, arm = '40 mm' }\n"
HINGES = 'hinges = [{ name = "root"'


def stopped(folder, stop=STOP):
    """The root line of two panels, with a stop."""
    return load_text(folder, TWO_PANELS.replace(HINGES, stop + HINGES)).hinge_lines[0]


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


def penetration(line, angle):
    """Depth (m) of the pad at a hinge angle, from the parameters of the contact."""
    (part, _), (_, pad, *_) = stop_parts(line, "mean"), stop_attachments(line)
    turned = rotate(exponential(scaled(angle - line.aligned_angle, line.axis)), pad.offset)
    return part.start["gap"] - np.dot(part.structure["normal"], turned)


@pytest.mark.parametrize("axis", ["+x", "-x", "+y", "-y", "+z", "-z"])
def test_the_pad_touches_at_the_angle_and_nowhere_before(tmp_path, axis):
    """Geometry, about every axis: clear over 240 deg before the stop, touching there, deeper beyond."""
    line = stopped(tmp_path).model_copy(
        update={"axis": tuple(float(axis[0] + "1") * (letter == axis[1]) for letter in "xyz")}
    )
    stop = radians(100)
    assert penetration(line, stop) == pytest.approx(0.0, abs=1e-15)
    assert all(penetration(line, stop - way) < 0.0 for way in np.linspace(0.01, 4.18, 50))
    lever = 0.04  # as it is given: the pad itself is farther out by 1 / sin 60 deg
    assert penetration(line, stop + 1e-4) == pytest.approx(1e-4 * lever, rel=1e-3)


def test_stiffness_is_that_of_the_line(tmp_path):
    """Energy: the panel, driven by its motor alone, is thrown back by a stop without damping to where it came from.

    Closed form of the deepest turn: half k delta^2 = W + T delta, W the work of the motor up to the stop and T its
    torque there. The lever of the pads shortens by delta / tan 60 deg = 0.25 % on the way.
    """
    scene, base, panel = one_panel("one_panel", until=4.0)
    scene.hinge_line(
        "HL", base, panel, axis="+y", aligned_angle="90 deg", start_angle="80 deg", hinges={"hinge": "root"},
        motor={"stowed": "1.6 N.m", "deployed": "1.0 N.m"}, end_stop={"stiffness": 2e4},
    )  # fmt: skip
    result = fanfold.simulate(scene, estimate=False)
    angle = result["hinge", "angle"]
    deepest = angle[:].max() - pi / 2
    work = radians(10) * (1.0 + 0.5 * 0.6 * 10 / 90)
    assert deepest == pytest.approx((1.0 + sqrt(1.0 + 2 * 2e4 * work)) / 2e4, rel=2.5e-3)
    first = np.argmax(angle[:])
    back = angle[first:].min()
    assert back == pytest.approx(radians(80), abs=2e-4)
    assert result.warnings == ()


@pytest.mark.filterwarnings("ignore:.*neither a latch nor an end_stop")  # nothing stops it
@pytest.mark.filterwarnings("ignore:middle_line has no latch and passed")  # told, too
def test_a_line_without_one_is_told_when_it_passes(tmp_path):
    """It went through its deployed angle without a word."""
    (tmp_path / "wing.toml").write_text(TWO_PANELS, encoding="utf-8")
    with pytest.warns(
        fanfold.FanfoldWarning, match="root_line has no latch and passed its deployed angle of 90 deg"
    ):
        result = fanfold.simulate(
            fanfold.load(tmp_path / "wing.toml", settings={"scene.until": 8.0}), estimate=False
        )
    found = result.headline.overruns["root_line"]
    angle = result["root", "angle"]
    assert (found.largest, found.last) == (angle[:].max(), angle[-1])
    assert angle.at(found.passed_at) == pytest.approx(found.deployed_angle + radians(1.0), abs=0.02)
    assert any(row.quantity == "largest angle, no latch" for row in result.headline.numbers())


@pytest.mark.filterwarnings("ignore:.* has not latched")  # it ends before
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
    with pytest.warns(fanfold.FanfoldWarning, match="HL folded back by"):
        result = fanfold.simulate(scene, estimate=False)
    back = result.headline.folded_back["HL"]
    assert 8 * 9.81 * 0.8 * sin(back.value) == pytest.approx(30.0 * back.value, rel=1e-3)
    assert back.value > 1.0


def test_a_line_that_goes_far_into_its_stop_is_told_of():
    """Statics with the pads as built: k f(angle) angle = T for a motor that presses; nothing said how soft they are."""
    scene, base, panel = one_panel("pressed", until=8.0)
    scene.hinge_line(
        "HL", base, panel, axis="-y", aligned_angle="90 deg", start_angle="89 deg", hinges={"hinge": "root"},
        motor={"stowed": "60.00006 N.m", "deployed": "60 N.m"},
        end_stop={"stiffness": "800 N.m/rad", "damping": "100 N.m.s/rad"},
    )  # fmt: skip
    with pytest.warns(
        fanfold.FanfoldWarning, match=r"HL went \d\.\d deg into its end_stop, at .* push back by 9\d% of"
    ):
        result = fanfold.simulate(scene, estimate=False)
    rest = result.signal("hinge", "angle")[-1] - np.pi / 2
    assert 800.0 * share_of_stiffness(rest) * rest == pytest.approx(60.0, rel=1e-3)
    assert rest == pytest.approx(0.0809, rel=5e-3)  # an own integration with the geometry of the pads
    assert share_of_stiffness(radians(60.0)) == pytest.approx(0.0, abs=1e-12)
