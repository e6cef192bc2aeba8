"""Bodies against closed forms: the free rotor, the damped oscillator, a held torque."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components.body import Body
from components.flexible.modal import ModalData
from tests.references.free_rotor import free_rotor
from tests.unit.components.body.body_cases import (
    HERTZ,
    extrapolated,
    flexible,
    modal_data,
    motions,
    no_wrench,
    observed,
    stepped,
)
from tests.unit.components.prepared import prepared


def rotor(**start):
    """A rigid body of I = (1, 2, 3) with one port in its centre of mass."""
    data = ModalData.rigid(2.0, (0.0, 0.0, 0.0), np.diag((1.0, 2.0, 3.0)), {"center": (0.0, 0.0, 0.0)})
    body = Body(modal=data.to_arrays(), ports=[{"name": "center", "point": "center"}])
    return body, prepared(body, **start)


def test_torque_free_asymmetric_rotor():
    """Closed form (elliptic functions) and the published w(10 s) of I = (1, 2, 3), w0 = (1, 0.01, 1).

    Extrapolated; the reference's elliptic functions err by 1e-11.
    """
    start = np.array([1.0, 0.01, 1.0])
    found = []
    for n in (600, 1200, 2400):
        body, c = rotor(initial_angular_velocity=start)
        x = stepped(body, c, body.initial(c, no_wrench(body)), no_wrench(body), 10.0 / n, n)
        found.append(Rotation.from_quat(np.roll(x[3:7], -1)).inv().apply(motions(body, c, x)[0, 10:]))
    value, bound = extrapolated(found)
    exact = free_rotor(np.array([1.0, 2.0, 3.0]), start).angular_velocity(10.0)
    assert bound < 1e-9
    assert np.abs(value - exact).max() < bound + 1e-11
    assert value == pytest.approx((-0.92490028, 0.38034125, 0.97560930), abs=0.6e-8)


def test_rigid_spin_up_by_a_held_torque():
    """Closed form: about a principal axis, w = T t / I and the angle T t^2 / 2 I, exact at any step size.

    The turn of a step is iterated to 1e-12 rad.
    """
    body, c = rotor()
    u = no_wrench(body)
    u[5] = 0.6
    x = stepped(body, c, body.initial(c, u), u, 0.1, 10)
    assert motions(body, c, x)[0, 12] == pytest.approx(0.2, rel=1e-13)
    assert 2 * np.arctan2(x[6], x[3]) == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize("zeta", [0.0, 0.01, 0.7, 1.0, 1.5])
def test_single_mode_decays_in_closed_form(zeta):
    """Closed form of the damped oscillator in one step of any size, and the energy it lost, to round-off."""
    data = modal_data(damping=zeta).keep_modes([1])
    body, c = flexible(data)
    w, eta, h = 2 * np.pi * HERTZ[1], 0.2, 0.137
    x = body.initial(c, no_wrench(body))
    x[17] = eta
    y = body.step(c, x, no_wrench(body), h)
    root = np.emath.sqrt(1.0 - zeta**2) * w
    ratio = h if root == 0 else np.sin(root * h) / root
    decay = np.exp(-zeta * w * h)
    assert y[17] == pytest.approx(eta * (decay * (np.cos(root * h) + zeta * w * ratio)).real, abs=1e-14)
    assert y[18] == pytest.approx(eta * (-decay * w * w * ratio).real, abs=1e-13)
    before = 0.5 * (w * eta) ** 2
    assert observed(body, c, y, "dissipated_energy") == pytest.approx(
        before - 0.5 * (y[18] ** 2 + (w * y[17]) ** 2), rel=1e-12, abs=1e-13 * before
    )


BENT = (0.02, -0.01, 0.004, 0.003)


def test_a_body_that_starts_bent_swings_from_there():
    """Closed form: the strain energy of its modal coordinates, and damped oscillations from them without a rate."""
    body, c = flexible(coupling="constant", initial_modal_coordinate=BENT)
    x = body.initial(c, no_wrench(body))
    assert observed(body, c, x, "potential_energy") == pytest.approx(
        0.5 * np.sum((2 * np.pi * HERTZ * BENT) ** 2), rel=1e-12
    )
    end, time = stepped(body, c, x, no_wrench(body), 0.01, 20), 0.2
    omega, ratio = body.data.frequency, body.data.damping_ratio
    damped, decay = omega * np.sqrt(1.0 - ratio**2), np.exp(-ratio * omega * time)
    phase = damped * time
    exact = BENT * decay * (np.cos(phase) + ratio * omega / damped * np.sin(phase))
    assert observed(body, c, end, "modal_coordinate") == pytest.approx(exact, rel=1e-10, abs=1e-14)


@pytest.mark.parametrize("coupling", ["rigid", "partial", "full"])
def test_a_bent_body_turns_as_it_is_told(coupling):
    """Definition: its angular momentum is that of the inertia it has when bent, and the rate stays what was given."""
    rate = np.array((0.3, -0.2, 0.5))
    body, c = flexible(coupling=coupling, initial_modal_coordinate=BENT, initial_angular_velocity=tuple(rate))
    x = body.initial(c, no_wrench(body))
    state = body.state_layout
    spin, eta = x[state["spin"]], np.array(BENT)
    assert body.inertia.angular_velocity(spin, eta, np.zeros(4)) == pytest.approx(rate, rel=1e-12)
    assert x[state["angular_velocity"]] == pytest.approx(rate, rel=1e-15)
