"""What a motor stirs up by starting is resolved from the first step on; what friction holds does not start."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import run
from orchestrator.scene import find_scene, load_scene

UNTIL = 0.004
STICKS = {"stiffness": "1e4 N.m/rad"}


@pytest.fixture(scope="module")
def phase1():
    return assemble(load_scene(find_scene("arabsat"), ["phase1"]))


def largest_load(assembly, settings):
    """Largest interface force and torque components of a start (N, N.m)."""
    result = run(assembly, None, settings, UNTIL).result
    loads = (result.signal("spacecraft", f"interface_{what}") for what in ("force", "torque"))
    return [float(np.abs(load).max()) for load in loads]


def test_first_swing_of_the_joints(phase1):
    """Independent: steps of 2 us that nothing controls; steps of 1 ms at first saw 9 N of 22 N.

    What swings holds a millionth of the energy that the tolerance is relative to, a thousandth of its velocities, so
    that ten tolerances of these are 1 % here.
    """
    found = largest_load(phase1, Settings(phase1.tolerance, phase1.largest_step))
    true = largest_load(phase1, Settings(fixed_step=2e-6))
    assert found == pytest.approx(true, rel=1e-2)
    assert true[0] > 20.0


def door(friction):
    """A door of 7 kg.m2 about its hinge line whose motor gives 2 N.m, without static equilibrium before the start."""
    scene = fanfold.Scene("door", until="300 s", largest_step="1 s")
    base = scene.base(points={"left": (0, 0.4, 0), "right": (0, -0.4, 0)})
    body = scene.body(
        "door",
        rigid={
            "mass": "12 kg",
            "center_of_mass": [0.6, 0, 0],
            "inertia": ["1.1 kg.m2", "2.68 kg.m2", "2.78 kg.m2"],
            "points": {"left": [0, 0.4, 0], "right": [0, -0.4, 0]},
        },
    )
    scene.hinge_line(
        "HL", base, body, axis="+y", aligned_angle="90 deg",
        hinges={"left": ("left", "left"), "right": ("right", "right")},
        motor={"stowed": "2 N.m", "deployed": "2 N.m"}, friction_preload=friction, presliding=STICKS,
        latch={"stiffness": "3000 N.m/rad"},
    )  # fmt: skip
    return scene


@pytest.mark.filterwarnings("ignore:.*W-motor-short")  # which is the point
def test_a_door_that_friction_holds_does_not_move_in_300_seconds():
    """Without static equilibrium: friction begins with what the motor asks for, and no force shows at the start."""
    with pytest.warns(fanfold.FanfoldWarning, match="HL .*W-not-opened"):
        result = fanfold.simulate(door("2.1 N.m"), rigid="all")
    angle = result["left", "angle"][:]
    assert np.ptp(angle) == 0.0
    assert max(result.headline.interface_force_peaks) == 0.0
    assert result["left", "friction_torque"][:] == pytest.approx(-1.0)


@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # held by friction
@pytest.mark.filterwarnings("ignore:.*W-motor-short")  # which is the point
def test_a_wing_that_friction_holds_does_not_move_after_its_static_equilibrium():
    """AMOS-3 with 50 N.m in each line: friction takes over what the holds of the static search carry, cables included.

    They balance motors of 1.6 N.m to the search's own 7e-5 m/s2; what that is off moves 1e4 N.m/rad by 1e-8 rad.
    """
    lines = ("HL1", "HL2", "HL3")
    settings = {f"hinge_line.{line}.friction_preload": "50 N.m" for line in lines}
    settings |= {f"hinge_line.{line}.presliding": STICKS for line in lines}
    wing = fanfold.load("amos3", settings=settings)
    with pytest.warns(fanfold.FanfoldWarning, match="HL1 .*W-not-opened"):
        result = fanfold.simulate(wing, rigid="all", until="2 s", estimate=False)
    for hinge in ("hl1_hinge", "hl2_left", "hl3_left"):
        assert np.ptp(result[hinge, "angle"][:]) < 1e-8
    assert max(result.headline.interface_force_peaks) < 1e-3


def test_holding_torque_of_bepicolombo_does_not_creep():
    """20 N.m hold the inboard panel against what the outboard one does until latch-up: 7.4 N.m at a hinge of two.

    It deflects by no more than that over half of the line's stiffness; the smooth transition creeps by 0.6 deg.
    """
    array = fanfold.load("bepicolombo", variant="impact", settings={"hinge_line.HL1.presliding": STICKS})
    with pytest.warns(fanfold.FanfoldWarning, match="HL2 .*W-not-opened"):
        result = fanfold.simulate(array, rigid="all", until="4.3 s", estimate=False)
    angle, friction = result["hl1_left", "angle"][:], result["hl1_left", "friction_torque"][:]
    assert np.abs(friction).max() < 10.0
    assert np.abs(angle).max() <= np.abs(friction).max() / 5e3 * 1.02
