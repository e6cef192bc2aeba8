"""Motor drive: motion laws, torque of a driven inertia, the motor's work, static phase, impulses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from components.drive import Drive, Following, MotionLaw
from orchestrator.assembly import Part
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from orchestrator.cosim.settings import Settings
from tests.references.coupled import Run, Tolerance, base, between, completed, mastered, rigid
from tests.references.relative_motion import inputs, port_motion
from tests.unit.components.prepared import made

INERTIA = 12.0
PEAK_RATE = {"step": 1.5, "step5": 1.875}


@pytest.mark.parametrize("profile", PEAK_RATE)
def test_motion_laws(profile):
    """Reference: peak rates 1.5 and 1.875 h/T at the middle, for h = 1.2 in T = 2, from rest to rest."""
    law = MotionLaw(profile == "step5", -0.2, 1.2, 0.5, 2.0)
    times = np.linspace(0.5, 2.5, 2001)
    rates = np.array([law.rate(t) for t in times])
    assert rates.max() == law.rate(1.5) == pytest.approx(PEAK_RATE[profile] * 1.2 / 2.0, rel=1e-15)
    assert [law.angle(t) for t in (0.0, 0.5, 1.5, 2.5, 9.0)] == pytest.approx([-0.2, -0.2, 0.4, 1.0, 1.0])
    assert [law.rate(t) for t in (0.0, 0.5, 2.5, 9.0)] == pytest.approx([0.0] * 4, abs=1e-15)
    # the rate is the angle's: Simpson's rule, its error below h^4 / 2880 of the fourth derivative 360 h / T^5
    middles = np.array([law.rate(t) for t in 0.5 * (times[1:] + times[:-1])])
    turned = np.cumsum((rates[:-1] + 4.0 * middles + rates[1:]) / 6.0) * 1e-3
    assert turned == pytest.approx([law.angle(t) + 0.2 for t in times[1:]], abs=1e-12)


def test_peak_acceleration_of_step5():
    """Reference: 10 / sqrt(3) h/T^2 at 0.2113 T, which is 6928.2 mm/s2 for 1200 mm in 1 s."""
    law = MotionLaw(True, 0.0, 1.2, 0.0, 1.0)
    times = np.linspace(0.0, 0.5, 5001)
    # central differences err by d^2 / 6 of the third derivative of the rate, 360 h / T^4
    acceleration = np.array([(law.rate(t + 1e-5) - law.rate(t - 1e-5)) / 2e-5 for t in times])
    assert acceleration.max() == pytest.approx(6.9282, abs=5e-5)
    assert times[acceleration.argmax()] == pytest.approx(0.2113, abs=1e-4)


def test_acceleration_of_step_jumps_at_both_ends():
    """Reference: from 0 to 6 h/T^2 and from -6 h/T^2 to 0; the quotient errs by d / 2 of 12 h / T^3."""
    law = MotionLaw(False, 0.0, 1.2, 0.0, 1.0)
    ahead, behind = (law.rate(1e-6) - law.rate(0.0)) / 1e-6, (law.rate(1.0) - law.rate(1.0 - 1e-6)) / 1e-6
    assert (ahead, behind) == pytest.approx((7.2, -7.2), abs=1e-5)


def scene(profile="step5", **start):
    """A rotor on a hinge that is free about its line, and the drive beside the hinge."""
    stiff = {
        "translational_stiffness": (1e6,) * 3,
        "translational_damping": (1e3,) * 3,
        "rotational_stiffness": (0.0, 1e6, 1e6),
    }
    places = {"hinge": (0, 0, 0), "drive": (0, 0, 0)}
    return (
        [
            base(**places),
            rigid("rotor", 10.0, (10.0, INERTIA, 14.0), places),
            Part("hinge", "hinge", {}, stiff),
            Part("drive", "drive", {"profile": profile}, start),
        ],
        [*between("hinge", "base.hinge", "rotor.hinge"), *between("drive", "base.drive", "rotor.drive")],
    )


def balance(run: Run):
    """Kinetic, potential and dissipated less supplied energy over time (J)."""
    total = run.signal("rotor", "kinetic_energy") + run.signal("rotor", "potential_energy")
    for name in ("hinge", "drive"):
        total = total + run.signal(name, "potential_energy") + run.signal(name, "dissipated_energy")
        total = total + run.signal(name, "numerical_dissipation")
    return total - run.signal("drive", "supplied_energy")


def acceleration(law, t):
    """Closed form of the acceleration of both laws."""
    s = (t - law.start_time) / law.duration
    inside = (s > 0.0) & (s < 1.0)
    value = 60 * s * (1 - s) * (1 - 2 * s) if law.quintic else 6 * (1 - 2 * s)
    return np.where(inside, law.change / law.duration**2 * value, 0.0)


@pytest.mark.parametrize("h", [8e-3, 0.02])
def test_a_stiff_gearbox_follows_the_law(h):
    """Newton's law: J times the commanded acceleration, and the angle lags by that torque over the stiffness.

    STEP5 of the change d starts and ends with jumps of 60 d/T^3 of the jerk. They ring with that over w, where
    w^2 = K / J, and steps that do not resolve w (w h is 4.6 and 12) see them up to a step late. Between them the
    next term of the quasi-static series is 360 d / (T^4 w^2), and extrapolating means errs by a quarter h^2 of it.
    """
    stiffness, duration, change = 4e6, 2.0, 1.5
    start = {"end_angle": change, "duration": duration, "stiffness": stiffness, "damping": 1e3}
    iteration = Tolerance(1e-10, 1e-4, 1e-4)
    run = completed(2.2, *scene(**start), settings=Settings(fixed_step=h), iteration=iteration)
    law, t, w = MotionLaw(True, 0.0, change, 0.0, duration), np.array(run.times), np.sqrt(stiffness / INERTIA)
    jerk, snap = (INERTIA * change * n / duration**k for n, k in ((60, 3), (360, 4)))
    ringing = jerk / w + snap / w**2
    torque = run.signal("drive", "drive_torque")
    assert np.abs(torque - INERTIA * acceleration(law, t)).max() < ringing + jerk * h
    peak = INERTIA * 10 / np.sqrt(3) * change / duration**2
    assert torque.max() == pytest.approx(peak, abs=ringing + snap * h * h)
    angle = np.array([law.angle(s) for s in t])
    assert run.signal("drive", "commanded_angle") == pytest.approx(angle, abs=1e-12)
    assert np.abs(run.signal("drive", "angle") - angle).max() < (peak + ringing + jerk * h) / stiffness
    rate = np.sqrt(2 * run.signal("rotor", "kinetic_energy").max() / INERTIA)
    assert rate == pytest.approx(
        PEAK_RATE["step5"] * change / duration, abs=(ringing + jerk * h) / INERTIA * h
    )


def test_a_soft_gearbox_against_a_differential_equation():
    """Independent formulation: J q'' = -k (q - theta) - d (q' - theta') by SciPy; the mean torque is second order."""
    stiffness, damping, law = 300.0, 8.0, MotionLaw(False, 0.3, 0.8, 0.1, 1.2)

    def rates(t, y):
        torque = -stiffness * (y[0] - law.angle(t)) - damping * (y[1] - law.rate(t))
        return (y[1], torque / INERTIA, torque * law.rate(t), damping * (y[1] - law.rate(t)) ** 2)

    exact = solve_ivp(rates, (0, 2.0), (0.3, 0.0, 0.0, 0.0), rtol=1e-10, atol=1e-12, max_step=0.02).y[:, -1]
    start = {"aligned_angle": 0.3, "start_angle": 0.3, "end_angle": 1.1, "start_time": 0.1, "duration": 1.2}
    found = []
    for h in (0.02, 0.01):
        run = completed(
            2.0,
            *scene("step", stiffness=stiffness, damping=damping, **start),
            settings=Settings(fixed_step=h),
        )
        names = ("angle", "angular_rate", "supplied_energy", "dissipated_energy")
        found.append(np.array([run.signal("drive", name)[-1] for name in names]))
    errors = [np.abs(values - exact) for values in found]
    assert np.all(errors[1] < 0.35 * errors[0]), "not of second order"
    assert (4 * found[1] - found[0]) / 3 == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("stiffness", [100.0, 1e5])
@pytest.mark.parametrize("h", [0.3, 0.05, 0.02])
def test_energy_balance_at_any_step_size(h, stiffness):
    """Conservation law: the discrete gradient leaves the tolerance of the iteration, here 1e-10 per step."""
    run = completed(
        3.0, *scene(end_angle=2.0, duration=2.0, stiffness=stiffness, damping=5.0),
        settings=Settings(fixed_step=h), iteration=Tolerance(1e-10, 1e-4, 1e-4),
    )  # fmt: skip
    supplied = run.signal("drive", "supplied_energy")
    assert np.abs(supplied).max() > 1.0
    assert np.abs(balance(run) - balance(run)[0]).max() < 1e-6 * np.abs(supplied).max()


def test_several_turns():
    """The angle is unwrapped: two turns and a half, and back again from a start angle beyond one turn."""
    for start, end in ((0.0, 5 * np.pi), (4 * np.pi, -np.pi)):
        run = completed(
            3.6, *scene(start_angle=start, end_angle=end, duration=3.0, damping=100.0),
            settings=Settings(fixed_step=0.04),
        )  # fmt: skip
        assert run.signal("drive", "angle")[0] == pytest.approx(start)
        assert run.signal("drive", "angle")[-1] == pytest.approx(end, abs=1e-3)


def test_the_clock_starts_with_the_scene():
    """A static search before t = 0 holds the start angle: the motion is the same as without it, to its round-off."""
    found = []
    for preload in (False, True):
        parts, links = scene(end_angle=1.0, duration=0.5)
        run = mastered(Network(in_process(parts), links), Settings(fixed_step=0.05))
        run.master.initialize(preload=preload)
        run.master.run(0.5)
        found.append(run.signal("drive", "commanded_angle"))
        # of the row just after the search, whose hold has let go
        assert run.signal("drive", "supplied_energy")[0] == pytest.approx(0.0, abs=1e-30)
    assert found[0] == pytest.approx(found[1], abs=1e-14)
    assert (found[0][0], found[0][-1]) == (0.0, pytest.approx(1.0, abs=1e-12))


def drive(mode="mean", profile="step5", **start):
    values = {"stiffness": 300.0, "damping": 8.0, "end_angle": 1.2, "duration": 0.4, **start}
    return made(Drive, mode, {"profile": profile}, **values)


def observed(component, c, x, u):
    names = component.observation_layout.scalar_names()
    return dict(zip(names, component.observe(c, x, u).tolist(), strict=True))


def turned(component, angle, rate=0.0, **commands):
    motion = port_motion(turn=(0, angle, 0), spin=(0, rate, 0))
    return inputs(component, port_motion(), motion, **commands)


@given(h=st.floats(1e-7, 50.0))
def test_moments_of_following(h):
    """Independent quadrature: the first moment of the rate over a step, shorter or longer than the time constant."""
    law = Following(0.2, 1.0, 1.5, 0.7)
    exact = quad(
        lambda s: (2.0 * s - 1.0) * law.rate(1.0 + s * h) * h, 0.0, 1.0, epsabs=1e-14, epsrel=1e-11, limit=200
    )[0]
    assert law.rate_moment(1.0, 1.0 + h) == pytest.approx(exact, rel=1e-8, abs=1e-13)


def test_a_soft_gearbox_that_follows_a_command():
    """Independent formulation: J q'' = -k (q - a) - d (q' - a'), a' = (command - a) / tau, by SciPy.

    Mean torques are of second order in the step; extrapolated, 7e-5 are left. Wrenches of order 4 leave 4e-7 at
    this tolerance, where those of order 2 leave 1e-4.
    """
    stiffness, damping, command, tau = 300.0, 8.0, 0.8, 0.15

    def rates(t, y):
        rate = (command - y[2]) / tau
        torque = -stiffness * (y[0] - y[2]) - damping * (y[1] - rate)
        return (y[1], torque / INERTIA, rate, torque * rate, damping * (y[1] - rate) ** 2)

    exact = solve_ivp(rates, (0, 1.5), (0.3, 0.0, 0.3, 0.0, 0.0), rtol=1e-10, atol=1e-12).y[[0, 2, 3, 4], -1]
    start = {
        "aligned_angle": 0.3,
        "start_angle": 0.3,
        "end_angle": command,
        "duration": tau,
        "stiffness": stiffness,
        "damping": damping,
    }

    def found(**how):
        run = completed(1.5, *scene("commanded", **start), settings=Settings(**how))
        names = ("angle", "commanded_angle", "supplied_energy", "dissipated_energy")
        return np.array([run.signal("drive", name)[-1] for name in names])

    coarse, fine = (found(fixed_step=h) for h in (0.02, 0.01))
    assert np.all(np.abs(fine - exact) < 0.3 * np.abs(coarse - exact) + 1e-12)
    assert (4 * fine - coarse) / 3 == pytest.approx(exact, rel=2e-4)
    assert found(tolerance=1e-4, order=4) == pytest.approx(exact, rel=2e-6)


def test_hold_stops_clock_and_motor():
    """Definition: while hold is 1 neither the commanded angle nor the motor's work change, nor is there a rate."""
    component, c = drive()
    u = turned(component, 0.1, hold=1.0)
    x = component.initial(c, u)
    for _ in range(5):
        x = component.step(c, x, u, 0.1)
    z = observed(component, c, x, u)
    assert (z["commanded_angle"], z["commanded_rate"], z["supplied_energy"]) == (0.0, 0.0, 0.0)
    x = component.step(c, x, turned(component, 0.1), 0.2)
    assert observed(component, c, x, turned(component, 0.1))["commanded_angle"] == pytest.approx(0.6)


