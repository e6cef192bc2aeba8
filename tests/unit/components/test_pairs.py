"""Connections kind by kind: work, momentum, and order along a path; hinges have their own tests."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from components.ccl import CableLoop
from components.contact import Contact
from components.damper import EddyCurrentDamper
from components.drive import Drive
from components.end_stop import EndStop
from components.hold_down import HoldDown
from components.point_motion import PointMotion
from components.rail import Rail
from components.spring import Spring
from components.suspension import Suspension
from tests.references.relative_motion import (
    angular_momentum,
    inputs,
    port_motion,
    resultant,
    slope_work,
    slopes,
    with_moments,
    work,
)
from tests.unit.components.prepared import prepared

STRANDS = {"radius_1": 0.06, "radius_2": 0.03, "strand_damping": 4.0}
RAIL = {"normal_stiffness": 300.0, "normal_damping": 2.0, "friction_force": 4.0, "stiction_velocity": 0.05}
CASES = {
    "hold_down": (
        HoldDown,
        {},
        {
            "translational_stiffness": (3e3, 5e3, 4e3),
            "translational_damping": (5.0, 2.0, 3.0),
            "preload": 40.0,
        },
    ),
    "drive": (
        Drive,
        {"profile": "step"},
        {"stiffness": 300.0, "damping": 2.0, "end_angle": 1.0, "duration": 4.0},
    ),
    "point_motion": (
        PointMotion,
        {"axis": (1.0, 0.0, 0.0), "law": ({"profile": "step", "duration": 4.0, "change": 0.1},)},
        {"stiffness": 300.0, "damping": 2.0, "offset": 0.9},
    ),
    "damper": (EddyCurrentDamper, {}, {"damping_coefficient": 3.0, "peak_rate": 0.5}),
    "suspension": (Suspension, {}, {"stiffness": 400.0, "damping": 6.0}),
    "spring": (Spring, {}, {"stiffness": 400.0, "damping": 6.0, "preload": -3.0, "preload_length": 0.9}),
    "tabulated": (
        Spring,
        {"elongation": (-0.1, 0.0, 0.1), "tension": (-8.0, 0.0, 20.0)},
        {"stiffness": 40.0, "damping": 6.0, "preload": -3.0, "preload_length": 0.9},
    ),
    "rail": (Rail, {"normal": (0.6, 0.0, 0.8)}, {**RAIL, "breakaway_deflection": 0.05}),
    "smooth_rail": (Rail, {"normal": (0.6, 0.0, 0.8)}, {**RAIL, "breakaway_deflection": 0.0}),
    "guided": (CableLoop, {"guided": True}, STRANDS),
    "free": (CableLoop, {}, STRANDS),
}
WITHOUT_SLOPES = {
    "contact": (
        Contact,
        {"normal": (0.2, -0.5, 0.7)},
        {"gap": 0.3, "damping": 20.0, "reference_force": 10.0, "reference_penetration": 0.1},
    ),
    "end_stop": (EndStop, {}, {"stop_angle": 0.1, "stiffness": 50.0, "damping": 5.0}),
}
MODES = [("mean", 2.0), ("mean", 4.0), ("endpoint", 2.0)]
"""Of wrenches, with their order."""
BOTH_SIDED = [
    (name, *mode) for name in (*CASES, *WITHOUT_SLOPES) for mode in MODES
    if not name.endswith("rail") and (name, mode[1]) != ("contact", 4.0)
]  # fmt: skip
TURNING = ("drive", "damper", "guided", "free")
"""Kinds whose wrenches follow turns about y; the others follow places. A rail's other port is the ground."""
PLACES = np.array(((0.0, 0.0, 0.0), (0.9, 0.0, 0.0), (0.5, 0.0, 0.0)))
SMALL = st.floats(-0.05, 0.05)
THREE = st.tuples(SMALL, SMALL, SMALL)
PORTS = st.tuples(THREE, THREE, THREE)


def case(name, mode="mean", **change):
    kind, structure, start = {**CASES, **WITHOUT_SLOPES}[name]
    component = kind(**structure, wrench_mode=mode)
    return component, prepared(component, **{**start, **change})


def seen(component, c, x, u, name):
    layout = component.observation_layout
    return float(component.observe(c, x, u)[layout[name]][0]) if name in layout else 0.0


