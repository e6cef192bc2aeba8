"""What a base carries rigidly: interface loads are those on the base alone, by its own equations of motion."""

import numpy as np
import pytest

from components.body import Body
from components.body_parts.carried import Carried, products
from components.contract.component import ComponentError
from components.contract.frames import rotation_matrix
from components.fixed_base import FixedBase
from components.flexible.modal import ModalData
from tests.unit.components.body.test_base import POINTS, RATES, inputs, told
from tests.unit.components.prepared import prepared

OWN_MASS, OWN_CENTER, OWN_INERTIA = 7.0, np.array([0.1, 0.2, -0.3]), np.diag([1.0, 1.4, 1.2])
YOKE = Carried(
    2.0, np.array([0.8, -0.4, 0.5]), np.array([[0.3, 0.05, 0], [0.05, 0.4, -0.02], [0, -0.02, 0.2]])
)
AS_DATA = {"mass": YOKE.mass, "center_of_mass": YOKE.center_of_mass, "inertia": YOKE.inertia}


def about(center, mass):
    return mass * (center @ center * np.eye(3) - np.outer(center, center))


def both():
    """The base and what it carries as one rigid body."""
    mass = OWN_MASS + YOKE.mass
    center = (OWN_MASS * OWN_CENTER + YOKE.mass * YOKE.center_of_mass) / mass
    inertia = OWN_INERTIA + about(OWN_CENTER - center, OWN_MASS)
    inertia = inertia + YOKE.inertia + about(YOKE.center_of_mass - center, YOKE.mass)
    return ModalData.rigid(mass, center, inertia, POINTS)


def of_base_alone(load, omega):
    """Newton's and Euler's equations of the base, whose acceleration is that of the whole under a load."""
    whole = both()
    torque = load[3:] - np.cross(whole.center_of_mass, load[:3])
    turning = np.linalg.solve(whole.inertia, torque - np.cross(omega, whole.inertia @ omega))
    arm = OWN_CENTER - whole.center_of_mass
    own = OWN_MASS * (load[:3] / whole.mass + np.cross(turning, arm) + np.cross(omega, np.cross(omega, arm)))
    moment = OWN_INERTIA @ turning + np.cross(omega, OWN_INERTIA @ omega)
    return np.r_[own, np.cross(OWN_CENTER, own) + moment]


def test_shares_are_what_accelerates_the_base():
    """Newton and Euler for the base itself; the program has them for what it carries."""
    generator = np.random.default_rng(5)
    shares = YOKE.shares(both())
    for _ in range(5):
        load, omega = generator.standard_normal(6), 3.0 * generator.standard_normal(3)
        found = shares @ np.r_[load, products(omega)]
        np.testing.assert_allclose(found, of_base_alone(load, omega), rtol=1e-12, atol=1e-12)


def test_loads_of_a_base_that_turns_and_carries():
    """Closed form: loads linear in time, now and one step earlier; loads of single ports stay what they bring."""
    component = Body(
        both().to_arrays(), [{"name": n, "point": n} for n in POINTS], is_base=True, carried=AS_DATA
    )
    constants = prepared(component, initial_angular_velocity=(2.0, -1.0, 3.0))
    x, time, at = component.initial(constants, inputs(component, 0.0, 0.0)), 0.0, component.state_layout
    motions = []
    for h in (0.05, 0.08, 0.03):
        time += h
        u = inputs(component, time, h)
        x = component.step(constants, x, u, h)
        motions.append((rotation_matrix(tuple(x[at["orientation"]])), x[at["angular_velocity"]].copy(), time))
    z = component.observe(constants, x, u)
    for (axes, rate, then), lagged in zip(motions[:0:-1], ("", "_lagged"), strict=True):
        load = RATES * (1.0 + then)
        force, torque = load[:, :3] @ axes, load[:, 3:] @ axes
        brought = np.r_[force.sum(0), (torque + np.cross(list(POINTS.values()), force)).sum(0)]
        loads = told(component, z, lagged)
        assert loads[0] == pytest.approx(of_base_alone(brought, rate), rel=1e-11)
        assert loads[1:] == pytest.approx(np.hstack([force, torque]), rel=1e-11)


def test_a_fixed_base_bears_the_weight_of_what_it_carries():
    """Weight at the centre of mass, about the reference point."""
    gravity, reference = np.array([1.0, -9.0, 2.0]), np.array([0.2, 0.3, 0.4])
    ports = [{"name": "p", "position": (0, 0, 0)}]
    base = FixedBase(ports, tuple(reference), carried=AS_DATA, gravity=tuple(gravity))
    u, x = base.input_layout.start_values(), base.initial(None, np.zeros(0))
    z = base.observe(None, x, u)
    force = YOKE.mass * gravity
    expected = np.r_[force, np.cross(YOKE.center_of_mass - reference, force)]
    assert z[:6] == pytest.approx(expected, rel=1e-12)
    assert not z[len(z) // 2 :].any()
    for _ in range(2):
        x = base.step(None, x, u, 0.1)
    assert base.observe(None, x, u)[len(z) // 2 :][:6] == pytest.approx(expected, rel=1e-12)


def test_a_base_keeps_a_mass_of_its_own():
    with pytest.raises(ComponentError, match=r"9 kg .*9 kg"):
        Carried(9.0, YOKE.center_of_mass, YOKE.inertia).shares(both())
