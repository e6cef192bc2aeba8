"""The antenna unit: closed loops that a law moves, against the closed form of a chain, and the data sheet's numbers."""

from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from components.numerics.motion_law import MotionLaw
from orchestrator.assembly.assemble import assemble
from orchestrator.scene import find_scene, load_scene
from tests.references.dyad import Dyad

pytestmark = pytest.mark.slow
LINK = 0.6
BUSHING = 0.0573
VARIANTS = ("verification", "without_spacers", "diagonal", ("revolute", "step5"), "as_published")
"""Of which step5 changes the law alone, and so is laid over another."""
UP = 1.02
"""s; behind the end of the way up, which every law reaches at 1 s: the way down mirrors it."""
CHAINS = [f"{side}_base_{corner}" for side in "xy" for corner in range(1, 5)]


LINKS = {"rigid": (3.9405, 0.13113), "flexible": (3.7445, 0.11246)}
"""Mass (kg) and inertia (kg.m2) of a link: with rounded ends, and the beam, which has none."""

ROUNDED = {(16, "rigid"): 0.0005, (16, "flexible"): 0.0045, (8, "rigid"): 0.0089, (8, "flexible"): 0.0172}
"""What the thesis rounds away of a link (kg): 3.94, 3.74, 3.37 and 3.2 for 3.9405, 3.7445, 3.3789 and 3.1828."""


def run(variant=(), links="rigid"):
    """A variant up to the end of its way up, made once: a cache tells given arguments from those left out."""
    return _run(variant, links)


@cache
def _run(variant, links):
    flexible = "all" if links == "flexible" else ()
    scene = fanfold.load("antenna-unit", variant=variant)
    return fanfold.simulate(
        scene, flexible=flexible, estimate=False, until=None if variant == "verification" else UP
    )


def mass(part):
    return float(np.ravel(part.structure["modal"]["mass"])[0])


def reference(result, links="rigid"):
    """The closed form at the rows of a result of `verification`, and the mass of the top (kg)."""
    t = np.array(result["motion", "distance"].time)
    law = MotionLaw(
        [{"profile": "constant", "value": 0.12}, {"profile": "step5", "duration": 1.0, "change": 0.96}]
    )
    path = [np.array([function(s) for s in t]) for function in (law.value, law.rate, law.acceleration)]
    return t, Dyad(LINK, *LINKS[links], *path), 32.309


def test_the_closed_form_is_the_data_sheet():
    """Half-way of STEP5 from 10 to 90 %: 30 deg, 1.73205 rad/s, 4.40 N at the base, 12.95 N of the motion, 89.65 J."""
    one = Dyad(LINK, 3.9405, 0.13113, *(np.array([x]) for x in (0.6, 1.8, 0.0)))
    assert np.degrees(one.angle) == pytest.approx(30.0, abs=1e-12)
    assert one.angular_rate == pytest.approx(np.sqrt(3.0), abs=1e-12)
    assert np.hypot(*one.base[0]) == pytest.approx(4.40, abs=5e-3)
    assert 8 * one.top[0, 1] == pytest.approx(12.95, abs=5e-3)
    bushings = 8 * BUSHING * ((np.pi / 6) ** 2 - np.arcsin(0.1) ** 2)
    assert 0.5 * 32.309 * 1.8**2 + 8 * one.kinetic_energy + bushings == pytest.approx(89.65, abs=5e-3)


def test_the_closed_form_keeps_the_energy():
    """Power of the motion force is the rate of the kinetic energy; central differences of 1e-4 s err by 1e-8."""
    law = MotionLaw([{"profile": "step", "duration": 1.0, "change": 1.0, "start": -0.05}])
    t = np.linspace(0.1, 0.8, 71)
    before, now, after = (
        Dyad(
            LINK,
            3.0,
            0.1,
            *(np.array([f(s + d) for s in t]) for f in (law.value, law.rate, law.acceleration)),
        )
        for d in (-1e-4, 0.0, 1e-4)
    )
    power = (after.kinetic_energy - before.kinetic_energy) / 2e-4
    assert now.top[:, 1] * now.rate == pytest.approx(power, abs=1e-5)


