"""Loads at hinges between bodies, as vectors: by the balance of momentum, and as people are told."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from orchestrator.results.compare import compare
from orchestrator.results.estimated_errors import POINT_PEAKS
from orchestrator.results.signal import EVENT_WIDTH
from orchestrator.views.plots import draw_one

TOLERANCE = 1e-5
PROMISED_ERROR = 10.0 * TOLERANCE
"""What a run promises of its loads."""
WIDE = 0.5
AT = {"upper": (1.2, WIDE, 0.0), "lower": (1.2, -WIDE, 0.0)}  # m, hinges of the outer line on the inner plate
ENDS = {name: f"outer_{name}" for name in AT}


def plate(center, inboard, outboard):
    points = {"in_upper": (0, WIDE, 0), "in_lower": (0, -WIDE, 0)} | (AT if outboard else {})
    inertia = [0.4, 0.9, 1.2]
    return {"mass": inboard, "center_of_mass": center, "inertia": inertia, "points": points}


@pytest.fixture(scope="module")
def result():
    """Two rigid plates of which the outer one is lopsided, on a spacecraft that is free."""
    scene = fanfold.Scene("two_plates", until="3 s")
    points = {"upper": (0, WIDE, 0), "lower": (0, -WIDE, 0)}
    base = scene.base(points=points, free={"mass": 60, "center_of_mass": (-0.5, 0.1, 0), "inertia": [20] * 3})
    inner = scene.body("inner", rigid=plate((0.6, 0.0, 0.0), 6.0, True))
    outer = scene.body("outer", rigid=plate((0.5, 0.15, 0.02), 4.0, False))
    drive = {"motor": {"stowed": "2 N.m", "deployed": "1.5 N.m"}, "friction_preload": "0.1 N.m"}
    latch = {"stiffness": 2000, "effective_inertia": 4}
    ends = {"in_upper": "upper", "in_lower": "lower"}
    root = {f"root_{name}": (name, f"in_{name}") for name in ends.values()}
    tip = {f"outer_{name}": (name, f"in_{name}") for name in ends.values()}
    scene.hinge_line("L1", base, inner, axis="-y", aligned_angle="90 deg", hinges=root, latch=latch, **drive)
    scene.hinge_line("L2", inner, outer, axis="+y", aligned_angle="180 deg", hinges=tip, latch=latch, **drive)
    return fanfold.simulate(scene, rigid="all", tolerance=TOLERANCE)


def parts(result):
    """Rows between events."""
    times = [-1.0, *sorted(result.latch_times.values()), np.inf]
    assert len(times) == 4
    for start, end in pairwise(times):
        yield (result.time > start + EVENT_WIDTH) & (result.time < end - EVENT_WIDTH)


def test_loads_at_hinges_are_what_changes_the_momentum_of_the_outboard_plate(result):
    """Balance of linear and of angular momentum about the world's origin, over every part between events."""
    turn = Rotation.from_quat(result["inner", "frame_orientation"][:], scalar_first=True)
    place = result["inner", "frame_position"][:]
    force, moment = np.zeros_like(place), np.zeros_like(place)
    for name, point in AT.items():
        of_hinge = turn.apply(result[ENDS[name], "hinge_force"][:])
        force += of_hinge
        moment += turn.apply(result[ENDS[name], "hinge_torque"][:])
        moment += np.cross(place + turn.apply(point), of_hinge)
    for load, name in ((force, "linear_momentum"), (moment, "angular_momentum")):
        for rows in parts(result):
            time, momentum = result.time[rows], result["outer", name][:][rows]
            taken = CubicSpline(time, load[rows]).integrate(time[0], time[-1])
            size = np.trapezoid(np.linalg.norm(load[rows], axis=1), time)
            assert size > 0.1
            assert np.abs(taken - (momentum[-1] - momentum[0])).max() < PROMISED_ERROR * size


def test_a_hinge_on_the_spacecraft_brings_the_opposite_of_its_port(result):
    """Newton's third law, in the axes of the spacecraft: two records of one load that know nothing of each other."""
    for name in ("root_upper", "root_lower"):
        port = result["base", f"{name}.interface_force"][:]
        gap = np.linalg.norm(result[name, "hinge_force"][:] + port, axis=1)
        assert np.quantile(gap, 0.99) < PROMISED_ERROR * np.abs(port).max()


def test_people_are_told(result):
    """Table with errors, figure and role: each hinge between plates, none of those that are the ports' loads."""
    rows = {(row.quantity, row.of): row for row in result.headline.numbers()}
    for load, unit in (("force", "N"), ("torque", "N.m")):
        assert [of for quantity, of in rows if quantity == f"hinge {load} peak"] == list(ENDS.values())
        for name in ENDS.values():
            row = rows[f"hinge {load} peak", name]
            largest = np.linalg.norm(result[name, f"hinge_{load}"][:], axis=1).max()
            assert largest <= row.value < largest * (1.0 + 1e-4)
            assert row.unit == unit
            assert row.error < 2.0 * PROMISED_ERROR * row.value  # one of them has a warning
    expected = set()
    for load, unit in (("force", "N"), ("torque", "N.m")):
        sizes = np.max([np.abs(result[name, f"hinge_{load}"][:]).max(0) for name in ENDS.values()], axis=0)
        shown = zip("xyz", sizes > 1e-3 * sizes.max(), strict=True)
        expected |= {f"{load} {axis}, {unit}" for axis, seen in shown if seen}
    assert {axes.get_ylabel() for axes in draw_one(result, "hinge_loads").figure.axes} == expected


def test_the_row_right_after_a_latch_up_holds_the_loads_of_after_it(result):
    """Newton's third law of the jump: the damping of a latch acts on the spacecraft at once.

    Torques themselves differ by the force times what bushings give way, which does not jump.
    """
    rows = np.flatnonzero(np.abs(result.time - result.latch_times["L1"]) < EVENT_WIDTH)
    assert rows.size == 2
    hinges = sum(result[f"root_{name}", "hinge_torque"][:] for name in AT)[rows, 1]
    ports = sum(result["base", f"root_{name}.interface_torque"][:] for name in AT)[rows, 1]
    assert abs(np.diff(hinges)[0]) > 1.0
    assert np.diff(ports) == pytest.approx(-np.diff(hinges), rel=1e-3)


def test_comparisons_tell_attitude_and_loads_at_points(result):
    """Beside itself a result differs in nothing, and its numbers are those of its own table."""
    told = {(row.quantity, row.of): row for row in compare(result, result).rows}
    for number in result.headline.numbers():
        of = f"base {number.of}" if number.quantity.startswith("attitude") else number.of
        if number.quantity in ("attitude peak", *POINT_PEAKS):
            assert (told[number.quantity, of].b, told[number.quantity, of].ratio) == (number.value, 1.0)
    assert {"attitude peak", "attitude rate peak", *POINT_PEAKS} <= {quantity for quantity, _ in told}
