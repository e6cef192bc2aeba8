"""Eddy-current damper: terminal rate, time constant, peak-rate law, heat."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from components.damper import EddyCurrentDamper
from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import base, between, completed, rigid
from tests.references.relative_motion import inputs, port_motion, work
from tests.unit.components.prepared import made

INERTIA, COEFFICIENT, TORQUE = 115.3, 28.76, 1.6


def rotor(h, until, torque=TORQUE, peak_rate=0.0, rate=0.0):
    """A rotor on a stiff hinge with a constant harness torque, and the damper beside the hinge."""
    stiff = {
        "translational_stiffness": (1e6,) * 3,
        "translational_damping": (1e3,) * 3,
        "rotational_stiffness": (0.0, 1e6, 1e6),
    }
    harness = {"harness_angle": (-1e3, 1e3), "harness_torque": (torque, torque)}
    parts = [
        base(hinge=(0, 0, 0), damper=(0, 0, 0)),
        rigid(
            "rotor", 10.0, (100.0, INERTIA, 120.0), {"hinge": (0, 0, 0), "damper": (0, 0, 0)},
            initial_angular_velocity=(0.0, rate, 0.0),
        ),
        Part("hinge", "hinge", harness, stiff),
        Part("damper", "eddy_current_damper", {}, {"damping_coefficient": COEFFICIENT, "peak_rate": peak_rate}),
    ]  # fmt: skip
    links = [
        *between("hinge", "base.hinge", "rotor.hinge"),
        *between("damper", "base.damper", "rotor.damper"),
    ]
    return completed(until, parts, links, settings=Settings(fixed_step=h))


def test_terminal_rate_and_time_constant():
    """Reference: J w' = T - c w has 0.055633 rad/s and 4.0090 s; the mean rate makes it second order.

    Of the discrete rule, 1/tau errs by (h / tau)^2 / 12, and the extrapolation leaves (h / tau)^4.
    """
    tau = INERTIA / COEFFICIENT
    assert (TORQUE / COEFFICIENT, tau) == pytest.approx((0.055633, 4.0090), abs=5e-5)
    rates = []
    for h in (0.2, 0.1):
        run = rotor(h, 4.0)
        rates.append(run.signal("damper", "angular_rate"))
    exact = TORQUE / COEFFICIENT * (1 - np.exp(-4.0 / tau))
    assert rates[0][-1] == pytest.approx(exact, rel=(0.2 / tau) ** 2 / 12)
    assert (4 * rates[1][-1] - rates[0][-1]) / 3 == pytest.approx(exact, rel=(0.2 / tau) ** 4 + 1e-6)
    late = rotor(0.5, 60.0).signal("damper", "angular_rate")[-1]
    assert late == pytest.approx(0.055633, rel=np.exp(-60 / tau) + 1e-5)


def test_slowing_down_beyond_the_peak_rate():
    """Closed form of J w' = -c w / (1 + (w/wp)^2): ln(w/w0) + (w^2 - w0^2) / 2 wp^2 = -c t / J."""
    peak, start, until = 0.4, 1.0, 6.0

    def rest(w):
        return np.log(w / start) + (w * w - start * start) / (2 * peak * peak) + COEFFICIENT * until / INERTIA

    exact = brentq(rest, 1e-3, start, xtol=1e-14)
    rates = [rotor(h, until, 0.0, peak, start).signal("damper", "angular_rate")[-1] for h in (0.1, 0.05)]
    assert (4 * rates[1] - rates[0]) / 3 == pytest.approx(exact, abs=abs(rates[1] - rates[0]) * 0.02 + 1e-7)
    assert abs(rates[1] - rates[0]) < 1e-3


def damper(mode="mean", peak_rate=0.0):
    return made(EddyCurrentDamper, mode, damping_coefficient=COEFFICIENT, peak_rate=peak_rate)


def test_peak_rate_law():
    """Law of the magnetic brake: half the linear torque at the peak rate, which is its largest."""
    component, c = damper("endpoint", 0.4)

    def torque(rate):
        u = inputs(component, port_motion(), port_motion(spin=(0, rate, 0)))
        x = component.initial(c, u)
        value = float(component.observe(c, x, u)[1])
        assert component.outputs(c, x, u).reshape(2, 6)[:, 4] == pytest.approx((-value, value))
        return value

    assert torque(0.4) == pytest.approx(-0.5 * COEFFICIENT * 0.4, rel=1e-14)
    assert torque(-0.4) == pytest.approx(-torque(0.4))
    assert abs(torque(0.4)) > max(abs(torque(0.4 * f)) for f in (0.5, 0.99, 1.01, 2.0))
    assert torque(1e-6) == pytest.approx(-COEFFICIENT * 1e-6, rel=1e-10)


def test_mean_torque_points_along_the_mean_of_the_axis():
    """Definition: the torque of the mean rate along the mean of the axis at both ends of a tilting step."""
    component, c = damper()
    before = inputs(component, port_motion(), port_motion())
    tilt = Rotation.from_rotvec((0.4, 0, 0))
    turned = (tilt * Rotation.from_rotvec((0, 0.3, 0))).as_rotvec()
    after = inputs(component, port_motion(turn=(0.4, 0, 0)), port_motion(turn=turned))
    y = component.step(c, component.initial(c, before), after, 0.1)
    axis = 0.5 * (np.array((0, 1, 0)) + tilt.apply((0, 1, 0)))
    torque = component.outputs(c, y, after)[:12].reshape(2, 6)[:, 3:]
    assert torque[1] == pytest.approx(-COEFFICIENT * 3.0 * axis, rel=1e-12)
    assert torque[0] == pytest.approx(-torque[1])


@given(start=st.floats(-3, 3), change=st.floats(-3, 3), peak=st.sampled_from((0.0, 0.4)))
def test_heat_is_the_work_taken(start, change, peak):
    """Passivity: the heat is the work of both wrenches, never negative, also across half a turn."""
    component, c = damper(peak_rate=peak)
    u0 = inputs(component, port_motion(), port_motion(turn=(0, start, 0)))
    u1 = inputs(component, port_motion(), port_motion(turn=(0, start + change, 0)))
    y = component.step(c, component.initial(c, u0), u1, 0.1)
    heat = component.observe(c, y, u1)[2]
    assert heat >= 0.0
    assert work(component.outputs(c, y, u1), u0, u1, 2) + heat == pytest.approx(0.0, abs=1e-12 * (1 + heat))
    rate = change / 0.1
    assert heat == pytest.approx(
        COEFFICIENT * rate * change / (1 + (rate / peak) ** 2 if peak else 1), rel=1e-9, abs=1e-12
    )
