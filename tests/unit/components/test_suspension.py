"""Suspension spring: oscillation, pendulum, slack, energy, action and reaction."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from components.suspension import Suspension
from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import Tolerance, base, between, completed, rigid
from tests.references.relative_motion import inputs, port_motion, resultant, work
from tests.unit.components.prepared import made

MASS, GRAVITY, STIFFNESS, LENGTH = 8.0, 9.81, 51.0, 1.2
WEIGHT = MASS * GRAVITY
POINT = st.tuples(*(st.floats(-0.4, 0.4),) * 3)
TIGHT = Tolerance(1e-10, 1e-4, 1e-4)


def scene(start=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), **change):
    """A body hung by its centre of mass, moved from the place where the preload carries its weight."""
    parts = [
        base(hook=(0, 0, LENGTH)),
        rigid(
            "body", MASS, (1.0, 1.0, 1.0), {"top": (0, 0, 0)},
            initial_position=start, initial_velocity=velocity, gravity=(0.0, 0.0, -GRAVITY),
        ),
        Part(
            "spring", "suspension", {},
            {"stiffness": STIFFNESS, "preload": WEIGHT, "preload_length": LENGTH, **change},
        ),
    ]  # fmt: skip
    return parts, between("spring", "base.hook", "body.top", ("upper", "lower"))


def hung(h, until, *motion, **change):
    """The same, after running to `until` in steps of size h."""
    return completed(until, *scene(*motion, **change), settings=Settings(fixed_step=h), iteration=TIGHT)


def energy(run):
    """Kinetic, potential and dissipated energy over time (J), the weight's included."""
    total = run.signal("body", "kinetic_energy") + run.signal("body", "potential_energy")
    return total + run.signal("spring", "potential_energy") + run.signal("spring", "dissipated_energy")


@pytest.mark.parametrize("damping", [0.0, 12.0])
def test_vertical_oscillation(damping):
    """Closed form: z = z0 e^(-b t) (cos w t + b / w sin w t) about the place where the preload is the weight.

    The mean force shifts frequencies by (w h)^2 / 12 of them, in phase w t times that; damping alike.
    """
    h, until, start = 1e-2, 2.5, -0.05
    run = hung(h, until, (0, 0, start), damping=damping)
    t, b = np.array(run.times), damping / (2 * MASS)
    w = np.sqrt(STIFFNESS / MASS - b * b)
    z = start * np.exp(-b * t) * (np.cos(w * t) + b / w * np.sin(w * t))
    v = -start * np.exp(-b * t) * (w + b * b / w) * np.sin(w * t)
    error = (np.sqrt(STIFFNESS / MASS) * h) ** 2 / 12 * (w + b) * until * abs(start)
    assert run.signal("spring", "length") == pytest.approx(LENGTH - z, abs=error)
    tension = WEIGHT - STIFFNESS * z - damping * v
    assert run.signal("spring", "tension")[2:] == pytest.approx(
        tension[2:], abs=4 * STIFFNESS * error + damping * w * w * h * h * abs(start)
    )


def test_equilibrium_at_the_preload():
    """Statics: the preload at the preload length is the weight, so nothing moves, to the iteration's tolerance."""
    run = hung(0.1, 2.0)
    assert run.signal("spring", "tension") == pytest.approx(np.full(21, WEIGHT), rel=1e-8)
    assert run.signal("spring", "length") == pytest.approx(np.full(21, LENGTH), rel=1e-8)


def test_elastic_pendulum():
    """Independent formulation: a point mass on a spring in polar coordinates by SciPy; of second order."""
    angle, rate = 0.5, 0.4
    place = (LENGTH * np.sin(angle), 0.0, LENGTH * (1 - np.cos(angle)))
    speed = LENGTH * rate
    velocity = (speed * np.cos(angle), 0.0, speed * np.sin(angle))

    def rates(t, y):
        length, turn, fast, spin = y
        tension = WEIGHT + STIFFNESS * (length - LENGTH)
        return (
            fast,
            spin,
            length * spin * spin + GRAVITY * np.cos(turn) - tension / MASS,
            -(2 * fast * spin + GRAVITY * np.sin(turn)) / length,
        )

    exact = solve_ivp(rates, (0, 1.5), (LENGTH, angle, 0.0, rate), rtol=1e-11, atol=1e-12).y[0, -1]
    coarse, fine = (hung(h, 1.5, place, velocity).signal("spring", "length")[-1] for h in (0.02, 0.01))
    assert abs(fine - exact) < 0.35 * abs(coarse - exact) < 1e-2
    assert (4 * fine - coarse) / 3 == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize("h", [0.3, 0.07, 0.02])
