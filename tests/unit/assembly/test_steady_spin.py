"""Modes of what stands on a base that turns at a constant rate: published frequencies and closed forms."""

import warnings

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.validity.centrifugal_stiffening import unstiffened_spins
from tests.unit.components.body.test_second_order import BLADE

LENGTH, BENDING, LINE_MASS = 2.0, 300.0, 0.8
SCALE = np.sqrt(BENDING / LINE_MASS) / LENGTH**2
"""rad/s"""
MASS, ACROSS, AXIAL, RADIAL, TILT = 4.0, 0.3, 0.5, 1e3, 50.0
"""Of the rotor: kg, kg.m2, N/m, N.m/rad."""
SECTION = {
    "axial": 1e8, "shear_y": 1e9, "shear_z": 1e9, "torsion": 200.0, "bending_y": BENDING, "bending_z": 4.0 * BENDING,
    "line_mass": LINE_MASS, "inertia_y": 1e-8, "inertia_z": 1e-8,
}  # fmt: skip


def turning(rate):
    """A scene on a base that turns about z from the start on."""
    scene = fanfold.Scene("turning", until="1 s")
    law = [{"profile": "ramp", "duration": 100.0, "change": 100.0 * rate}]
    return scene, scene.base(points={"hub": (0, 0, 0)}, motion={"rotation": law})


def spun(rate, second_order=None):
    """A cantilever that turns about its root."""
    scene, hub = turning(rate)
    beam = {"length": LENGTH, "elements": 24, "attachment_points": {"root": 0}, "section": SECTION}
    keys = {"fidelity": "flexible", "fixed_interface_modes": 12}
    if second_order is not None:
        keys["second_order_modes"] = second_order
    boom = scene.body("boom", place={"body": hub, "point": "hub"}, beam=beam, **keys)
    ports = {"inboard": {"body": hub, "point": "hub"}, "outboard": {"body": boom, "point": "root"}}
    scene.connection("clamp", "hinge", preset="fixed", axes={"x": (1, 0, 0)}, ports=ports)
    scene.joint(axial_stiffness=1e9, radial_stiffness=1e9, cross_stiffness=1e8)
    return scene


def blade(rate):
    """Its frequencies (rad/s), by bending direction: flap z, lag y."""
    return 2.0 * np.pi * fanfold.modes(spun(rate)).frequencies


def test_spin_that_stiffens_nothing_is_told():
    """Definition: modes of first order know no tension. One of second order, or a slow spin, is no matter."""
    fast, slow = 5.0 * SCALE, 0.1 * SCALE
    with pytest.warns(fanfold.FanfoldWarning, match="body.boom: .*W-spin"):
        fanfold.simulate(spun(fast, 0), until=1e-4, estimate=False)
    with pytest.warns(fanfold.FanfoldWarning, match="body.boom: .*W-spin"):
        fanfold.modes(spun(fast, 0))
    later = spun(fast, 0)
    law = [{"profile": "step5", "start": 0.5, "duration": 0.5, "change": 100.0 * fast}]
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # modes are about the rate that the law begins with
        fanfold.modes(later.with_settings({"base.motion.rotation": law}))
    for scene in (spun(fast), spun(slow, 0)):
        checked = scene.check()
        assert not list(unstiffened_spins(checked, assemble(checked)))


@pytest.mark.parametrize("ratio", [2.0, 12.0])
def test_a_turning_blade(ratio):
    """Published flap frequencies (Wright and others 1982); in the plane, twice as fast at rest, less the rate squared.

    Coriolis forces couple that bending to stretching, which the beam resists 1e5 times as much.
    """
    found = blade(ratio * SCALE) / SCALE
    lag = np.sqrt(4.0 * BLADE[0.5 * ratio] ** 2 - ratio**2)
    assert sorted(found[:2]) == pytest.approx(sorted((BLADE[ratio], lag)), rel=3e-4)


def rotor(rate):
    """Scene of a rigid body in its base, on springs alike in all directions across z, about which that turns."""
    scene, hub = turning(rate)
    rigid = {
        "mass": MASS,
        "center_of_mass": (0, 0, 0),
        "inertia": (ACROSS, ACROSS, AXIAL),
        "points": {"middle": (0, 0, 0)},
    }
    wheel = scene.body("wheel", place={"body": hub, "point": "hub"}, rigid=rigid)
    ports = {"inboard": {"body": hub, "point": "hub"}, "outboard": {"body": wheel, "point": "middle"}}
    scene.connection("mount", "hinge", preset="fixed", axes={"x": (0, 0, 1), "z": (1, 0, 0)}, ports=ports)
    scene.joint(axial_stiffness=RADIAL, radial_stiffness=RADIAL, cross_stiffness=TILT)
    return scene


def test_a_rotor_whirls():
    """Closed form: at rest it swings at sqrt(k/m) and tilts by A s^2 -+ C w s = k, in its own axes less or plus w."""
    rate, swing = 3.0, np.sqrt(RADIAL / MASS)
    fast, slow = np.abs(np.roots([ACROSS, -AXIAL * rate, -TILT]))
    along = [swing, np.sqrt(TILT / AXIAL)]
    expected = sorted([swing - rate, swing + rate, fast - rate, slow + rate, *along])
    found = fanfold.modes(rotor(rate))
    assert 2.0 * np.pi * found.frequencies == pytest.approx(expected, rel=1e-9)
    assert [mode.share for mode in found.listed] == pytest.approx([1.0] * 6, rel=1e-12)