def posed(name, component, moved, moments=None, **commands):
    """Ports at their places; those that feel turns turn about y by the first of three numbers, others move by all."""
    ports = []
    for place, step in zip(PLACES[: len(component.ports)], moved, strict=False):
        turn = (0.0, 10.0 * step[0], 0.0) if name in TURNING else (0.0, 0.0, 0.0)
        ports.append(port_motion(place if name in TURNING else place + step, turn))
    if name == "drive":
        ports[0][3:7] = 1.0, 0.0, 0.0, 0.0
    if name == "damper":
        ports[0][3:7] = 1.0, 0.0, 0.0, 0.0
    u = inputs(component, *ports, **commands)
    if moments is None:
        return u
    return with_moments(component, u, np.concatenate(moments).reshape(-1, 6)[: len(component.ports)])


@pytest.mark.parametrize("order", [2.0, 4.0])
@pytest.mark.parametrize("name", CASES)
@given(st.tuples(PORTS, PORTS, PORTS), st.tuples(PORTS, PORTS), st.tuples(PORTS, PORTS))
def test_work_is_the_change_of_energy(name, order, moved, first, second):
    """Exact, whatever the moments: means on changes and slopes on moments against what is stored, lost and supplied."""
    component, c = case(name, order=order)
    states = [
        posed(name, component, moved[0]),
        posed(name, component, moved[1], (*first[0], *first[1])),
        posed(name, component, moved[2], (*second[0], *second[1])),
    ]
    x = component.step(c, component.initial(c, states[0]), states[1], 0.1)
    y = component.step(c, x, states[2], 0.1)
    outputs, ports = component.outputs(c, y, states[2]), len(component.ports)
    change = {
        energy: seen(component, c, y, states[2], energy) - seen(component, c, x, states[1], energy)
        for energy in (
            "potential_energy",
            "dissipated_energy",
            "numerical_dissipation",
            "supplied_energy",
        )
    }
    done = work(outputs, states[1], states[2], ports) + slope_work(component, outputs, states[2], ports)
    rest = done + change["potential_energy"] + change["dissipated_energy"] + change["numerical_dissipation"]
    scale = 1.0 + sum(map(abs, change.values())) + abs(seen(component, c, y, states[2], "potential_energy"))
    assert rest - change["supplied_energy"] == pytest.approx(0.0, abs=1e-12 * scale)
    assert change["dissipated_energy"] >= -1e-13 * scale
    if order == 4.0:  # of order 2 inertial terms give and take
        assert change["numerical_dissipation"] >= 0.0


@pytest.mark.parametrize(("name", "mode", "order"), BOTH_SIDED)
@given(st.tuples(PORTS, PORTS), PORTS, st.tuples(PORTS, PORTS), THREE)
def test_wrenches_give_no_momentum(name, mode, order, moved, turns, moments, about):
    """Conservation law over a step (mean) or at its end, all ports turning and moving; round-off of up to 2e3 N."""
    component, c = case(name, mode, **({} if name == "contact" else {"order": order}))
    count = len(component.ports)
    before, after = (
        inputs(
            component,
            *(
                port_motion(place + np.array(step), 10.0 * np.array(turn))
                for place, step, turn in zip(PLACES[:count], steps, turning, strict=False)
            ),
        )
        for steps, turning in zip(moved, (np.zeros((3, 3)), turns), strict=True)
    )
    ports = np.concatenate((*moments[0], *moments[1])).reshape(-1, 6)[:count]
    if name != "contact" and mode == "mean":
        after = with_moments(component, after, ports)
    y = component.step(c, component.initial(c, before), after, 0.1)
    outputs = component.outputs(c, y, after)
    if order == 2.0:
        total = resultant(outputs, before if mode == "mean" else after, after, count, about)
        assert total == pytest.approx(np.zeros(6), abs=1e-11)
        return
    total = angular_momentum(component, outputs, before, after, count, about)
    assert total == pytest.approx(np.zeros(6), abs=1e-11)
    force, _ = slopes(component, outputs, count)
    assert force.sum(0) == pytest.approx(np.zeros(3), abs=1e-11)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
RATES = np.array((1.0, 1.7, 0.6))


