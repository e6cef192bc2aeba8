"""A rigid body that is the spacecraft: its attitude, and the loads at its ports in its own axes."""

import numpy as np
import pytest

from components.body import Body
from components.contract.component import ComponentError
from components.contract.frames import exponential, rotation_matrix
from components.flexible.modal import ModalData
from tests.unit.components.body.body_cases import modal_data
from tests.unit.components.prepared import prepared

POINTS = {"a": (0.3, -0.2, 0.1), "b": (-0.4, 0.5, 0.2)}
RATES = np.random.default_rng(3).standard_normal((2, 6))


def base():
    data = ModalData.rigid(7.0, (0.1, 0.2, -0.3), np.diag([1.0, 1.4, 1.2]), POINTS)
    ports = [{"name": name, "point": name} for name in POINTS]
    return Body(data.to_arrays(), ports, is_base=True)


def inputs(component, time, h):
    """Wrenches that grow linearly with time, as a step until then takes them."""
    u, at = component.input_layout.start_values(), component.input_layout
    for k, name in enumerate(POINTS):
        mean = RATES[k] * (1.0 + time - 0.5 * h)
        u[at[f"{name}.force"]], u[at[f"{name}.torque"]] = mean[:3], mean[3:]
        slope = RATES[k] * 0.5 * h
        u[at[f"{name}.force_slope"]], u[at[f"{name}.torque_slope"]] = slope[:3], slope[3:]
    return u


def told(component, z, lagged=""):
    """Loads in sum and of every port, shape (3, 6)."""
    at = component.observation_layout
    return np.array(
        [
            np.concatenate([z[at[f"{name}interface_{what}{lagged}"]] for what in ("force", "torque")])
            for name in ("", "a.", "b.")
        ]
    )


def expected(axes, time):
    """The wrenches of that time in the axes of the base, the sum about its construction frame's origin."""
    load = RATES * (1.0 + time)
    force, torque = load[:, :3] @ axes, load[:, 3:] @ axes
    moment = (torque + np.cross(list(POINTS.values()), force)).sum(0)
    return np.array([np.r_[force.sum(0), moment], *np.hstack([force, torque])])


def test_loads_are_told_in_the_axes_of_a_base_that_turns():
    """Closed form: loads linear in time, of which means and slopes know all, now and one step earlier."""
    component = base()
    constants = prepared(component, initial_angular_velocity=(2.0, -1.0, 3.0))
    x, time, axes = component.initial(constants, inputs(component, 0.0, 0.0)), 0.0, [np.eye(3)]
    for h in (0.05, 0.08, 0.03):
        time += h
        u = inputs(component, time, h)
        x = component.step(constants, x, u, h)
        axes.append(rotation_matrix(tuple(x[component.state_layout["orientation"]])))
    z = component.observe(constants, x, u)
    assert told(component, z) == pytest.approx(expected(axes[-1], time), rel=1e-12)
    assert told(component, z, "_lagged") == pytest.approx(expected(axes[-2], time - h), rel=1e-12)


def test_an_impulse_is_no_lasting_load():
    """Definition: the load before it stays; the motion takes it in as that of any body."""
    component = base()
    constants = prepared(component)
    u = inputs(component, 1.0, 0.1)
    x = component.step(constants, component.initial(constants, u), u, 0.1)
    before = told(component, component.observe(constants, x, u))
    assert before.any()
    u[component.input_layout["impulse"]] = 1.0
    struck = component.step(constants, x, u, 1e-7)
    # its axes have turned by 1e-7 s at 1 rad/s, about
    assert told(component, component.observe(constants, struck, u)) == pytest.approx(
        before, rel=1e-5, abs=1e-5
    )
    momentum = component.state_layout["momentum"]
    assert struck[momentum] - x[momentum] == pytest.approx(1e-7 * RATES[:, :3].sum(0) * 1.95, rel=1e-6)


@pytest.mark.parametrize("degrees", [1e-9, 40.0, 179.0, 190.0, 350.0])
def test_attitude_goes_on_beyond_half_a_turn(degrees):
    """Inverse of the quaternion of a rotation vector, which a body's own follows without a change of sign."""
    turn = np.radians(degrees) * np.array([0.6, 0.0, 0.8])
    component = base()
    constants, u = prepared(component), inputs(component, 0.0, 0.0)
    x = component.initial(constants, u)
    x[component.state_layout["orientation"]] = exponential(tuple(turn))
    z = component.observe(constants, x, u)
    assert z[component.observation_layout["attitude"]] == pytest.approx(turn, rel=1e-12)


def test_a_flexible_base_is_refused():
    with pytest.raises(ComponentError, match=r"is_base .*modes"):
        Body(modal_data().to_arrays(), [{"name": "p", "point": "0"}], is_base=True)