@pytest.mark.parametrize("links", LINKS)
def test_verification_follows_the_closed_form(links):
    """From 0.1 s on, after the vibration of the mid joints that the start excites, within what the design asks.

    Angle 0.02 deg, work 0.1 %; forces within 1.5 N and 1 %: at 0.1 s a hundredth of the 300 N of the start is left,
    1.53 N at joints and 2.0 N of the motion, the same at a tolerance of 1e-5. Bushings, which the chain has not, take
    up to 1.9 N of the motion. Links bend by micrometres, so those that can follow it as well.
    """
    result = run("verification", links)
    t, chain, top = reference(result, links)
    after = t > 0.1
    angle = result["x_mid_1", "angle"][:]
    assert np.degrees(np.abs(np.abs(angle) - 2 * chain.angle))[after].max() < 0.02
    bushings = 8 * BUSHING * (chain.angle**2 - chain.angle[0] ** 2)
    energy = 0.5 * top * chain.rate**2 + 8 * chain.kinetic_energy + bushings
    assert np.abs(result["motion", "supplied_energy"][:] - energy)[after].max() < 1e-3 * energy.max()
    force = np.hypot(result["x_base_1", "axial_force"][:], result["x_base_1", "radial_force"][:])
    closed_form = np.hypot(*chain.base.T)
    assert np.all(np.abs(force - closed_form)[after] < 1.5 + 0.01 * closed_form[after])
    motion = (
        8 * (chain.top[:, 1] + 2.0 * BUSHING * chain.angle / (2.0 * LINK * chain.cosine))
        + top * chain.acceleration
    )
    found = result["motion", "motion_force"][:]
    assert np.all(np.abs(found - motion)[after] < 1.5 + 0.01 * np.abs(motion)[after])
    assert np.interp(0.5, t, np.degrees(np.abs(angle)) / 2) == pytest.approx(30.0, abs=0.02)
    assert np.interp(0.5, t, result["motion", "supplied_energy"][:]) == pytest.approx(
        np.interp(0.5, t, energy), rel=1e-3
    )


def between(result, variable, t):
    """Recorded values at other times, by cubics."""
    time, values = np.array(result[variable].time), np.array(result[variable])
    once = np.append(np.diff(time) > 0.0, True)
    return CubicSpline(time[once], values[once])(t)


@pytest.mark.thorough
def test_links_of_large_deformation_carry_what_modal_ones_do():
    """Two formulations, as the design asks: joint forces within 1 % of the largest, the top within 1e-6 m.

    After the vibration that the start excites, up to 30 deg. Links stay straight within micrometres, so four elements
    do; beams have ports of order 2, whose errors at the tolerance of 1e-4 are 0.1 to 0.2 %.
    """
    scene = fanfold.load("antenna-unit", variant="verification")
    scene = scene.with_settings({"array.corners.body.x_lower_{i}.beam.elements": 4})
    beams = fanfold.simulate(scene, large_deformation="all", until=0.5, tolerance=2e-5, estimate=False)
    modal, t = run("verification", "flexible"), np.linspace(0.1, 0.49, 400)
    top, other = (between(result, ("top", "frame_position"), t) for result in (modal, beams))
    assert np.abs(top - other).max() < 1e-6
    for joint in ("x_base_1", "x_mid_1", "x_top_1"):
        force, as_beams = (
            np.hypot(*(between(result, (joint, f"{way}_force"), t) for way in ("axial", "radial")))
            for result in (modal, beams)
        )
        assert np.abs(force - as_beams).max() < 0.01 * force.max(), joint


@pytest.mark.parametrize("variant", VARIANTS, ids=str)
def test_a_unit_stays_symmetric_and_keeps_its_energy(variant):
    """Top sideways below 1e-8 m, residual below 1e-5 of the work.

    Chains are alike to twice the 1e-7 of the largest force to which steps are iterated at the tolerance of 1e-4.
    """
    result = run(variant)
    place = result["top", "frame_position"][:]
    assert np.abs(place[:, :2] - 0.5).max() < 1e-8
    chains = [name for name in CHAINS if name.startswith("x") or variant != "diagonal"]
    forces = np.array([result[name, "radial_force"][:] for name in chains])
    assert np.ptp(forces, axis=0).max() < 2e-7 * forces.max()
    work = np.abs(result["motion", "supplied_energy"][:]).max()
    assert np.abs(result["scene", "energy_residual"][:]).max() < 1e-5 * work


def test_axial_forces_of_both_links_are_mirror_images():
    """M19: at 0.2 s 36.2 N of compression at the base end of the lower link, 39.8 N of tension at the upper's top."""
    result = run("verification")
    t, chain, _ = reference(result)
    row = int(np.abs(t - 0.2).argmin())
    axis = np.array((chain.cosine[row], chain.sine[row]))
    mirrored = axis * (-1.0, 1.0)
    assert float(chain.base[row] @ -axis) == pytest.approx(-36.2, abs=1.0)
    assert float(chain.top[row] @ mirrored) == pytest.approx(39.8, abs=1.0)
    along = result["x_base_1", "axial_force"][row] * axis[0]
    assert along == pytest.approx(chain.base[row, 0] * axis[0], abs=1.5)


