"""End stop: a rotor thrown back, braked by damping, balance of energy at any step of both orders, failure, refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from components.end_stop import EndStop
from orchestrator.assembly import Event, Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import base, between, completed, rigid
from tests.references.relative_motion import inputs, port_motion, slope_work, work
from tests.unit.components.prepared import made

INERTIA, STIFFNESS, RATE, STOP = 2.0, 800.0, 0.5, 0.3
WIDE = st.floats(-0.4, 0.4)


def thrown(until, settings, damping=0.0, events=()):
    """A rotor on a stiff hinge that turns into a stop beside it."""
    stiff = {
        "translational_stiffness": (1e6,) * 3,
        "translational_damping": (1e3,) * 3,
        "rotational_stiffness": (0.0, 1e6, 1e6),
    }
    parts = [
        base(hinge=(0, 0, 0), stop=(0, 0, 0)),
        rigid(
            "rotor", 10.0, (3.0, INERTIA, 3.0), {"hinge": (0, 0, 0), "stop": (0, 0, 0)},
            initial_angular_velocity=(0.0, RATE, 0.0),
        ),
        Part("hinge", "hinge", {}, stiff),
        Part(
            "stop", "end_stop", {},
            {
                "stop_angle": STOP, "stiffness": STIFFNESS, "damping": damping,
                "full_damping_penetration": 5e-3,
            },
        ),
    ]  # fmt: skip
    links = [*between("hinge", "base.hinge", "rotor.hinge"), *between("stop", "base.stop", "rotor.stop")]
    return completed(until, parts, links, settings=settings, events=events)


def test_a_rotor_is_thrown_back():
    """Closed form without damping: half a sine of w = sqrt(k / J), peak torque w0 sqrt(k J), and back with -w0."""
    run = thrown(1.2, Settings(tolerance=1e-6))
    w = np.sqrt(STIFFNESS / INERTIA)
    torque, rate = run.signal("stop", "stop_torque"), run.signal("stop", "angular_rate")
    assert torque.max() == pytest.approx(RATE * np.sqrt(STIFFNESS * INERTIA), rel=1e-4)
    assert rate[-1] == pytest.approx(-RATE, rel=1e-5)
    inside = run.signal("stop", "in_contact") > 0.5
    since = np.array(run.times)[inside] - STOP / RATE
    assert torque[inside] == pytest.approx(RATE * np.sqrt(STIFFNESS * INERTIA) * np.sin(w * since), abs=2e-3)


def test_a_damped_stop_brakes():
    """Independent integration of J w' = -max(0, k p + c STEP(p / p_full) w), which never pulls, by LSODA."""
    damping, full = 30.0, 5e-3

    def torque(p, rate):
        s = np.clip(p / full, 0.0, 1.0)
        return max(0.0, STIFFNESS * max(p, 0.0) + damping * s * s * (3 - 2 * s) * rate)

    exact = solve_ivp(
        lambda t, y: (y[1], -torque(y[0] - STOP, y[1]) / INERTIA), (0.0, 1.2), (0.0, RATE),
        method="LSODA", rtol=1e-10, atol=1e-12, max_step=1e-3, dense_output=True,
    )  # fmt: skip
    run = thrown(1.2, Settings(tolerance=1e-6), damping)
    angle, rate = exact.sol(run.times)
    assert run.signal("stop", "penetration") + STOP == pytest.approx(angle, abs=2e-5)
    assert run.signal("stop", "angular_rate")[-1] == pytest.approx(rate[-1], rel=1e-3)
    highest = max(torque(a - STOP, r) for a, r in zip(*exact.sol(np.linspace(0.6, 0.8, 20001)), strict=True))
    assert run.signal("stop", "stop_torque").max() == pytest.approx(highest, rel=1e-3)
    lost = 0.5 * INERTIA * (RATE**2 - rate[-1] ** 2)
    assert run.signal("stop", "dissipated_energy")[-1] == pytest.approx(lost, rel=1e-3)


def stop(mode="mean", **values):
    return made(EndStop, mode, **{"stop_angle": 0.1, **values})


@given(
    start=WIDE,
    change=WIDE,
    moment=st.floats(-0.2, 0.2),
    damping=st.sampled_from((0.0, 5.0, 1e5)),
    order=st.sampled_from((2.0, 4.0)),
    h=st.sampled_from((1e-4, 1.0)),
)
def test_work_is_what_is_stored_and_lost(start, change, moment, damping, order, h):
    """Passivity: work taken = potential gained + heat + what the scheme took; heat is never negative, at any step."""
    component, c = stop(stiffness=10.0, damping=damping, full_damping_penetration=0.2, order=order)
    u0 = inputs(component, port_motion(), port_motion(turn=(0, start, 0)))
    u1 = inputs(component, port_motion(), port_motion(turn=(0, start + change, 0)))
    u1[component.input_layout["outboard.angular_velocity_moment"]] = (0, moment, 0)
    x0 = component.initial(c, u0)
    x1 = component.step(c, x0, u1, h)
    before, after = (component.observations.read(component.observe(c, *of)) for of in ((x0, u0), (x1, u1)))
    y = component.outputs(c, x1, u1)
    done = work(y, u0, u1, 2) + slope_work(component, y, u1, 2)
    heat, numerical = after.dissipated_energy, after.numerical_dissipation
    size = 1e-13 * (1.0 + before.potential_energy + after.potential_energy + heat)
    assert heat >= 0.0
    assert done + after.potential_energy - before.potential_energy + heat + numerical == pytest.approx(
        0.0, abs=size
    )


def test_a_stop_that_fails_lets_go_and_its_energy_is_heat():
    """Balance: released at the deepest turn, the rotor stands still and its energy is heat."""
    deepest = STOP / RATE + 0.5 * np.pi * np.sqrt(INERTIA / STIFFNESS)
    run = thrown(1.2, Settings(tolerance=1e-6), events=(Event("fails", deepest, None, releases=("stop",)),))
    assert abs(run.signal("stop", "angular_rate")[-1]) < 1e-4 * RATE
    assert run.signal("stop", "stop_torque")[-1] == 0.0
    assert run.signal("stop", "dissipated_energy")[-1] == pytest.approx(0.5 * INERTIA * RATE**2, rel=1e-5)


def test_it_never_opens_and_knows_more_than_one_turn():
    """Law of an instant: no torque while it leaves fast, and angles are unwrapped from where they started."""
    component, c = stop("endpoint", stiffness=10.0, damping=100.0, stop_angle=5.0, stowed_angle=4.0)

    def torque(angle, rate):
        u = inputs(component, port_motion(), port_motion(turn=(0, angle, 0), spin=(0, rate, 0)))
        seen = component.observations.read(component.observe(c, component.initial(c, u), u))
        return seen.stop_torque

    assert torque(4.9, 1.0) == 0.0
    assert torque(5.1, 0.0) == pytest.approx(1.0, rel=1e-12)
    assert torque(5.1, 0.02) == pytest.approx(3.0, rel=1e-12)
    assert torque(5.1, -0.02) == 0.0