def test_modes_of_a_spin_have_no_effective_masses():
    """Definition: they belong to motions of a base that does not turn; zeros stood in their place."""
    found = fanfold.modes(rotor(3.0))
    assert found.turns
    assert set(found.as_dict()["modes"][0]["effective_mass_fraction"].values()) == {None}


def test_other_analyses_say_that_they_leave_it_out():
    """Sentence: what is no mode takes the base as at rest."""
    with pytest.warns(fanfold.FanfoldWarning, match="base.*W-modes-omitted"):
        fanfold.frequency_response(rotor(3.0), low=1.0, high=2.0, steps=2)


@pytest.mark.parametrize(
    ("turns", "second_order", "told"),
    [(5.0, 0, True), pytest.param(5.0, 4, False, marks=pytest.mark.thorough), (0.05, 0, False)],
)
def test_spin_that_a_run_reaches_is_told(turns, second_order, told):
    """Definition: a free spacecraft that a torque spins up. Regression: laws of motion alone were looked at."""
    scene = fanfold.Scene("spun_up", until="0.2 s")
    craft = scene.base("craft", points={"hub": (0, 0, 0)}, free={"mass": 50.0, "inertia": (5, 5, 5)})
    beam = {"length": LENGTH, "elements": 8, "attachment_points": {"root": 0}, "section": SECTION}
    keys = {"fidelity": "flexible", "fixed_interface_modes": 4, "second_order_modes": second_order}
    boom = scene.body("boom", place={"body": craft, "point": "hub"}, beam=beam, **keys)
    scene.connection(
        "clamp",
        preset="fixed",
        axes={"x": (1, 0, 0)},
        ports={"inboard": (craft, "hub"), "outboard": (boom, "root")},
    )
    torque = [{"profile": "constant", "value": turns * SCALE * 60.0}]
    scene.connection(
        "jet", "load", structure={"direction": (0, 0, 1), "torque": torque}, ports={"body": (craft, "hub")}
    )
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        fanfold.simulate(scene, estimate=False, tolerance=1e-3)
    assert any("W-spin" in str(one.message) for one in heard) == told


def hung(motion, damping=20.0):
    """A link on a spring and a damped cord above it, on a base that moves."""
    scene = fanfold.Scene("hung", until=1.0, gravity=(0.0, 0.0, -2.0))
    base = scene.base(
        points={"root": (0, 0, 0), "top": (1.0, 0.2, 1.0)}, **({"motion": motion} if motion else {})
    )
    rigid = {
        "mass": 3.0, "center_of_mass": (0.5, 0, 0), "inertia": (0.1, 0.3, 0.3),
        "points": {"root": (0, 0, 0), "tip": (1.0, 0.1, 0.0)},
    }  # fmt: skip
    link = scene.body("link", rigid=rigid)
    scene.hinge_line(
        "H", base, link, axis="+y", aligned_angle="90 deg", hinges={"h": "root"},
        latch={"kind": "spring", "stiffness": 60.0},
    )  # fmt: skip
    scene.connection(
        "cord", "suspension", ports={"upper": (base, "top"), "lower": (link, "tip")},
        parameters={"stiffness": 40.0, "preload": 5.0, "preload_length": 0.9, "damping": damping},
    )  # fmt: skip
    return scene


def test_a_base_that_moves_on_evenly_is_as_one_at_rest():
    """Galilean invariance. Regression: dampers between base and bodies pulled at the base's rate, 53 N for 34."""
    still, moving = hung({}), hung({"translation": [{"profile": "ramp", "duration": 100, "change": 200}]})
    found = [fanfold.modes(scene, "deployed").frequencies for scene in (still, moving)]
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    loads = [fanfold.equilibrium(scene, "deployed").loads["cord"]["tension"][0] for scene in (still, moving)]
    assert loads[1] == pytest.approx(loads[0], rel=1e-9)


def test_damping_is_no_stiffness_in_a_spin():
    """Definition: undamped modes. Regression: joints with damping gave instabilities that there are none of."""
    turns = {"rotation": [{"profile": "ramp", "duration": 100, "change": 200}]}
    damped, free = (fanfold.modes(hung(turns, damping), "deployed").frequencies for damping in (20.0, 0.0))
    assert damped == pytest.approx(free, rel=1e-9)


def test_a_base_that_starts_turned_is_reported_as_in_a_run():
    """Rule: places are of the world, and modes of a body out of its place are others; whole turns change nothing.

    Regression: the run warned of it, the modes did not.
    """
    heard = []
    ramp = {"profile": "ramp", "duration": 100.0, "change": 300.0}
    for turn in (1.0, 80.0 * np.pi):
        law = [ramp, {"profile": "constant", "value": turn}]
        scene = rotor(3.0).with_settings({"base.motion.rotation": law})
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            fanfold.modes(scene)
        heard.append([one for one in warned if "wheel" in str(one.message)])
    assert [len(one) for one in heard] == [1, 0]


def test_what_spins_up_is_at_rest_where_its_law_begins():
    """Regression: rounding of a law that begins at rest was taken for a steady spin."""
    spinning_up = spun(0.0)
    law = [{"profile": "spin_up", "duration": 15.0, "rate": 4.0}]
    scene = spinning_up.with_settings({"base.motion.rotation": law})
    with pytest.warns(fanfold.FanfoldWarning, match="base.* 1 s.*W-modes-omitted"):
        found = fanfold.modes(scene)
    assert not found.turns
    assert found.frequencies == pytest.approx(fanfold.modes(spinning_up).frequencies, rel=1e-12)
