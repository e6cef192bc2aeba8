"""A Bennett linkage of hinge lines with skew axes: four revolutes with -2 degrees of freedom by count, and it moves.

Links have the lengths a, b, a, b and the twists alpha, beta, alpha, beta, with sin(alpha) / a = sin(beta) / b. Closed
form (Bennett 1903): tan(t1 / 2) tan(t2 / 2) = sin((beta + alpha) / 2) / sin((beta - alpha) / 2).
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import orchestrator as fanfold

SHORT, ALPHA, BETA = 0.3, np.radians(40.0), np.radians(75.0)
LONG = SHORT * np.sin(BETA) / np.sin(ALPHA)
RATIO = np.sin(0.5 * (BETA + ALPHA)) / np.sin(0.5 * (BETA - ALPHA))
START = np.radians(100.0)
BEYOND = "7 rad"
"""Where lines without a latch would be deployed."""
BODIES = ("base", "crank", "coupler", "rocker")


def follower(angle):
    """The second angle from the first, in (0, 2 pi)."""
    return 2.0 * np.arctan2(RATIO * np.cos(0.5 * angle), np.sin(0.5 * angle))


def lines(angle):
    """Points (4, 3) on the four lines and their directions (4, 3), the first at the origin along z."""
    other, frame, origin = follower(angle), Rotation.identity(), np.zeros(3)
    points, axes = [], []
    for turn, length, twist in (
        (angle, SHORT, ALPHA),
        (other, LONG, BETA),
        (-angle, SHORT, ALPHA),
        (-other, LONG, BETA),
    ):
        points.append(origin)
        axes.append(frame.apply((0.0, 0.0, 1.0)))
        frame = frame * Rotation.from_rotvec((0.0, 0.0, turn))
        origin = origin + frame.apply((length, 0.0, 0.0))
        frame = frame * Rotation.from_rotvec((twist, 0.0, 0.0))
    assert np.abs(origin).max() < 1e-12, "the chain closes"
    assert frame.magnitude() < 1e-12
    return np.array(points), np.array(axes)


def linkage(until, **keys):
    """The linkage in world axes at the start: frames parallel, all angles zero; the last joint closes the loop.

    The third line counts against its axis, so that its angle is that of the first. keys: of lines by name.
    """
    points, axes = lines(START)
    scene = fanfold.Scene("bennett", until=until, largest_step=0.02)
    scene.base(points={"first": points[0].tolist(), "last": points[3].tolist()})
    for i, name in enumerate(BODIES[1:]):
        arm = points[i + 1] - points[i]
        scene.body(
            name,
            rigid={
                "mass": 1.0, "center_of_mass": (0.5 * arm).tolist(), "inertia": (0.01, 0.012, 0.015),
                "points": {"inner": (0.0, 0.0, 0.0), "outer": arm.tolist()},
            },
        )  # fmt: skip
        line = f"L{i + 1}"
        axis = axes[i] * (-1.0 if line == "L3" else 1.0)
        seat = "first" if i == 0 else "outer"
        scene.hinge_line(
            line, BODIES[i], name, axis=axis.tolist(), aligned_angle=0.0, hinges={f"h{i + 1}": (seat, "inner")},
            **{"latch_angle": BEYOND, **keys.get(line, {})},
        )  # fmt: skip
    ports = {"inboard": {"body": "base", "point": "last"}, "outboard": {"body": "rocker", "point": "outer"}}
    turned = {"x": axes[3].tolist(), "z": axes[0].tolist()}
    scene.connection("h4", "hinge", ports=ports, preset="revolute", axes=turned)
    return scene, axes


def opening(result):
    """Largest distance (m) of the ends of the closing joint."""
    points, _ = lines(START)
    turn = Rotation.from_quat(result["rocker", "frame_orientation"][:], scalar_first=True)
    outer = result["rocker", "frame_position"][:] + turn.apply(points[3] - points[2])
    return np.abs(outer - points[3]).max()


def test_it_is_mobile_against_the_count():
    """Theory: -2 by Gruebler, 1 by rank, three constraints that others imply."""
    found = fanfold.constraints(linkage(1.0)[0])
    assert (found.grubler, found.freedoms, len(found.redundant)) == (-2, 1, 3)


def test_it_closes_through_a_full_turn():
    """Closed form of the second angle; loads of 1 N beside 5e6 N/m let the closing joint open by less than 1e-6 m."""
    scene, axes = linkage(8.0)
    ports = {"inboard": {"body": "base", "point": "first"}, "outboard": {"body": "crank", "point": "inner"}}
    scene.connection(
        "drive", "drive", ports=ports, structure={"axis": axes[0].tolist(), "profile": "step5"},
        parameters={"end_angle": "360 deg", "duration": 8.0, "stiffness": 1e4, "damping": 20.0},
    )  # fmt: skip
    result = fanfold.simulate(scene, estimate=False)
    first, second, third = (result[f"h{i}", "angle"][:] for i in (1, 2, 3))
    assert first[-1] == pytest.approx(2.0 * np.pi, abs=1e-4)
    assert opening(result) < 1e-6
    expected = np.unwrap(follower(START + first)) - follower(START)
    assert np.abs(second - expected).max() < 1e-4
    assert np.abs(third - first).max() < 1e-4
    work = np.abs(result["scene", "supplied_energy"][:]).max()
    assert np.abs(result["scene", "energy_residual"][:]).max() < 1e-4 * work


@pytest.mark.filterwarnings("ignore:.*W-no-end")  # it latches by a command
def test_a_line_latches():
    """Closed form: as the third line reaches its latch, the second is where the first, at the same angle, puts it."""
    angle = np.radians(60.0)
    keys = {
        "L1": {"motor": {"stowed": 0.4, "deployed": 0.2}, "latch_angle": angle},
        "L3": {"latch_angle": angle, "latch": {"stiffness": 3000.0, "outboard_stiffness": 3000.0}},
    }
    result = fanfold.simulate(linkage(4.0, **keys)[0], estimate=False)
    latch_up = result.latch_times["L3"]
    after = result.at(latch_up)
    assert after["h3", "angle"] == pytest.approx(angle, abs=1e-6)
    assert after["h1", "angle"] == pytest.approx(angle, abs=1e-4)
    assert after["h2", "angle"] == pytest.approx(follower(START + angle) - follower(START), abs=1e-4)
    held = np.array(result["h3", "angle"].time) > latch_up
    assert np.abs(result["h3", "angle"][:][held] - angle).max() < 0.02
