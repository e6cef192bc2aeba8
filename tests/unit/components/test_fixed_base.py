"""The fixed base: constant ports, and the interface load as a sum of moments."""

import numpy as np
import pytest
from numpy.polynomial import Legendre, Polynomial

from components.fixed_base import FixedBase

PLACES = np.array([(0.0, 0.0, 0.0), (0.2, 0.6, -0.1)])
REFERENCE = np.array([0.1, -0.3, 0.4])
NODES = np.linspace(0.0, 2.0, 5)


def base():
    return FixedBase(
        [{"name": f"p{i}", "position": tuple(p)} for i, p in enumerate(PLACES)], tuple(REFERENCE)
    )


def wrench(component, time):
    """Inputs of loads that grow linearly with time."""
    u = component.input_layout.start_values()
    u[:12] = np.arange(1.0, 13.0) * (1.0 + 2.0 * time)
    return u


def load(u):
    table = u[:12].reshape(2, 6)
    force = table[:, :3]
    moment = table[:, 3:] + np.cross(PLACES - REFERENCE, force)
    return np.concatenate((force.sum(0), moment.sum(0)))


def now(component, x, u, lagged=""):
    """The load at the communication point, or one step earlier."""
    z, at = component.observe(None, x, u), component.observation_layout
    return np.concatenate([z[at[f"interface_{name}{lagged}"]] for name in ("force", "torque")])


@pytest.mark.parametrize("lagged", ["", "_lagged"])
def test_every_port_tells_its_own_load(lagged):
    """Definition: the wrench of a port alone, about its origin, in the order of the ports."""
    component = base()
    u, x = wrench(component, 0.0), component.initial(None, wrench(component, 0.0))
    for _ in range(2):
        x = component.step(None, x, u, 0.1)
    z, at = component.observe(None, x, u), component.observation_layout
    told = [z[at[f"p{i}.interface_{name}{lagged}"]] for i in (0, 1) for name in ("force", "torque")]
    assert np.concatenate(told) == pytest.approx(u[:12], rel=1e-13)


def test_an_impulse_leaves_the_load_that_was_there():
    """Regression: loads fell to zero in the rows of a kinematic latch-up; the step after it starts anew."""
    component = base()
    x = component.initial(None, wrench(component, 0.0))
    for time in (0.05, 0.15):
        x = component.step(None, x, wrench(component, time), 0.1)
    before = now(component, x, wrench(component, 0.15))
    impulse = wrench(component, 7.0)
    impulse[component.input_layout["impulse"]] = 1.0
    for _ in range(2):
        x = component.step(None, x, impulse, 1e-7)
        assert now(component, x, impulse) == pytest.approx(before, rel=1e-12)
    x = component.step(None, x, wrench(component, 3.0), 0.1)
    assert now(component, x, impulse) == pytest.approx(load(wrench(component, 3.0)), rel=1e-12)


def test_ports_never_move():
    """Definition of a fixed base, whatever acts on it: poses, rates and first moments of its ports."""
    component = base()
    u = wrench(component, 1.0)
    u[13:] = np.arange(12.0)
    x = component.step(None, component.initial(None, u), u, 0.1)
    y = component.outputs(None, x, u)
    ports = y[:26].reshape(2, 13)
    assert np.array_equal(ports[:, :3], PLACES)
    assert np.array_equal(ports[:, 3:], np.tile([1.0, *[0.0] * 9], (2, 1)))
    assert np.array_equal(y[26:], np.zeros(12))


def test_interface_load_is_the_sum_about_the_reference_point():
    """Statics: sum of forces, sum of torques and of arms x forces."""
    component = base()
    u = wrench(component, 0.0)
    x = component.step(None, component.initial(None, u), u, 0.1)
    assert now(component, x, u) == pytest.approx(load(u), rel=1e-13)


@pytest.mark.parametrize("steps", [(0.1, 0.1), (0.1, 0.03), (0.02, 0.3)])
def test_load_at_the_communication_point_is_exact_for_linear_loads(steps):
    """Closed form: means belong to mid-step; a load linear in time is met at the end of the step."""
    component = base()
    x, time = component.initial(None, wrench(component, 0.0)), 0.0
    for h in steps:
        x = component.step(None, x, wrench(component, time + 0.5 * h), h)
        time += h
    expected = load(wrench(component, time))
    assert now(component, x, wrench(component, time)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("sizes", [(0.1, 0.1), (0.1, 0.03), (0.02, 0.3)])
def test_load_one_step_earlier_is_exact_for_cubic_loads(sizes):
    """Closed form: what means and slopes of the steps on both sides of a point know; zero before there are two."""
    component, shape, point = base(), Polynomial([1.0, -2.0, 3.0, -4.0]), 0.7
    x, time = component.initial(None, wrench(component, 0.0)), point - sizes[0]
    loads = np.arange(1.0, 13.0)
    for h in sizes:
        assert not now(component, x, wrench(component, 0.0), "_lagged").any()
        fit = Legendre.fit(time + 0.5 * h * NODES, shape(time + 0.5 * h * NODES), 3, [time, time + h])
        time += h
        u = wrench(component, 0.0)
        u[:12], u[13:] = fit.coef[0] * loads, fit.coef[1] * loads
        x = component.step(None, x, u, h)
    expected = load(shape(point) * loads)
    assert now(component, x, u, "_lagged") == pytest.approx(expected, rel=1e-12)


def test_an_impulse_is_no_lasting_load():
    """Definition: after an impulse the record starts anew."""
    component = base()
    u = wrench(component, 1.0)
    u[component.input_layout["impulse"]] = 1.0
    x = component.step(None, component.step(None, component.initial(None, u), u, 0.1), u, 1e-7)
    assert not component.observe(None, x, u).any()