def test_an_impulse_makes_no_torque_of_its_own():
    """Closed form: after a vanishing impulse step the torque is that of the new rate, without extrapolation."""
    component, c = drive(end_angle=0.0)
    x = component.initial(c, turned(component, 0.0, 1.0))
    for k in range(1, 4):
        x = component.step(c, x, turned(component, 0.01 * k, 1.0), 0.01)
    assert observed(component, c, x, turned(component, 0.03, 1.0))["drive_torque"] == pytest.approx(
        -9.0 - 8.0
    )
    after = turned(component, 0.03, 0.2, impulse=1.0)
    y = component.step(c, x, after, 1e-7)
    assert np.abs(component.outputs(c, y, after)).max() < 20.0
    assert observed(component, c, y, after)["drive_torque"] == pytest.approx(-9.0 - 8.0 * 0.2, rel=1e-9)
    resting = turned(component, 0.03 + 0.002, 0.2)
    z = component.step(c, y, resting, 0.01)
    mean = component.outputs(c, z, resting)[:12].reshape(2, 6)[1, 4]
    assert mean == pytest.approx(-300.0 * 0.031 - 8.0 * 0.2, rel=1e-6)


def test_end_point_torque():
    """Definition: stiffness on the deflection and damping on its rate, equal and opposite on both ports."""
    component, c = drive("endpoint", "step", aligned_angle=0.5, start_angle=0.4)
    u = turned(component, 0.3, 2.0)
    x = component.initial(c, u)
    x[component.state_layout["clock"]] = 0.2  # half way
    z = observed(component, c, x, u)
    assert (z["angle"], z["commanded_angle"]) == pytest.approx((0.8, 0.8))
    torque = -8.0 * (2.0 - 1.5 * 0.8 / 0.4)
    assert z["drive_torque"] == pytest.approx(torque)
    assert component.outputs(c, x, u).reshape(2, 6)[:, 4] == pytest.approx((-torque, torque))
    assert component.rates(c, x, u) == pytest.approx((1.0, 8.0, torque * 3.0, 0.0))
