"""What joints carried before and after events: two joints that share a weight until one is released."""

import pytest

import orchestrator as fanfold
from orchestrator.results.point_loads import event_loads

MASS, GRAVITY = 3.0, 9.81


def test_what_one_joint_leaves_the_other_takes():
    """Closed form: at rest half the weight each; then all of it, which a spring overshoots by the other half."""
    scene = fanfold.Scene("hanging", until="30 ms", preload=True, gravity=(0, 0, -GRAVITY), tolerance=1e-5)
    scene.base(points={"hook": (0, 0, 0)})
    rigid = {"mass": MASS, "center_of_mass": (0, 0, 0), "inertia": (0.1,) * 3, "points": {"eye": (0, 0, 0)}}
    scene.body("weight", rigid=rigid, place={"body": "base", "point": "hook"})
    ports = {"inboard": {"body": "base", "point": "hook"}, "outboard": {"body": "weight", "point": "eye"}}
    for name in ("one", "other"):
        scene.connection(name, "hinge", ports=ports, preset="fixed", axes={"x": (1, 0, 0)})
    scene.joint(radial_stiffness=2e5, damping_ratio=0.0)
    scene.event("fails", time="10 ms", release=["other"])
    found = {
        (load.joint, load.unit): load
        for load in event_loads(fanfold.simulate(scene, estimate=False))
        if load.unit == "N"
    }
    weight = MASS * GRAVITY
    assert [load.time for load in found.values()] == pytest.approx([0.01, 0.01], abs=1e-9)
    assert found["one", "N"].before == pytest.approx(0.5 * weight, rel=1e-5)
    assert found["one", "N"].after == pytest.approx(1.5 * weight, rel=1e-3)
    assert found["one", "N"].ratio == pytest.approx(3.0, rel=1e-3)
    assert (found["other", "N"].before, found["other", "N"].after) == pytest.approx(
        (0.5 * weight, 0.0), rel=1e-5
    )
