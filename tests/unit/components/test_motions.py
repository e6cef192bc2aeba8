"""Point motion and load: Newton's law, exact work, breaks that the master meets, native twins.

Motions at the stiff end of a body take thousands of steps, and run as native FMUs where there are some.
"""

import numpy as np
import pytest

from components.numerics.motion_law import MotionLaw
from orchestrator.assembly import Link, Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import Tolerance, base, between, completed, rigid

MASS, INERTIA = 12.0, (0.5, 0.8, 1.1)
NOWHERE = (0.0, 0.0, 0.0)
TIGHT = Tolerance(1e-11, 1e-9, 1e-9)


def energy(run, *names):
    """Energy that must stay as it is (J), over time."""
    total = run.signal("body", "kinetic_energy")
    for name in names:
        for kind, sign in (
            ("potential_energy", 1), ("dissipated_energy", 1), ("numerical_dissipation", 1), ("supplied_energy", -1)
        ):  # fmt: skip
            total = total + (sign * run.signal(name, kind) if has(run, name, kind) else 0.0)
    return total


def has(run, name, observation):
    return observation in run.master.network.by_name[name].observation_layout


def moved(law, until, h=None, order=4, stiffness=5e7, damping=5e3):
    """A body that a point motion along a tilted axis moves."""
    axis = (0.6, 0.0, 0.8)
    start = {"stiffness": stiffness, "damping": damping}
    parts = [
        base(point=NOWHERE),
        rigid("body", MASS, INERTIA, {"point": NOWHERE}),
        Part("motion", "point_motion", {"axis": axis, "law": law}, start),
    ]
    links = between("motion", "base.point", "body.point")
    settings = Settings(fixed_step=h, order=order, largest_step=0.05, tolerance=1e-5)
    return completed(until, parts, links, settings=settings, iteration=TIGHT)


@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("profile", ["step", "step5"])
def test_a_body_follows_the_law_and_the_ledger_closes(profile, order):
    """Newton's law: the work of the motion is the body's kinetic energy, m h'^2 / 2, and what damping took."""
    law = [{"profile": profile, "start": 0.1, "duration": 1.0, "change": 1.2}]
    run = moved(law, 1.4, order=order)
    t, motion = np.array(run.times), MotionLaw(law)
    # a spring of 5e7 N/m beside 12 kg gives way by m a / k; its ringing doubles that
    largest = MASS * 1.2 * (6.0 if profile == "step" else 5.7735) / 5e7
    expected = [motion.value(s) for s in t]
    assert run.signal("motion", "commanded_distance") == pytest.approx(expected, abs=1e-14)
    assert np.abs(run.signal("motion", "distance") - expected).max() < 2.0 * largest
    peak = run.signal("motion", "commanded_rate").max()
    assert run.signal("motion", "supplied_energy").max() == pytest.approx(0.5 * MASS * peak**2, rel=1e-2)
    balance = energy(run, "motion")
    assert np.abs(balance - balance[0]).max() < 1e-10 * 0.5 * MASS * peak**2


def test_steps_end_where_the_law_changes_its_form():
    law = [
        {"profile": "step", "start": 0.11, "duration": 0.37, "change": 0.2},
        {"profile": "ramp", "start": 0.3, "duration": 0.4, "change": 0.1},
    ]
    run = moved(law, 1.0)
    for time in MotionLaw(law).breaks:
        assert np.abs(np.array(run.times) - time).min() < 1e-9
    assert len(run.master.segments) == 1 + len(MotionLaw(law).breaks)


def test_fixed_steps_meet_breaks_as_well():
    run = moved([{"profile": "step", "start": 0.113, "duration": 0.4, "change": 0.2}], 0.8, h=0.01)
    assert np.abs(np.array(run.times) - 0.113).min() < 1e-9


def loaded(until, load, h=None, order=4, **start):
    """A free body under a load."""
    parts = [
        rigid("body", MASS, INERTIA, {"point": NOWHERE}, **start),
        Part("load", "load", load, {}),
    ]
    links = [Link(("body", "point"), ("load", "body"))]
    settings = Settings(fixed_step=h, order=order)
    return completed(until, parts, links, settings=settings, iteration=TIGHT)


def test_a_growing_force_makes_a_cubic_path():
    """Path F' t^3 / 6 m of a body while the force grows: exact of order 4, whatever the step."""
    force = [{"profile": "ramp", "duration": 5.0, "change": 50.0}]
    run = loaded(4.0, {"direction": (1.0, 0.0, 0.0), "force": force}, h=0.5)
    path = run.signal("body", "frame_position")[:, 0]
    assert path == pytest.approx(10.0 * np.array(run.times) ** 3 / (6 * MASS), rel=1e-12, abs=1e-12)
    balance = energy(run, "load")
    assert np.abs(balance - balance[0]).max() < 1e-12 * run.signal("body", "kinetic_energy").max()


def test_a_force_that_turns_with_the_body():
    """Spin 3 rad/s about z under a force along body x: the velocity is a circle of radius F / (m W)."""
    spin, force = 3.0, 6.0
    load = {"direction": (1, 0, 0), "frame": "body", "force": [{"profile": "constant", "value": force}]}
    errors = []
    for h in (0.1, 0.05):
        run = loaded(2.0, load, h=h, initial_angular_velocity=(0.0, 0.0, spin))
        t, momentum = np.array(run.times), run.signal("body", "linear_momentum")
        circle = force / spin * np.stack((np.sin(spin * t), 1.0 - np.cos(spin * t)), 1)
        errors.append(np.abs(momentum[:, :2] - circle).max())
        balance = energy(run, "load")
        assert np.abs(balance - balance[0]).max() < 1e-11
    assert errors[1] < errors[0] / 14.0  # order 4
    assert errors[0] < 1e-3


def test_a_torque_spins_a_body_up():
    """Euler: a torque about a principal axis of the body gives the impulse over the inertia; work is the energy."""
    torque = [{"profile": "harmonic", "amplitude": 2.0, "frequency": 0.5}]
    run = loaded(1.7, {"direction": (0, 0, 1), "frame": "body", "force": [], "torque": torque}, h=0.1)
    t = np.array(run.times)
    rate = 2.0 / (np.pi * INERTIA[2]) * (1 - np.cos(np.pi * t))
    # a rule with three points errs by h^6 / 2016000 of the sixth derivative, a share of 5e-10
    assert run.signal("body", "kinetic_energy") == pytest.approx(
        0.5 * INERTIA[2] * rate**2, rel=1e-8, abs=1e-12
    )
    assert run.signal("load", "supplied_energy") == pytest.approx(
        run.signal("body", "kinetic_energy"), abs=1e-12
    )
