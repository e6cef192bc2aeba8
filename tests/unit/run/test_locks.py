"""Kinematic latches of two wings on one base: close together, commanded at once, and what locks carry afterwards."""

import numpy as np
import pytest

import orchestrator as fanfold
from tests.unit.run.as_one.host import Host

TORQUE = 1.5
PANEL = {"mass": 5.0, "inertia": (0.6, 1.5, 2.0), "points": {"root": (0, 0, 0)}}
FREE = {"mass": 40.0, "center_of_mass": (0, 0, 0), "inertia": (12, 12, 12)}


def wings(earlier=0.0, **base):
    """Mirrored wings; the second latches so many degrees earlier."""
    scene = fanfold.Scene("wings", until="4 s")
    body = scene.base(points={"plus": (0.5, 0, 0.3), "minus": (-0.5, 0, 0.3)}, **base)
    for name, side in (("plus", 1.0), ("minus", -1.0)):
        wing = scene.body(f"wing_{name}", rigid={**PANEL, "center_of_mass": (0.8 * side, 0, 0)})
        scene.hinge_line(
            name, body, wing, axis="+y" if side > 0.0 else "-y", aligned_angle="90 deg",
            latch_angle=f"{90.0 - (earlier if side < 0.0 else 0.0)!r} deg",
            motor={"stowed": TORQUE, "deployed": TORQUE}, latch={"kind": "kinematic", "stiffness": 1e4},
            hinges={f"hinge_{name}": (name, "root")},
        )  # fmt: skip
    return scene


@pytest.mark.parametrize("earlier", [6e-6, 8e-6, 1e-5])
def test_a_line_that_passes_its_latch_in_the_impulse_of_another_locks(earlier):
    """Symmetry: with latches 0.1 to 0.2 us apart both take the same impulse. Regression: one swung through."""
    found = fanfold.simulate(wings(earlier), estimate=False)
    impulses = found.headline.latch_impulses
    assert impulses["plus"] == pytest.approx(impulses["minus"], rel=1e-5)
    assert found.signal("hinge_plus", "angular_rate")[-1] == pytest.approx(0.0, abs=1e-6)


def test_it_locks_in_the_one_fmu_too(tmp_path):
    """The same master in C: latch times of both."""
    (path,) = fanfold.export(wings(8e-6), tmp_path, as_one=True)
    host = Host(path).start().to(4.0, 0.5)
    assert host["plus.latch_time"] == pytest.approx(host["minus.latch_time"], abs=1e-6)
    assert host["minus.latch_time"] > 0.0


def test_lines_that_an_event_latches_lock_in_one_impulse():
    """Symmetry: a free base does not turn, so both wings lose the rate they have. Regression: 1.70 and 2.94 N.m.s."""
    scene = wings(free=FREE)
    scene.event("both", time="2 s", set={name: {"latch_command": 1} for name in ("plus", "minus")})
    impulses = fanfold.simulate(scene, estimate=False).headline.latch_impulses
    assert impulses["plus"] == pytest.approx(impulses["minus"], rel=1e-6)


def test_an_impulse_leaves_a_lock_no_rate_to_ring_with():
    """Closed form: a torque that a lock at rest takes all at once swings it to twice the torque, and no further.

    Regression: the impulse over the numerical inertia of a lock was left as a rate, worth more than the motor's torque.
    """
    motors = {f"hinge_line.{name}.motor": {"stowed": 6.0, "deployed": 0.1} for name in ("plus", "minus")}
    scene = wings().with_settings(motors)
    found = fanfold.simulate(scene, until=2.4, tolerance=1e-5, estimate=False)
    assert 0.1 < found.headline.latch_torque_peaks["plus"] < 0.2


def test_errors_of_a_locks_torque_are_not_told():
    """Rule: no step is meant to follow it. Regression: 126.4 +-0.4 N.m was told of a lock with 146.7 N.m.

    Nor of the torque of its hinges, which is the lock's.
    """
    found = fanfold.simulate(wings(), until=3.3)
    errors, hinge = found.headline.estimated_errors, "hinge_plus"
    assert ("latch impulse", "plus") in errors
    assert ("lock torque peak", "plus") not in errors
    assert ("attachment force peak", hinge) in errors
    assert ("attachment torque peak", hinge) not in errors


def chain():
    """Two panels; the outer one latches softly and still moves when the inner one locks."""
    scene = fanfold.Scene("chain", until="2.5 s")
    body = scene.base(points={"tip": (0, 0, 0)})
    panels = [
        scene.body(
            f"panel_{k}",
            rigid={
                "mass": 4.0, "inertia": (0.5, 0.7, 1.1), "center_of_mass": (0.6, 0, 0),
                "points": {"root": (0, 0, 0), "tip": (1.2, 0, 0)},
            },
        )
        for k in (1, 2)
    ]  # fmt: skip
    scene.hinge_line(
        "HL1", body, panels[0], axis="+y", aligned_angle="90 deg", motor={"stowed": 12.0, "deployed": 10.0},
        latch={"kind": "kinematic", "stiffness": 1e4}, hinges={"hinge_1": ("tip", "root")},
    )  # fmt: skip
    scene.hinge_line(
        "HL2", panels[0], panels[1], axis="-y", aligned_angle="180 deg", latch_angle="60 deg",
        motor={"stowed": 8.0, "deployed": 8.0},
        latch={"kind": "spring", "stiffness": 2.0, "damping_ratio": 2.0}, hinges={"hinge_2": ("tip", "root")},
    )  # fmt: skip
    return scene


def test_joints_without_rates_before_a_lock_are_no_row(tmp_path):
    """Definition: an instant has the row before a lock and the one after it; the one FMU has the impulse of the run.

    Regression: the impulse that stills joints first had a row, whose rates counted for peaks of other lines.
    """
    found = fanfold.simulate(chain(), estimate=False, tolerance=1e-5)
    instant = np.flatnonzero(np.abs(found.time - found.latch_times["HL1"]) < 5e-7)
    rates = [found[hinge, "angular_rate"][instant] for hinge in ("hinge_1", "hinge_2")]
    assert len(instant) == 2
    assert rates[0][1] == pytest.approx(0.0, abs=1e-8)
    assert rates[1][0] > 1.0
    assert rates[1][1] < -1.0
    (path,) = fanfold.export(chain(), tmp_path, as_one=True)
    host = Host(path).start().to(2.5, 0.5)
    assert abs(host["hinge_1.latch_impulse"]) == pytest.approx(found.headline.latch_impulses["HL1"], rel=1e-4)
