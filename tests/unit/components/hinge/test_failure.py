"""A joint that fails: no load from then on, what it stored as heat, no latch; all wrench modes, both languages."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrator.assembly import Part
from orchestrator.cosim.rows import recorded_layout
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import as_fmus
from tests.references.coupled import Tolerance, base, between, prepared, rigid
from tests.references.native_fmus import needs_native
from tests.unit.components.hinge.hinge_cases import AXIS, HARNESS, STIFF, hinge, observed, outboard

MASS, STIFFNESS, SPEED, H = 4.0, 900.0, 0.3, 2e-3
FAILURE = 0.3
WHOLE = {**HARNESS, "latch": "spring"}


def failed_at(time, until, native=False, structure=None, participants=None, **start):
    """A body on the springs of a joint that fails at a time, which is a communication point."""
    values = {"translational_stiffness": (STIFFNESS,) * 3, **start}
    parts = [
        base(point=(0, 0, 0)),
        rigid("body", MASS, (1, 1, 1), {"point": (0, 0, 0)}, initial_velocity=(SPEED, 0, 0), **TURNING),
        Part("joint", "hinge", {"axis": AXIS, **(structure or {})}, values),
    ]
    links = between("joint", "base.point", "body.point")
    run = prepared(
        parts,
        links,
        settings=Settings(fixed_step=H, order=4),
        iteration=Tolerance(1e-10),
        participants=participants,
    )
    run.master.run(time)
    joint = run.master.network.by_name["joint"]
    joint.inputs[joint.input_layout["failure_command"]] = 1.0
    run.master.run(until)
    return parts, run


TURNING = {"initial_angular_velocity": (0.05, 1.0, -0.1)}


def test_what_the_spring_held_is_heat_and_the_body_flies_on():
    """Closed form: x = (v / w) sin w t; the failure takes k x^2 / 2, and m v^2 cos^2(w t) / 2 flies on.

    Of order 4 the phase errs by (w h)^4 / 720 of itself, 1e-9 here; the body's turn is free of the springs. The
    iteration leaves 1e-10 of the work, which goes to and fro three times.
    """
    _, run = failed_at(FAILURE, 0.4)
    w, kinetic = np.sqrt(STIFFNESS / MASS), 0.5 * MASS * SPEED**2
    after = np.array(run.times) > FAILURE + 1e-9
    held = kinetic * np.sin(w * FAILURE) ** 2
    assert run.signal("joint", "failure_energy")[after] == pytest.approx(held, rel=1e-7)
    assert np.all(run.signal("joint", "axial_force")[after] == 0.0)
    assert np.all(run.signal("joint", "radial_force")[after] == 0.0)
    assert np.all(run.signal("joint", "potential_energy")[after] == 0.0)
    momentum = run.signal("body", "linear_momentum")[after]
    assert momentum[:, 0] == pytest.approx(MASS * SPEED * np.cos(w * FAILURE), rel=1e-7)
    assert np.ptp(run.scene("energy_residual")) < 3e-10 * kinetic


@needs_native
def test_the_native_joint_fails_like_it():
    """Independent path: all observations over a failure with motor, harness, friction and an engaged latch, to 1e-9."""
    start = {
        **STIFF,
        "friction_coefficient": 0.2,
        "friction_preload": 0.1,
        "motor_stiffness": 2.0,
        "motor_wind_up": 3.0,
    }
    parts, reference = failed_at(0.02, 0.06, structure=WHOLE, **start)
    with as_fmus(SimpleNamespace(name="scene", parts=parts), "native") as participants:  # type: ignore[arg-type]
        _, run = failed_at(0.02, 0.06, structure=WHOLE, participants=participants, **start)
        joint = run.master.network.by_name["joint"]
        for quantity in recorded_layout(joint.observation_layout).quantities:
            found, expected = (one.signal("joint", quantity.name) for one in (run, reference))
            assert found == pytest.approx(expected, abs=1e-9 * max(1.0, np.abs(expected).max())), (
                quantity.name
            )
        assert run.signal("joint", "failure_energy")[-1] > 1e-3


def test_an_end_point_joint_fails_at_a_step_or_an_event():
    """Definition: k x^2 / 2 of the bushing is heat, motor and harness keep theirs; no wrench, latch, power after it."""
    component, c = hinge(
        "endpoint",
        WHOLE,
        **STIFF,
        latch_angle=0.5,
        latch_stiffness=100.0,
        motor_stiffness=2.0,
        motor_wind_up=3.0,
    )
    start = outboard(component, 0.2, (1e-4, 0, 0), rate=1.0)
    x = component.initial(c, start)
    stored = observed(component, c, x, start)["potential_energy"]
    failing = outboard(component, 0.2, (1e-4, 0, 0), rate=1.0, failure_command=1.0)
    for failed in (component.step(c, x, failing, H), component.update(c, x, failing, True)):
        beyond = outboard(component, 0.6, (0.2, 0, 0), rate=1.0)
        later = component.step(c, failed, beyond, H)
        wrenches = component.outputs(c, later, beyond)
        assert np.all(wrenches[:12] == 0.0)
        assert wrenches[13] == 0.0  # not latched beyond the latch's angle
        told = observed(component, c, later, beyond)
        held = 0.5 * STIFF["translational_stiffness"][0] * 1e-4**2
        assert told["failure_energy"] == told["dissipated_energy"] == pytest.approx(held, rel=1e-9)
        assert told["failure_energy"] + told["potential_energy"] == pytest.approx(stored, rel=1e-12)
        assert told["motor_torque"] == 0.0
        assert component.rates(c, later, beyond) == pytest.approx((0.0, 0.0, 0.0), abs=0.0)
        assert component.indicators(c, later, beyond) == (1.0,)
    assert np.any(component.outputs(c, component.update(c, x, failing, False), start)[:12] != 0.0)


@pytest.mark.parametrize(
    "driven", [{"motor_constant_torque": 2.0}, {"motor_stiffness": 2.0, "motor_wind_up": 3.0}]
)
def test_what_drives_a_joint_makes_no_heat_of_its_failure(driven):
    """Rule: heat is never negative, and the zero of a motor's energy is nobody's; the balance closes all the same."""
    _, run = failed_at(FAILURE, 0.4, structure={**HARNESS, "latch": "none"}, **driven)
    after = np.array(run.times) > FAILURE + 1e-9
    held = 0.5 * MASS * SPEED**2 * np.sin(np.sqrt(STIFFNESS / MASS) * FAILURE) ** 2
    assert run.signal("joint", "failure_energy")[after] == pytest.approx(held, rel=1e-6)
    assert np.all(np.diff(run.signal("joint", "dissipated_energy")) >= -1e-12)
    assert np.ptp(run.scene("energy_residual")) < 1e-8
