"""Rates at the start: those of laws, given ones, and of what joints carry along.

Closed forms of a chain, a turning base, tops (Euler, Jacobi) and cable loops; Lagrange's equation of a double four-bar
through its singular position. IFToMM's governor is in `tests/regression/linkages/test_published_benchmarks.py`.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from tests.references.rods import GRAVITY, four_bars, joined

LINK, HEIGHT, SPEED = 0.6, 0.5, 0.4
JOINTS = [("base", "foot", "lower", "a"), ("lower", "b", "upper", "b"), ("upper", "a", "top", "centre")]


def bar(mass):
    points = {"a": (0.0, 0.0, 0.0), "b": (LINK, 0.0, 0.0)}
    return {"mass": mass, "center_of_mass": (LINK / 2, 0, 0), "inertia": (0.01, 0.1, 0.1), "points": points}


def chain(law, until=0.2):
    """Two links hold a top that a motion lifts; revolutes across the plane x-z, a rail keeps the top on its line."""
    lean = float(np.arcsin(HEIGHT / (2 * LINK)))
    along = (float(np.cos(lean)), 0.0, float(np.sin(lean)))
    scene = fanfold.Scene("chain", until=until, largest_step=2e-3)
    scene.base(points={"foot": (0, 0, 0)})
    place = {"body": "base", "point": "foot"}
    scene.body("lower", rigid=bar(2.0), place={**place, "orientation": {"x": along}})
    down = {"x": (along[0], 0.0, -along[2])}
    scene.body("upper", rigid=bar(2.0), place={**place, "offset": (0, 0, HEIGHT), "orientation": down})
    top = {"mass": 5.0, "inertia": (0.3,) * 3, "points": {"centre": (0.0, 0.0, 0.0)}}
    scene.body("top", rigid=top, place={**place, "offset": (0, 0, HEIGHT)})
    for number, (body, point, other, at) in enumerate(JOINTS):
        ports = {"inboard": {"body": body, "point": point}, "outboard": {"body": other, "point": at}}
        scene.connection(f"pin_{number}", "hinge", ports=ports, preset="revolute", axes={"x": (0, 1, 0)})
    ports = {"inboard": {"body": "base", "point": "foot"}, "outboard": {"body": "top", "point": "centre"}}
    scene.connection(
        "guide", "hinge", ports=ports, preset="cylindrical", axes={"x": (0, 0, 1), "z": (1, 0, 0)}
    )
    structure = {"axis": (0, 0, 1), "law": [{"profile": "constant", "value": HEIGHT}, *law]}
    scene.connection("motion", "point_motion", ports=ports, structure=structure, parameters={"damping": 2e3})
    return scene


def rates(scene):
    parts = {part.name: part.start for part in assemble(scene.check()).parts}
    return {
        name: (start.get("initial_velocity", (0.0,) * 3), start.get("initial_angular_velocity", (0.0,) * 3))
        for name, start in parts.items()
    }


def test_a_chain_starts_as_its_motion_leads_it():
    """Closed form: z = 2 L sin t, so t' = z' / (2 L cos t); centres L/2 (-sin, cos) t' and z' less that."""
    found = rates(chain([{"profile": "ramp", "start": -1.0, "duration": 3.0, "change": 3 * SPEED}]))
    # the ramp has led for a second before the start
    height = HEIGHT + SPEED
    lean = np.arcsin(height / (2 * LINK))
    rate = SPEED / (2 * LINK * np.cos(lean))
    assert found["top"][0] == pytest.approx((0, 0, SPEED), abs=1e-9)
    assert found["lower"][1] == pytest.approx((0, -rate, 0), abs=1e-9)
    assert found["upper"][1] == pytest.approx((0, rate, 0), abs=1e-9)
    middle = 0.5 * LINK * rate * np.array((-np.sin(lean), 0.0, np.cos(lean)))
    assert found["lower"][0] == pytest.approx(middle, abs=1e-9)
    assert found["upper"][0] == pytest.approx(middle * (1, 0, 3), abs=1e-9)


def test_laws_that_start_at_rest_give_no_rates():
    """Definition: nothing moves."""
    found = rates(chain([{"profile": "step", "duration": 1.0, "change": 0.2}]))
    assert not np.any([velocities for velocities in found.values()])


def test_a_run_starts_without_a_jolt():
    """A steady slow motion takes 0.015 N against the links' inertia; bodies that began at rest would take 1957 N."""
    law = [{"profile": "ramp", "start": -1.0, "duration": 3.0, "change": SPEED}]
    result = fanfold.simulate(chain(law, until=0.05), estimate=False)
    assert np.abs(result["motion", "motion_force"][:]).max() < 0.1