@pytest.mark.parametrize(
    ("variant", "links", "heights", "rigid", "flexible"),
    [((), 16, (0.212, 1.388), 95.31, 92.11), ("without_spacers", 16, (0.012, 1.188), 88.77, 85.57),
     ("diagonal", 8, (0.0102, 1.0098), 52.69, 51.33)],
)  # fmt: skip
def test_masses_and_heights_of_the_data_sheet(variant, links, heights, rigid, flexible):
    """M2 and M3: 16, 16, 8 links; totals less a base frame of 32.27 or 25.73 kg.

    With rigid links 127.58, 114.5, 78.42 kg, with flexible ones 124.38, 111.3, 77.06 kg.
    """
    scene = load_scene(find_scene("antenna-unit"), [variant] if variant else [])
    for kind, total in (("rigid", rigid), ("flexible", flexible)):
        parts = [part for part in assemble(scene, **{kind: ("all",)}).parts if part.kind == "body"]
        assert len(parts) == 1 + links
        rounded = links * ROUNDED[links, kind]
        assert sum(map(mass, parts)) == pytest.approx(total, abs=1e-3 * total + rounded)
    height = run(variant)["top", "frame_position"][:][:, 2]
    assert (height[0], height.max()) == pytest.approx(heights, abs=1e-4)


def test_step_starts_with_the_acceleration_of_its_law():
    """M8: 6 h / T^2 = 7056 mm/s2 of a rigid top; through the motion's spring up to 1 + exp(-pi 0.05) times that."""
    result = run()
    momentum, t = result["top", "linear_momentum"][:][:, 2], np.array(result["top", "linear_momentum"].time)
    steps = np.diff(t) > 0.0
    acceleration = (np.diff(momentum)[steps] / np.diff(t)[steps]) / 32.309
    early = t[1:][steps] < 0.05
    assert acceleration[early].max() < 1.9 * 7.056
    assert result["motion", "commanded_acceleration"][0] == pytest.approx(7.056, abs=1e-9)


def test_a_top_that_follows_the_law_itself():
    """M8 by definition; the chains' forces are those through the stiff spring of the motion, away from the start.

    The spring gives by micrometres, and rings at the jumps of the law: compared where STEP is smooth, and by means.
    """
    led, driven = run("kinematic_top"), run()
    t = np.array(led["top", "shift"].time)
    law = MotionLaw([{"profile": "step", "duration": 1.0, "change": 1.176}])
    rising = t < 1.0
    expected = [0.212 + law.value(s) for s in t[rising]]
    assert led["top", "frame_position"][:][rising, 2] == pytest.approx(expected, abs=1e-12)
    residual = np.abs(led["scene", "energy_residual"][:]).max()
    assert residual < 1e-5 * np.abs(led["top", "supplied_energy"][:]).max()
    window, forces = np.linspace(0.4, 0.7, 301), {}
    for name, result in (("led", led), ("driven", driven)):
        load = result["x_base_1", "radial_force"]
        forces[name] = np.trapezoid(np.interp(window, load.time, load[:]), window) / 0.3
    assert forces["led"] == pytest.approx(forces["driven"], rel=0.02)


def gaps(scene, result):
    """Largest distance (m) of both ends of every joint over each tenth row, by joint."""
    points, rows = scene.points, slice(None, None, 10)
    turns = {body.name: result[body.name, "frame_orientation"].values[rows] for body in scene.bodies}
    places = {body: result[body, "frame_position"].values[rows] for body in turns}

    def at(seat):
        point = np.array(points[seat.body][seat.point])
        if seat.body not in turns:
            return point
        return places[seat.body] + Rotation.from_quat(turns[seat.body], scalar_first=True).apply(point)

    joints = [one for one in scene.connections if one.kind == "hinge"]
    ends = {one.name: at(one.ports["inboard"]) - at(one.ports["outboard"]) for one in joints}
    return {name: float(np.linalg.norm(apart, axis=1).max()) for name, apart in ends.items()}


def test_a_joint_that_fails():
    """Definition: at its instant, no load after it, its ends part, all others stay; the balance of energy stays closed.

    The data sheet's bound for the other joints is 0.1 mm; they give by microns, some tens of newtons over 5e6 N/m.
    """
    scene = fanfold.load("antenna-unit", variant="verification")
    scene.event("joint_fails", time="0.5 s", release=["x_mid_1"])
    result = fanfold.simulate(scene, until=0.95, tolerance=1e-3, estimate=False)
    ((time, name, text),) = result.events
    assert (time, name, text) == (pytest.approx(0.5, abs=1e-12), "joint_fails", "x_mid_1 released")
    after = np.array(result["x_mid_1", "radial_force"].time) > time
    for load in ("axial_force", "radial_force", "bending_moment"):
        assert np.all(result["x_mid_1", load].values[after] == 0.0)
    found = gaps(scene.check(), result)
    assert found.pop("x_mid_1") > 0.1
    assert max(found.values()) < 1e-4
    residual = result["scene", "energy_residual"].values
    assert np.abs(residual).max() < 1e-6 * np.abs(result["scene", "supplied_energy"].values).max()