@pytest.mark.parametrize("damping", [0.0, 5.0])
def test_energy_balance_at_any_step_size(h, damping):
    """Conservation law, through slack phases: a free fall into the spring, thrown sideways."""
    run = hung(h, 6.0, (0.1, 0.0, 0.4), (0.6, 0.3, 0.0), stiffness=400.0, damping=damping)
    total, tension = energy(run), run.signal("spring", "tension")
    assert tension.min() == 0.0, "never slack"
    assert tension.max() > WEIGHT
    assert np.abs(total - total[0]).max() < 1e-6 * run.signal("body", "kinetic_energy").max()
    assert np.all(np.diff(run.signal("spring", "dissipated_energy")) >= 0.0)


def suspension(mode="mean", **change):
    values = {"stiffness": 50.0, "preload": 10.0, "preload_length": 1.0, "damping": 4.0, **change}
    return made(Suspension, mode, **values)


@given(first=POINT, second=POINT, turns=st.tuples(POINT, POINT), about=POINT)
def test_action_is_reaction_and_work_is_energy(first, second, turns, about):
    """Conservation laws of one step, for any motion of both ports: force, moment, and work against energy."""
    component, c = suspension()
    before = inputs(component, port_motion(first), port_motion((0, 0, -1.1), turns[0]))
    after = inputs(component, port_motion((0.1, 0, 0.2), turns[1]), port_motion(np.add(second, (0, 0, -0.9))))
    x = component.initial(c, before)
    y = component.step(c, x, after, 0.1)
    wrench = component.outputs(c, y, after)
    assert resultant(wrench, before, after, 2, about) == pytest.approx(np.zeros(6), abs=1e-12)
    (_, _, old, *_), (_, _, stored, heat, _) = (
        component.observe(c, state, u) for state, u in ((x, before), (y, after))
    )
    assert heat >= -1e-14
    assert work(wrench, before, after, 2) + stored - old + heat == pytest.approx(0.0, abs=1e-11)


def test_slack_gives_nothing():
    """Definition: below the length where the preload is used up there is neither force nor energy nor heat."""
    component, c = suspension()
    slack = 1.0 - 10.0 / 50.0
    u0 = inputs(component, port_motion(), port_motion((0, 0, -slack + 0.2)))
    u1 = inputs(component, port_motion(), port_motion((0, 0, -slack + 0.01), velocity=(0, 0, -1.9)))
    x = component.initial(c, u0)
    y = component.step(c, x, u1, 0.1)
    assert np.all(component.outputs(c, y, u1) == 0.0)
    assert component.observe(c, y, u1) == pytest.approx((slack - 0.01, 0, 0, 0, 0))
    taut = inputs(component, port_motion(), port_motion((0, 0, -slack - 0.03)))
    z = component.step(c, y, taut, 0.1)
    # three quarters of the stretch of 0.04 m are taut, at a rate of 0.4 m/s
    assert component.observe(c, z, taut)[3] == pytest.approx(0.75 * 4.0 * 0.4 * 0.04)


def test_end_point_tension():
    """Definition: preload, stiffness and damping along the line; damping never pushes."""
    component, c = suspension("endpoint")
    line = np.array((0.6, 0.0, -0.8))
    for rate, tension in ((0.5, 10 + 50 * 0.1 + 4 * 0.5), (-9.0, 0.0)):
        u = inputs(component, port_motion(), port_motion(1.1 * line, velocity=rate * line + (0.8, 0, 0.6)))
        x = component.initial(c, u)
        force = component.outputs(c, x, u).reshape(2, 6)
        assert force[1, :3] == pytest.approx(-tension * line, abs=1e-12)
        assert np.all(force[0] == -force[1])
        assert np.all(force[:, 3:] == 0.0)
        assert component.observe(c, x, u)[1] == pytest.approx(tension)
        assert component.rates(c, x, u) == pytest.approx(((tension - 15.0) * rate,))


def test_an_impulse_makes_no_tension_of_its_own():
    """Closed form: after a vanishing impulse step the tension is that of the new rate, without extrapolation."""
    component, c = suspension()

    def at(length, rate, **commands):
        lower = port_motion((0, 0, -length), velocity=(0, 0, -rate))
        return inputs(component, port_motion(), lower, **commands)

    x = component.initial(c, at(1.0, 1.0))
    for k in range(1, 4):
        x = component.step(c, x, at(1.0 + 0.01 * k, 1.0), 0.01)
    assert component.observe(c, x, at(1.03, 1.0))[1] == pytest.approx(10 + 50 * 0.03 + 4)
    after = at(1.03, 0.2, impulse=1.0)
    y = component.step(c, x, after, 1e-7)
    assert component.observe(c, y, after)[1] == pytest.approx(10 + 50 * 0.03 + 4 * 0.2)
