"""Thrusters and drag on the spacecraft itself are no loads that its appendages bring."""

import numpy as np
import pytest

import orchestrator as fanfold
from tests.unit.assembly.test_held_on_base import FREE, wing

PUSH = {
    "direction": (0.3, 0.2, 1.0),
    "frame": "body",
    "force": [{"profile": "ramp", "change": 40.0, "duration": 1.0}],
}
SHAKEN = {"motion": {"translation": [{"profile": "harmonic", "amplitude": 0.01, "frequency": 2.0}]}}
LOADS = ("interface_force", "interface_torque", "root.interface_force", "root.interface_torque")


def pushed(base, held, point="jet"):
    """The wing of a spacecraft, and a thruster on it."""
    scene = wing({**base, "points": {"root": (0.6, 0.1, 0.2), "jet": (-0.4, 0.3, 0.5)}}, held)
    scene.connection("thruster", "load", structure=PUSH, ports={"body": ("sc", point)})
    return scene


def simulated(scene):
    return fanfold.simulate(scene, estimate=False)


@pytest.mark.filterwarnings("ignore:.*W-no-end")
@pytest.mark.parametrize("held", [True, False], ids=["held", "free"])
def test_the_spacecraft_takes_up_thrust_beside_its_interface_loads(held):
    """Angular momentum of the spacecraft alone, about its centre of mass, by its own inertia and rate."""
    result = simulated(pushed(FREE, held))
    time, inertia = result.time, np.diag(FREE["free"]["inertia"])
    center = np.array(FREE["free"]["center_of_mass"])
    force, torque = result.signal("sc", "interface_force"), result.signal("sc", "interface_torque")
    direction = np.array(PUSH["direction"]) / np.linalg.norm(PUSH["direction"])
    thrust = 40.0 * time[:, None] * direction
    total = torque - np.cross(center, force) + np.cross(np.array((-0.4, 0.3, 0.5)) - center, thrust)
    rate = result.signal("sc", "attitude_rate")
    change = total - np.cross(rate, rate @ inertia)  # Euler's equations in body axes
    # trapezoids over some hundred steps
    assert rate[-1] @ inertia == pytest.approx(np.trapezoid(change, time, axis=0), rel=2e-3, abs=2e-3)


@pytest.mark.filterwarnings("ignore:.*W-no-end")
@pytest.mark.parametrize("base", [{}, SHAKEN], ids=["ground", "shaken"])
def test_thrust_on_what_does_not_give_way_changes_no_load(base):
    """Independent way: the same wing without a thruster, on a base whose motion nothing changes."""
    bare, driven = pushed(base, held=False), pushed(base, held=False)
    bare.tree["connection"].clear()
    without, found = simulated(bare), simulated(driven)
    for name in ("interface_force_peaks", "interface_torque_peaks"):
        assert getattr(found.headline, name) == pytest.approx(getattr(without.headline, name), rel=1e-4)
    assert np.abs(found.signal("sc", "thruster.interface_force")).max() > 30.0


@pytest.mark.filterwarnings("ignore:.*W-no-end")
def test_what_a_thruster_puts_in_is_no_energy_of_motors():
    """Balance: motors give what they do, and the thruster its own work. Regression: one number told both as motors'."""
    result = simulated(pushed(FREE, held=False))
    told = result.headline
    assert told.motor_energy == pytest.approx(
        sum(np.ptp(result.signal(name, "motor_energy")) for name in ("h1", "h2")), rel=1e-6
    )
    assert told.supplied_energy == pytest.approx(result.signal("thruster", "supplied_energy")[-1], rel=1e-9)
    assert any(number.quantity == "external work" for number in told.numbers())
