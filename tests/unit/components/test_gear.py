"""Gear, bevel gear and rack: conservation laws of a step, and a train against its equation of motion."""

import numpy as np
import pytest

import orchestrator as fanfold
from components.contract.component import ComponentError
from components.gear import Gear
from tests.references.closed_forms import bouncing
from tests.references.relative_motion import (
    angular_momentum,
    inputs,
    port_motion,
    resultant,
    slope_work,
    with_moments,
    work,
)
from tests.unit.components.prepared import prepared


@pytest.mark.parametrize(
    ("motion", "ports", "play"), [("rotation", 3, 0.0), ("translation", 3, 0.0), ("rotation", 4, 1e-3)]
)
@pytest.mark.parametrize("order", [2.0, 4.0])
def test_work_and_momentum_of_a_step(motion, ports, play, order):
    """Momentum is exact for any motion of all ports, work but for the square of a port's turn, 0.03 rad."""
    rng = np.random.default_rng(5)
    component = Gear((0.0, 1.0, 0.0), (0.6, 0.0, 0.8), motion, ports == 4)
    c = prepared(component, ratio=-1.7, stiffness=300.0, damping=4.0, order=order, play=play)
    states = []
    tilts = 0.1 * rng.normal(size=(ports, 3))
    for k in range(3):
        shifts, turns = 0.01 * k * rng.normal(size=(2, ports, 3))
        motions = [
            port_motion(p + shift, turn)
            for p, shift, turn in zip(np.eye(ports, 3), shifts, tilts + turns, strict=True)
        ]
        u = inputs(component, *motions)
        states.append(with_moments(component, u, 0.01 * rng.normal(size=(ports, 6))) if order == 4.0 else u)
    x = component.step(c, component.initial(c, states[0]), states[1], 0.1)
    y = component.step(c, x, states[2], 0.1)
    outputs, names = component.outputs(c, y, states[2]), component.observation_layout
    change = component.observe(c, y, states[2]) - component.observe(c, x, states[1])
    kept = sum(change[names[f"{name}_energy"]][0] for name in ("potential", "dissipated"))
    kept += change[names["numerical_dissipation"]][0]
    done = work(outputs, states[1], states[2], ports)
    if order == 4.0:
        done += slope_work(component, outputs, states[2], ports)
        momentum = angular_momentum(component, outputs, states[1], states[2], ports, (0, 0, 0))
        assert momentum == pytest.approx(np.zeros(6), abs=1e-12)
    else:
        momentum = resultant(outputs, states[1], states[2], ports, (0, 0, 0))
        assert momentum == pytest.approx(np.zeros(6), abs=1e-12)
    assert abs(done + kept) < 0.03**2 * (abs(done) + abs(kept))


def test_a_train_turns_as_one_inertia():
    """Equation of motion: J = J1 + J2 / r^2 + m R^2 with a bevel pair of ratio -2 and a rack at 50 mm, which mesh."""
    scene = fanfold.Scene("train", until="1 s", tolerance=1e-5, preload=False)
    scene.base("case", points={"a": (0, 0, 0), "b": (0.2, 0, 0), "c": (0, 0, 0.1)})
    bodies = (("wheel", "a", 1, 0.1), ("bevel", "b", 1, 0.02), ("rack", "c", 3, 0.01))
    for name, point, mass, inertia in bodies:
        rigid = {"mass": mass, "inertia": (inertia,) * 3, "points": {"o": (0, 0, 0)}}
        scene.body(name, rigid=rigid, place={"body": "case", "point": point})
    seat = {name: {"body": name, "point": "o"} for name, *_ in bodies}
    for name, point, preset, x in (
        ("wheel", "a", "revolute", (0, 1, 0)),
        ("bevel", "b", "revolute", (1, 0, 0)),
        ("rack", "c", "prismatic", (0, 0, 1)),
    ):
        ports = {"inboard": {"body": "case", "point": point}, "outboard": seat[name]}
        scene.connection(
            f"{name}_joint",
            "hinge",
            ports=ports,
            preset=preset,
            axes={"x": x, "z": (1, 1, 0) if x[2] else (0, 0, 1)},
        )
    for name, axis, motion, ratio in (
        ("bevel", (1, 0, 0), "rotation", -2),
        ("rack", (0, 0, 1), "translation", 20),
    ):
        scene.connection(
            f"to_{name}",
            "gear",
            ports={"carrier": {"body": "case", "point": "a"}, "first": seat["wheel"], "second": seat[name]},
            structure={"second_axis": axis, "second_motion": motion},
            parameters={"ratio": ratio, "stiffness": "2e5 N.m/rad", "damping": "20 N.m.s/rad"},
        )
    law = [{"profile": "constant", "value": 0.5}]
    scene.connection(
        "motor", "load", ports={"body": seat["wheel"]}, structure={"direction": (0, 1, 0), "torque": law}
    )
    run = fanfold.simulate(scene, estimate=False)
    inertia = 0.1 + 0.02 / 4 + 3 * 0.05**2
    turned = run["to_bevel", "first_angle"][-1]
    assert turned == pytest.approx(0.5 * 0.5 / inertia, rel=1e-4)
    assert run["to_bevel", "second_coordinate"][-1] == pytest.approx(-turned / 2, abs=1e-5)
    assert run["to_rack", "second_coordinate"][-1] - 0.1 == pytest.approx(turned * 0.05, abs=1e-6)
    assert run["to_rack", "gear_torque"][-1] == pytest.approx(-0.5 * 3 * 0.05**2 / inertia, rel=1e-3)
    assert run.headline.energy_residual < 1e-6


def test_wheels_knock_in_their_backlash():
    """Closed form: the deflection bounces at its rate between springs on the inertia 1 / (1 / J1 + r^2 / J2)."""
    scene = fanfold.Scene("knock", until="1 s", tolerance=1e-5, preload=False)
    scene.base("case", points={"a": (0, 0, 0), "b": (0.2, 0, 0)})
    for name, point, inertia, rate in (("wheel", "a", 0.1, 0.5), ("other", "b", 0.02, 0.0)):
        rigid = {
            "mass": 1,
            "inertia": (inertia,) * 3,
            "center_of_mass": (0, 0, 0),
            "points": {"o": (0, 0, 0)},
        }
        place = {"body": "case", "point": point}
        scene.body(name, rigid=rigid, place=place, angular_velocity=(0, rate, 0))
        ports = {"inboard": ("case", point), "outboard": (name, "o")}
        scene.connection(f"{name}_pin", preset="revolute", ports=ports, axes={"x": (0, 1, 0)})
    ports = {"carrier": ("case", "a"), "first": ("wheel", "o"), "second": ("other", "o")}
    parameters = {"ratio": -2, "stiffness": 300, "damping": 0, "play": "20 mrad"}
    scene.connection("gear", "gear", ports=ports, parameters=parameters)
    run = fanfold.simulate(scene, estimate=False)
    deflection = run["gear", "first_angle"][:] + 2 * run["gear", "second_coordinate"][:]
    frequency = np.sqrt(300 * (1 / 0.1 + 4 / 0.02))
    expected = bouncing(run.time, 0.02, 0.5, frequency)
    assert np.abs(deflection - expected).max() < 1e-4 * np.ptp(expected)
    assert np.abs(run["gear", "gear_torque"][:]).max() == pytest.approx(300 * 0.5 / frequency, rel=1e-4)
    assert run.headline.energy_residual < 1e-6


def test_refusals():
    with pytest.raises(ComponentError, match="rotation or translation"):
        Gear(second_motion="sliding")
    with pytest.raises(ComponentError, match="second_axis"):
        Gear(second_axis=(0, 0, 0))