def test_what_hangs_on_a_turning_base_turns_with_it():
    """Rigid motion: v = w x r about the pivot, of placed bodies and of those that hinge lines carry."""
    scene = fanfold.Scene("turning", until=0.1)
    turn = [{"profile": "ramp", "start": -1.0, "duration": 10.0, "change": 20.0}]
    scene.base(points={"mount": (1.0, 0, 0)}, motion={"rotation": turn, "pivot": (0.2, 0, 0)})
    scene.body("arm", rigid=bar(1.0))
    scene.hinge_line(
        "HL",
        "base",
        "arm",
        axis="+y",
        aligned_angle="180 deg",
        start_angle="180 deg",
        hinges={"h": ("mount", "a")},
    )
    found = rates(scene)
    lead = 2.0  # rad, at the start
    radius = (1.0 - 0.2 + LINK / 2) * np.array((np.cos(lead), np.sin(lead), 0.0))
    assert found["arm"][1] == pytest.approx((0, 0, 2.0), abs=1e-12)
    assert found["arm"][0] == pytest.approx(np.cross((0, 0, 2.0), radius), abs=1e-12)


INERTIA = np.array((10.0, 20.0, 25.0))  # kg.m2


def top(inertia, spin, until):
    """Nothing acts on a free base of these moments of inertia that starts with a spin (rad/s) and drifts."""
    scene = fanfold.Scene("top", until=until)
    free = {"mass": 100.0, "center_of_mass": (0.3, 0, 0), "inertia": list(inertia), "velocity": (0.1, 0, 0)}
    base = scene.base(points={"a": (0, 0, 0)}, free={**free, "angular_velocity": list(spin)})
    scene.connection("idle", "load", ports={"body": {"body": base, "point": "a"}})
    return fanfold.simulate(scene, tolerance=1e-5, estimate=False)


@pytest.mark.filterwarnings("ignore:.*W-idle-load")
def test_a_tumbling_body_follows_eulers_equations():
    """Closed form of an asymmetric body by Jacobi's elliptic functions, and conservation of energy and momenta."""
    one, three = 0.8, 0.9  # rad/s about the axes of least and largest inertia
    found = top(INERTIA, (one, 0.0, three), 30.0)
    a, b, c = INERTIA
    energy, momentum = a * one**2 + c * three**2, (a * one) ** 2 + (c * three) ** 2
    assert momentum > energy * b  # else the roles of the first and the third axis change
    pace = np.sqrt((c - b) * (momentum - energy * a) / (a * b * c))
    sn, cn, dn, _ = ellipj(
        pace * found.time, (b - a) * (energy * c - momentum) / ((c - b) * (momentum - energy * a))
    )
    second = np.sqrt((energy * c - momentum) / (b * (c - b)))
    expected = np.column_stack((one * cn, second * sn, three * dn))
    assert np.ptp(expected, axis=0).min() > 0.1
    assert np.abs(found["base", "attitude_rate"][:] - expected).max() < 1e-5 * three * pace * 30.0
    center = found["base", "frame_position"][-1] + found_axes(found)[-1] @ (0.3, 0, 0)
    assert center == pytest.approx((0.3 + 0.1 * 30.0, 0, 0), abs=1e-9)
    for name in ("kinetic_energy", "linear_momentum", "angular_momentum"):
        values = found["base", name][:]
        assert np.abs(values - values[0]).max() < 1e-12 * np.abs(values).max()


@pytest.mark.filterwarnings("ignore:.*W-idle-load")
def test_an_axisymmetric_top_precesses():
    """Closed form: the axis turns about the angular momentum L at L / A, the spin within the body at (C - A) / A."""
    found = top((20.0, 20.0, 30.0), (0.3, 0.0, 1.0), 20.0)
    turn = (30.0 - 20.0) / 20.0 * 1.0 * found.time
    expected = np.column_stack((0.3 * np.cos(turn), 0.3 * np.sin(turn), np.ones(turn.size)))
    assert np.abs(found["base", "attitude_rate"][:] - expected).max() < 1e-5 * turn[-1]
    momentum = np.array((6.0, 0.0, 30.0))
    along, angle = momentum / np.linalg.norm(momentum), np.linalg.norm(momentum) / 20.0 * found.time
    axis, across = np.array((0.0, 0.0, 1.0)), np.cross(along, (0.0, 0.0, 1.0))
    ahead = np.outer(np.cos(angle), axis - along[2] * along) + np.outer(np.sin(angle), across)
    assert np.abs(found_axes(found)[:, :, 2] - along[2] * along - ahead).max() < 1e-5 * angle[-1]


