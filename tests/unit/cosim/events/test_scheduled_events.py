"""Events in a run: located to closed forms, with what they change of the energies."""

import numpy as np
import pytest

from orchestrator.assembly import Condition, Event, Part, Setting
from orchestrator.cosim.participant import ParticipantError
from orchestrator.cosim.settings import Settings
from tests.references.coupled import Tolerance, base, between, prepared, rigid

MASS, STIFFNESS, SPEED = 4.0, 900.0, 0.3
W = np.sqrt(STIFFNESS / MASS)
ENERGY = 0.5 * MASS * SPEED**2
LOOSENED = 400.0
ITERATED = 1e-11
"""What the iteration leaves of the work of a step; it goes to and fro less than three times."""


def oscillator(*events, until, step=2e-3):
    """A body that leaves x = 0 at a speed, on a joint along x."""
    parts = [
        base(point=(0, 0, 0)),
        rigid("body", MASS, (1, 1, 1), {"point": (0, 0, 0)}, initial_velocity=(SPEED, 0, 0)),
        Part("joint", "hinge", {"axis": (1, 0, 0)}, {"translational_stiffness": (STIFFNESS,) * 3}),
    ]
    links, settings = between("joint", "base.point", "body.point"), Settings(fixed_step=step, order=4)
    run = prepared(parts, links, settings=settings, iteration=Tolerance(ITERATED, 1e-9, 1e-9), events=events)
    run.master.run(until)
    return run


def passing(value, *, rising, **does):
    """An event when the body's x passes a value."""
    return Event("passing", None, Condition("body", "frame_position", 0, value, rising), **does)


@pytest.mark.parametrize("rising", [True, False])
def test_a_condition_is_located(rising):
    """Closed form: x = (v / w) sin w t passes half its amplitude at w t = pi / 6, and -0.3 of it after half a swing.

    The phase errs by (w h)^4 / 720 = 1e-9 of itself.
    """
    phase = np.pi / 6 if rising else np.pi + np.arcsin(0.3)
    value = SPEED / W * np.sin(phase)
    run = oscillator(passing(value, rising=rising, releases=("joint",)), until=0.5)
    ((time, name, text),) = run.events
    assert (name, text) == ("passing", "joint released")
    assert time == pytest.approx(phase / W, abs=1e-9)
    after = np.array(run.times) > time
    assert run.signal("body", "linear_momentum")[after, 0] == pytest.approx(
        MASS * SPEED * np.cos(phase), rel=1e-7
    )
    assert run.signal("joint", "dissipated_energy")[-1] == pytest.approx(0.5 * STIFFNESS * value**2, rel=1e-7)
    assert np.ptp(run.scene("energy_residual")) < 3 * ITERATED * ENERGY


def test_a_time_is_met_and_what_a_setting_changes_is_supplied():
    """Closed form: at t a spring of another stiffness takes over; (k' - k) x^2 / 2 is put in, and w' = sqrt(k' / m)."""
    at, until = 0.1234567, 0.4
    change = Event("soft", at, None, settings=(Setting("joint", "translational_stiffness", LOOSENED, "N/m"),))
    run = oscillator(change, until=until)
    assert run.events[0][0] == pytest.approx(at, abs=1e-12)
    x, v, w = SPEED / W * np.sin(W * at), SPEED * np.cos(W * at), np.sqrt(LOOSENED / MASS)
    later = w * (until - at)
    supplied = run.scene("supplied_energy")[-1]
    assert supplied == pytest.approx(0.5 * (LOOSENED - STIFFNESS) * x * x, rel=1e-7)
    end = run.signal("body", "frame_position")[-1, 0]
    assert end == pytest.approx(x * np.cos(later) + v / w * np.sin(later), rel=1e-6)
    assert np.ptp(run.scene("energy_residual")) < 3 * ITERATED * ENERGY


def test_an_event_may_follow_from_another():
    """Definition: a condition that another event makes true happens at the same instant, and both are rows."""
    first = Event("first", 0.05, None, releases=("joint",))
    second = Event(
        "second",
        None,
        Condition("joint", "failure_energy", 0, 1e-4, rising=True),
        settings=(Setting("body", "gravity", (0.0, 0.0, -2.0), "m/s2"),),
    )
    run = oscillator(second, first, until=0.25)
    assert [(round(time, 12), name) for time, name, _ in run.events] == [(0.05, "first"), (0.05, "second")]
    assert run.signal("body", "linear_momentum")[-1, 2] == pytest.approx(-MASS * 2.0 * 0.2, rel=1e-12)
    assert run.signal("joint", "potential_energy")[np.array(run.times) > 0.05] == pytest.approx(0.0, abs=0)


def test_a_condition_that_holds_from_the_start_is_refused():
    """Definition: it would never pass; the sentence tells value and both ways out."""
    with pytest.raises(ParticipantError, match=r"event.passing: .*body.*time = 0"):
        oscillator(passing(-1.0, rising=True, releases=("joint",)), until=0.1)
