"""Friction of a hinge: stopping, sticking and sliding in closed form, and the torque of the forces on its pin."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from orchestrator.cosim.settings import Settings
from tests.references.closed_forms import coulomb_stop, stiction_overrun
from tests.references.coupled import Part, Tolerance, base, between, completed, rigid
from tests.references.relative_motion import inputs, port_motion, wrenches
from tests.unit.components.hinge.hinge_cases import STIFF, at, hinge, observed, outboard

INERTIA, FRICTION = 6.2514, 0.5
ITERATED = 1e-10  # relative to the largest torque and 1 N.m


def sliding_rotor(steps, rate=1.0, transition=0.0167, torque=0.0, order=2):
    """A rotor on a fixed base under 0.5 N.m of constant friction and a constant torque."""
    parts = [
        base(p=(0, 0, 0)),
        rigid("rotor", 7.0, (7.0, INERTIA, 8.0), {"p": (0, 0, 0)}, initial_angular_velocity=(0, rate, 0)),
        Part(
            "hinge", "hinge", {"harness_angle": (-1e3, 1e3), "harness_torque": (torque, torque)},
            {**STIFF, "friction_preload": FRICTION, "stiction_velocity": transition},
        ),
    ]  # fmt: skip
    settings = Settings(step_plan=[steps], order=order)
    links = between("hinge", "base.p", "rotor.p")
    return completed(sum(steps), parts, links, settings=settings, iteration=Tolerance(ITERATED))


@pytest.mark.parametrize("transition", [0.0167, 1e-3])
def test_coulomb_friction_stops_the_rotor(transition):
    """Reference: 12.5028 s and 6.2514 rad. Constant friction is exact at any step until the transition.

    Below it the friction fades, which adds an angle in closed form, the integral of J w dw / T(w). Steps are
    its midpoint rule in w, so they err by at most (h T / J)^2 / 8 times the change of the integrand's slope,
    J / T: h^2 T / (8 J) for steps that take less than the transition rate away.
    """
    time, angle = coulomb_stop(INERTIA, FRICTION, 1.0)
    assert (time, angle) == pytest.approx((12.5028, 6.2514), abs=5e-5)
    h = 3.0 * transition
    run = sliding_rotor([0.1] * 124 + [h] * 100, transition=transition)
    i = at(run, 10.0)
    rate = run.signal("hinge", "angular_rate")
    # the wrenches' iteration: 1.5e-10 of 0.5 N.m over ten seconds
    assert run.times[i] + rate[i] / (FRICTION / INERTIA) == pytest.approx(time, abs=3e-9)
    assert np.abs(rate[at(run, time) :]).max() < transition
    overrun = stiction_overrun(INERTIA, FRICTION, transition)
    resolved = h**2 * FRICTION / (8.0 * INERTIA)
    assert resolved < 0.03 * overrun
    stop = run.signal("hinge", "angle")[-1]
    assert stop - angle == pytest.approx(overrun, abs=resolved)
    assert run.signal("hinge", "friction_energy")[-1] == pytest.approx(0.5 * INERTIA, rel=3 * ITERATED)


def test_smooth_friction_is_of_fourth_order():
    """Order: halved steps leave a sixteenth of what is off, and of the heat; of second order it would be a quarter.

    The friction fades with the rate all the way.
    """
    runs = [sliding_rotor([h] * round(10.0 / h), transition=2.0, order=4) for h in (1.0, 0.5, 0.0625)]
    for signal in ("angle", "friction_energy"):
        coarse, fine, true = (run.signal("hinge", signal)[-1] for run in runs)
        assert 12.0 < (coarse - true) / (fine - true) < 20.0


def test_rotor_sticks_below_the_friction_torque_and_slides_above():
    """Coulomb's law: 0.4 N.m against 0.5 creeps below the transition rate; 0.6 accelerates with 0.1 N.m.

    The creep is where friction has risen to 0.8 of its value: 1.5 r - 0.5 r^3 = 0.8, r the share of the
    transition rate. Iteration leaves 1.6e-10 N.m, over a slope of 0.5 N.m per r.
    """
    creeping = sliding_rotor([0.1] * 100, 0.0, torque=0.4).signal("hinge", "angular_rate")
    (share,) = [r.real for r in np.roots((0.5, 0.0, -1.5, 0.8)) if 0.0 < r.real < 1.0]
    assert creeping.max() < 0.0167
    assert creeping[-1] == pytest.approx(share * 0.0167, rel=1e-9)
    moving = sliding_rotor([0.2] * 100, 0.0, torque=0.6).signal("hinge", "angular_rate")
    assert moving[-1] - moving[50] == pytest.approx(0.1 / INERTIA * 10.0, rel=2e-9)


@pytest.mark.parametrize(("bending_arm", "swing"), [(0.0, 0.0), (0.01, 2e-3)])
def test_friction_torque_of_the_pin_force(bending_arm, swing):
    """Bagnoli 2.2 and benchmark 5: mu 0.1, r 6 mm, 40 N make 0.0240 N.m; a bending moment M adds M / arm.

    The force is smoothed at 0.01 N: F^2 / sqrt(F^2 + (0.01 N)^2).
    """
    component, c = hinge(
        translational_stiffness=(0, 1e6, 1e6), rotational_stiffness=(0, 50.0, 50.0),
        friction_coefficient=0.1, pin_radius=0.006, friction_bending_arm=bending_arm,
    )  # fmt: skip
    tilt = Rotation.from_rotvec((swing, 0, 0))
    states = [
        inputs(component, port_motion(), port_motion((24e-6, 0, -32e-6), (tilt * twist).as_rotvec()))
        for twist in (Rotation.identity(), Rotation.from_rotvec((0, 0.1, 0)))
    ]
    y = component.step(c, component.initial(c, states[0]), states[1], 0.1)
    force = 40.0**2 / np.hypot(40.0, 0.01) + (50.0 * swing / bending_arm if bending_arm else 0.0)
    expected = -0.1 * 0.006 * force
    energy = observed(component, c, y, states[1])["friction_energy"]
    assert energy == pytest.approx(-expected * 0.1, rel=1e-12)
    if not swing:
        torque = wrenches(component.outputs(c, y, states[1]), 2)[1]
        assert torque[1, 1] == pytest.approx(-0.0240, abs=5e-5)
        assert torque[1, 1] == pytest.approx(expected, rel=1e-12)


def test_preload_friction_is_off_once_latched():
    """Sheet 2.0: the friction preload is set to zero at latch-up."""
    component, c = hinge("endpoint", {"latch": "spring"}, friction_preload=0.5, latch_angle=1.0)
    before = outboard(component, 0.9, rate=1.0)
    x = component.initial(c, before)
    assert observed(component, c, x, before)["friction_torque"] == pytest.approx(-0.5)
    after = outboard(component, 1.1, rate=1.0)
    assert observed(component, c, component.step(c, x, after, 0.2), after)["friction_torque"] == 0.0