def found_axes(result):
    """Rotation matrices (N, 3, 3) of the base."""
    w, x, y, z = result["base", "frame_orientation"][:].T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def test_a_double_four_bar_passes_its_singular_position():
    """Lagrange: 3 a'' = -3.5 g cos a of five rods of 1 m and 1 kg, upright at 1 rad/s; singular where a = 0.

    The rate of one crank is given; those of the other four bodies follow. Joints of 5e6 N/m yield by 1e-5 m.
    """
    scene = four_bars(2, until=0.8)
    start = fanfold.check_scene(scene).start_motion
    assert start.kinetic_energy == pytest.approx(1.5, rel=1e-9)
    assert start.linear_momentum == pytest.approx((3.5, 0, 0), abs=1e-9)
    found = fanfold.simulate(scene, tolerance=1e-4, estimate=False)
    w, x, y, z = found["crank2", "frame_orientation"][:].T
    angle = np.unwrap(np.arctan2(2 * (x * z - w * y), 1 - 2 * (y * y + z * z)))

    def rates(_, state):
        return state[1], -3.5 * GRAVITY * np.cos(state[0]) / 3.0

    expected = solve_ivp(rates, (0, 0.8), (np.pi / 2, -1.0), rtol=1e-10, atol=1e-10, t_eval=found.time).y[0]
    assert expected[-1] < -0.3
    assert np.abs(angle - expected).max() < 5e-4
    assert found.headline.energy_residual < 2e-4


def cabled(second=None, **first):
    """Two bars on a base that spins, coupled 2 : 1 by a cable loop; the given rates of both lines."""
    scene = fanfold.Scene("cabled", until=0.05, preload=False)
    points = {"a": (0, 0, 0)}
    free = {"mass": 50.0, "inertia": (5.0,) * 3, "angular_velocity": (0.2, 0, 0.3), "velocity": (0, 1.0, 0)}
    scene.base(points=points, free=free)
    bar_of = {"mass": 2.0, "center_of_mass": (0.3, 0, 0), "inertia": (0.01, 0.1, 0.1)}
    for name in ("one", "two"):
        scene.body(name, rigid={**bar_of, "points": {"a": (0, 0, 0), "b": (LINK, 0, 0)}})
    first |= {"aligned_angle": "180 deg", "start_angle": "60 deg"}
    scene.hinge_line("HL1", "base", "one", axis="+y", hinges={"h1": ("a", "a")}, **first)
    given = {"aligned_angle": "240 deg"} | ({} if second is None else {"start_rate": second})
    scene.hinge_line("HL2", "one", "two", axis="-y", hinges={"h2": ("b", "a")}, **given)
    pulleys = {
        f"pulley_{n}": {"body": body, "point": "a", "radius": radius}
        for n, (body, radius) in enumerate((("base", 0.04), ("two", 0.02)), 1)
    }
    scene.ccl("loop", preload=1.0, strand_stiffness=1e3, **pulleys)
    return scene


def test_lines_of_a_cable_loop_start_in_their_ratio():
    """Kinematics: radii of 40 and 20 mm turn the lines 1 : 2; energy and momenta of the check are those of the run."""
    scene = cabled(start_rate=0.1)
    found = fanfold.simulate(scene, estimate=False)
    assert [found[hinge, "angular_rate"][0] for hinge in ("h1", "h2")] == pytest.approx([0.1, 0.2], rel=1e-6)
    start, bodies = fanfold.check_scene(scene).start_motion, ("base", "one", "two")
    assert sum(found[body, "kinetic_energy"][0] for body in bodies) == pytest.approx(
        start.kinetic_energy, rel=1e-9
    )
    for name in ("linear_momentum", "angular_momentum"):
        total = sum(found[body, name][:] for body in bodies)
        assert total[0] == pytest.approx(getattr(start, name), abs=1e-9)
        assert total[-1] == pytest.approx(total[0], abs=1e-6 * np.abs(total[0]).max())


def test_rates_that_contradict_each_other_are_refused():
    """Kinematics: lines in a ratio of 1 : 2, and a link that one cannot turn and move along with its foot fixed."""
    with pytest.raises(fanfold.FanfoldError, match=r"HL2\.start_rate: is 0\.1 rad/s.*HL1.* 0\.2 rad/s"):
        cabled(start_rate=0.1, second=0.1).check()
    scene = chain([])
    lean = float(np.arcsin(HEIGHT / (2 * LINK)))
    place = {"body": "base", "point": "foot", "orientation": {"x": (np.cos(lean), 0, np.sin(lean))}}
    scene.body("loose", rigid=bar(2.0), place=place, angular_velocity=(0, 0.5, 0), velocity=(1.0, 0, 0))
    joined(scene, "foot", "spherical", (0, 1, 0), ("base", "foot"), ("loose", "a"))
    with pytest.raises(fanfold.FanfoldError, match="rates at the start contradict each other"):
        scene.check()