def along(name, component, t, h=0.0):
    """A smooth motion at t, with the exact moments of the step of size h that ends there.

    Springs are pulled along their line, pulleys and shafts turn about the axis.
    """
    count = len(component.ports)
    turning = name in TURNING
    still = name in ("drive", "damper")

    def coordinates(time):
        size, rate = (0.1, RATES[:count]) if turning else (0.02, RATES[:count])
        values, speeds = size * np.sin(rate * time + 0.3), size * rate * np.cos(rate * time + 0.3)
        if still:
            values[0] = speeds[0] = 0.0
        return values, speeds

    values, speeds = coordinates(t)
    zero = (0.0, 0.0, 0.0)
    ports = [
        port_motion(place, (0.0, v, 0.0), zero, (0.0, s, 0.0))
        if turning
        else port_motion(place + np.array((v, 0.0, 0.0)), zero, (s, 0.0, 0.0))
        for place, v, s in zip(PLACES, values, speeds, strict=False)
    ]
    u = inputs(component, *ports)
    if h == 0.0:
        return u
    moments = np.zeros((count, 6))
    for node, weight in zip(NODES, WEIGHTS, strict=True):
        speeds = coordinates(t - 0.5 * h + 0.5 * h * node)[1]
        moments[:, 4 if turning else 0] += 0.5 * h * weight * node * speeds
    return with_moments(component, u, moments)


def instant_wrenches(name, component, c, x, t):
    """End-point wrenches of all ports."""
    if "clock" in component.state_layout:
        x = x.copy()
        x[component.state_layout["clock"]] = t
    return component.outputs(c, x, along(name, component, t))[: 6 * len(component.ports)].reshape(-1, 6)


@pytest.mark.parametrize("name", [name for name in CASES if name != "tabulated"])
def test_mean_and_slope_are_of_order_four_and_three(name):
    """Along a prescribed path with exact moments: the errors of the mean go with h^4, of the slope with h^3.

    The mean of a linear law without numerical damping is exact, up to the rounding of energies over small changes,
    which a table's are too large for.
    """
    found = []
    for h in (0.1, 0.05, 0.025):
        component, c = case(name, order=4.0)
        instant, d = case(name, "endpoint")
        felt = min(len(component.ports), 2) - 1  # the last port but a guide
        x = component.initial(c, along(name, component, 0.0))
        now = instant.initial(d, along(name, instant, 0.0))
        errors = np.zeros(2)
        for k in range(round(1.0 / h)):
            u = along(name, component, (k + 1) * h, h)
            x = component.step(c, x, u, h)
            y = component.outputs(c, x, u)
            exact = np.zeros((2, 6))
            for node, weight in zip(NODES, WEIGHTS, strict=True):
                wrench = instant_wrenches(name, instant, d, now, (k + 0.5 + 0.5 * node) * h)[felt]
                exact += 0.5 * weight * np.array((wrench, 3.0 * node * wrench))
            force, torque = slopes(component, y, len(component.ports))
            slope, mean = np.concatenate((force[felt], torque[felt])), y[6 * felt : 6 * felt + 6]
            errors = np.maximum(errors, np.abs(np.array((mean, slope)) - exact).max(1))
        found.append(errors)
    means, parts = np.array(found).T
    assert np.all(means < 1e-9) or means[0] / means[2] > 2.0**7
    assert parts[0] / parts[2] > 2.0**5


@pytest.mark.parametrize("name", CASES)
def test_order_two_takes_no_note_of_moments(name):
    """The parameter's start: same bits, and slopes zero."""
    rng = np.random.default_rng(3)
    component, c = case(name)
    u, count = posed(name, component, rng.normal(0.0, 0.01, (3, 3))), len(component.ports)
    v = with_moments(component, u, rng.normal(0.0, 0.01, (count, 6)))
    x = component.initial(c, posed(name, component, np.zeros((3, 3))))
    plain, fed = component.step(c, x, u, 0.01), component.step(c, x, v, 0.01)
    assert plain.tobytes() == fed.tobytes()
    assert not np.any(slopes(component, component.outputs(c, fed, v), count))


def test_damping_of_a_suspension_never_pushes():
    """A taut spring that shortens fast: its mean tension is zero, and heat is what it loses."""
    component, c = case("suspension", order=4.0, damping=500.0)
    u = posed("suspension", component, np.zeros((3, 3)))
    x = component.initial(c, u)
    v = posed("suspension", component, ((0.0, 0.0, 0.0), (-0.05, 0.0, 0.0), (0.0, 0.0, 0.0)))
    y = component.step(c, x, v, 0.01)
    assert component.outputs(c, y, v)[:12] == pytest.approx(np.zeros(12), abs=1e-12)
    lost = seen(component, c, y, v, "dissipated_energy")
    stored = seen(component, c, x, u, "potential_energy") - seen(component, c, y, v, "potential_energy")
    assert lost == pytest.approx(stored, rel=1e-12)
