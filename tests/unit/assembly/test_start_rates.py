"""Rates at the start: those of laws, and of what joints carry along; closed forms of a chain, a turning base, a run."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble

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
