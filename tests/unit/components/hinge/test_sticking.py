"""Friction of a hinge that sticks: rest without creep, break-away, swings that end within the band of rest, energy."""

from math import sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrator.cosim.settings import Settings
from tests.references.coupled import Part, Tolerance, base, between, completed, rigid
from tests.unit.components.hinge.hinge_cases import STIFF, hinge, observed, outboard

INERTIA, FRICTION, STIFFNESS = 6.2514, 0.5, 200.0
DAMPING = sqrt(STIFFNESS * INERTIA)
"""N.m.s/rad, half of critical."""
ITERATED = 1e-10
STICKING = {
    **STIFF,
    "friction_preload": FRICTION,
    "presliding_stiffness": STIFFNESS,
    "presliding_damping": DAMPING,
}
LINKS = between("hinge", "base.p", "rotor.p")


def rotor(torque=0.0, rate=0.0, **start):
    """A rotor on a fixed base under 0.5 N.m of friction that sticks and a constant torque."""
    return [
        base(p=(0, 0, 0)),
        rigid("rotor", 7.0, (7.0, INERTIA, 8.0), {"p": (0, 0, 0)}, initial_angular_velocity=(0, rate, 0)),
        Part("hinge", "hinge", {}, {**STICKING, "motor_constant_torque": torque, **start}),
    ]


def run_of(steps, *arguments, **start):
    settings = Settings(step_plan=[steps])
    return completed(
        sum(steps), rotor(*arguments, **start), LINKS, settings=settings, iteration=Tolerance(ITERATED)
    )


def test_a_torque_below_the_friction_moves_nothing():
    """0.4 N.m against 0.5 for 300 s: at its start friction holds what the motor does, and nothing creeps.

    What is left are the wrenches' iterations: 1e-10 of 1 N.m over the stiffness, below 1e-12 rad.
    """
    run = run_of([3.0] * 100, 0.4)
    assert np.abs(run.signal("hinge", "angle")).max() < ITERATED / STIFFNESS
    assert run.signal("hinge", "friction_torque") == pytest.approx(-0.4, abs=1e-9)
    assert run.signal("hinge", "friction_energy")[-1] == 0.0


def test_a_load_that_swings_below_the_friction_does_not_make_it_drift():
    """Between 0.31 and 0.49 N.m, 11 swings without damping: the contact is a spring, whose energy the steps keep.

    The models of Dahl and LuGre drift here. Rows come at most 0.14 of a radian from a turning point: 1 % below it.
    """
    w, most = sqrt(STIFFNESS / INERTIA), 4.5e-4
    run = run_of([0.05] * 250, 0.4, w * most, presliding_damping=0.0)
    angle = run.signal("hinge", "angle")
    assert np.abs(angle).max() < most * (1.0 + 1e-6)
    for side in (-angle, angle):
        assert side[-100:].max() > 0.99 * most
    assert run.signal("hinge", "friction_energy")[-1] < 1e-9 * FRICTION * most


def test_above_the_friction_it_breaks_away_and_slides():
    """0.6 N.m against 0.5 from rest: phi = (0.1 N.m / J) t^2 / 2 from the start, exact at any step."""
    run = run_of([0.1] * 200, 0.6)
    time = np.array(run.times)
    assert run.signal("hinge", "angle") == pytest.approx(0.05 / INERTIA * time**2, rel=1e-8, abs=1e-12)


def turning_points(first, stiffness, count):
    """Turning points (rad) of a rotor on a spring with friction that sticks without damping, by its work.

    Between two of them friction takes T (A + B - 2 z), z = T / k of the contact being passed twice for nothing.
    """
    found, z = [first], FRICTION / STIFFNESS
    for _ in range(count):
        a = found[-1]
        # stiffness / 2 (a^2 - b^2) = T (a + b - 2 z)
        t = FRICTION / stiffness
        found.append(-t + sqrt(t * t + a * a - 2.0 * t * (a - 2.0 * z)))
    return found


def test_a_swing_on_a_spring_loses_what_friction_takes():
    """Each turning point follows from the one before by the work of friction; found by a parabola through three rows.

    With w h = 0.02 turning points err by (w h)^2 / 24 of a swing's curvature where the contact turns around, 4e-5.
    """
    spring = 5.0
    w = sqrt(spring / INERTIA)
    steps = [0.02 / w] * 500
    start = {"rotational_stiffness": (spring, 1e5, 1e5), "presliding_damping": 0.0}
    run = run_of(steps, 0.0, 1.5 * w, **start)
    angle = run.signal("hinge", "angle")
    turns = [
        i for i in range(1, len(angle) - 1) if (angle[i] - angle[i - 1]) * (angle[i + 1] - angle[i]) < 0.0
    ]
    found = []
    for i in turns[:3]:
        rise, bend = 0.5 * (angle[i + 1] - angle[i - 1]), angle[i + 1] - 2.0 * angle[i] + angle[i - 1]
        found.append(abs(angle[i] - 0.5 * rise * rise / bend))
    assert found == pytest.approx(turning_points(found[0], spring, 2), abs=4e-5)
    total = sum(run.signal(name, "kinetic_energy") for name in ("rotor",)) + sum(
        run.signal("hinge", kind)
        for kind in ("potential_energy", "dissipated_energy", "numerical_dissipation")
    )
    assert np.ptp(total) < 1e-8 * total[0]


def test_a_swing_ends_where_friction_holds_the_spring():
    """It rests within |phi| <= T / k of Coulomb's law, where an independent integration of the contact's law does.

    dz/dt = w but where |z| = T / k and z w > 0; LSODA at 1e-10. The steps' error is of second order, so a third of the
    difference from twice the step, and no more than that difference. After sticking, 12 s are 7 e-folds.
    """
    spring, rate, until = 5.0, 0.4, 12.0

    def law(_, y):
        angle, w, z = y
        held = np.clip(z, -FRICTION / STIFFNESS, FRICTION / STIFFNESS)
        slides = abs(z) * STIFFNESS >= FRICTION and z * w > 0.0
        torque = np.clip(STIFFNESS * held + DAMPING * w, -FRICTION, FRICTION)
        return w, (-spring * angle - torque) / INERTIA, 0.0 if slides else w

    exact = solve_ivp(
        law, (0.0, until), (0.0, rate, 0.0), method="LSODA", rtol=1e-8, atol=1e-10, max_step=0.01
    )
    start = {"rotational_stiffness": (spring, 1e5, 1e5)}
    ends = [run_of([h] * round(until / h), 0.0, rate, **start).signal("hinge", "angle") for h in (0.06, 0.03)]
    (coarse, fine) = (angle[-1] for angle in ends)
    assert abs(fine) < FRICTION / spring
    assert np.ptp(ends[1][-25:]) < 1e-5
    assert fine == pytest.approx(exact.y[0, -1], abs=abs(fine - coarse) + 1e-6)


def test_once_let_go_it_takes_over_what_the_hold_carried():
    """A hold against 0.4 N.m leaves friction with that torque, one against 0.9 N.m with all it can."""
    for torque, taken in ((0.4, 0.4), (0.9, FRICTION)):
        component, c = hinge(**{**STICKING, "presliding_damping": 0.0}, hold_stiffness=1e7)
        at_rest, moved = (outboard(component, angle, hold=1.0) for angle in (0.0, torque / 1e7))
        x = component.step(c, component.initial(c, at_rest), moved, 0.1)
        free = outboard(component, torque / 1e7, hold=0.0)
        assert observed(component, c, x, free)["friction_torque"] == pytest.approx(-taken, rel=1e-9)


def test_the_latch_lets_go_of_constant_friction():
    """What it stored is heat then, and nothing of it works (sheet 2.0: the preload is zero from latch-up on)."""
    component, c = hinge("mean", {"latch": "spring"}, **STICKING, motor_constant_torque=0.4)
    u = outboard(component, 0.0, latch_command=1.0)
    x = component.initial(c, outboard(component, 0.0))
    stored = 0.5 * 0.4**2 / STIFFNESS
    assert observed(component, c, x, outboard(component, 0.0))["potential_energy"] == pytest.approx(stored)
    after = observed(component, c, component.step(c, x, u, 0.1), u)
    assert after["friction_energy"] == pytest.approx(stored)
    assert after["friction_torque"] == 0.0


def test_of_an_end_point_it_follows_the_angle_in_any_parts():
    """Explicit hosts: the torque at an angle does not depend on how many steps led there."""
    component, c = hinge("endpoint", **{**STICKING, "presliding_damping": 0.0})
    for parts in (1, 7):
        x = component.initial(c, outboard(component, 0.0))
        for k in range(parts):
            u = outboard(component, 1e-2 * (k + 1) / parts)
            x = component.step(c, x, u, 0.1)
        assert observed(component, c, x, u)["friction_torque"] == -FRICTION
        back = outboard(component, 1e-2 - 1e-3)
        assert observed(component, c, x, back)["friction_torque"] == pytest.approx(-0.3)


@pytest.mark.parametrize("stiffness", [0.0, 400.0])
def test_hysteresis_takes_the_area_between_opening_and_closing(stiffness):
    """From 0 to 1 rad and back under 2 -+ W, W = 0.1 + 0.2 phi (N.m): heat of 0.4 J.

    A contact that sticks passes the last 2 W / k before the turn twice for nothing, 2 W^2 / k at W = 0.3 N.m. W is that
    in the middle of steps of 2.5 mrad, and the way back to sliding at its start: 0.2 x 2.5e-3 x 1.5e-3 J at the most,
    and as much again of second order in 2 W / k.
    """
    ends = {"motor_angle": (0.0, 1.0), "hysteresis_angle": (0.0, 1.0)}
    component, c = hinge(
        "mean",
        ends | {"motor_torque": (2.0, 2.0), "hysteresis_torque": (0.1, 0.3)},
        **STIFF,
        presliding_stiffness=stiffness,
    )
    x = component.initial(c, outboard(component, 0.0))
    for angle in (*np.linspace(0.0, 1.0, 401)[1:], *np.linspace(1.0, 0.0, 401)[1:]):
        u = outboard(component, angle)
        x = component.step(c, x, u, 0.01)
    turned = 2.0 * 0.3**2 / stiffness if stiffness else 0.0
    seen = observed(component, c, x, u)
    assert seen["friction_energy"] == pytest.approx(0.4 - turned, abs=1.5e-6 if stiffness else 1e-12)
    assert seen["motor_torque"] == 2.0
    assert seen["motor_energy"] == pytest.approx(0.0, abs=1e-12)
