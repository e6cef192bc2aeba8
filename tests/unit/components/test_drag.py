"""Drag of a plate: terminal rates, closed forms of slowing down, strips summed one by one, passivity, one port."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import fixed_quad
from scipy.spatial.transform import Rotation

from components.drag import PlateDrag, mean_squares
from orchestrator.assembly import Link, Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import HAS_NATIVE, Tolerance, base, between, completed, rigid
from tests.references.native_fmus import needs_native
from tests.references.relative_motion import inputs, port_motion, work, wrenches
from tests.unit.components.prepared import made

DENSITY, COEFFICIENT = 1.204, 1.28
WIDTH, INNER, OUTER = 1.16, 0.055, 1.555
INERTIA, TORQUE = 6.2514, 2.0
RESISTANCE = DENSITY * COEFFICIENT * WIDTH * (OUTER**4 - INNER**4) / 8
TIGHT = Tolerance(1e-11, 1.0, 1.0)
SMALL = st.floats(-0.5, 0.5)
THREE = st.tuples(SMALL, SMALL, SMALL)


def plate(start, end, width=WIDTH):
    return {
        "start": start, "end": end, "width": width, "air_density": DENSITY, "drag_coefficient": COEFFICIENT
    }  # fmt: skip


def at_steps(h):
    return Settings(tolerance=1e-8, fixed_step=h)


def hinged(h, until, place=0.0):
    """A plate on a stiff hinge with a constant torque; its drag acts at a port `place` outboard of the hinge line."""
    stiff = {
        "translational_stiffness": (1e7,) * 3,
        "translational_damping": (1e4,) * 3,
        "rotational_stiffness": (0.0, 1e6, 1e6),
    }
    harness = {"harness_angle": (-1e3, 1e3), "harness_torque": (TORQUE, TORQUE)}
    parts = [
        base(hinge=(0, 0, 0)),
        rigid("plate", 10.0, (7.0, INERTIA, 8.0), {"hinge": (0, 0, 0), "air": (place, 0, 0)}),
        Part("hinge", "hinge", harness, stiff),
        Part("drag", "drag", {}, plate(INNER - place, OUTER - place)),
    ]
    links = [*between("hinge", "base.hinge", "plate.hinge"), Link(("plate", "air"), ("drag", "body"))]
    return completed(until, parts, links, settings=at_steps(h))


@pytest.mark.parametrize("place", [0.0, 0.805])
def test_plate_about_its_hinge(place):
    """Reference: w = wi tanh(t / tau), wi 1.237235 rad/s, tau 3.86723 s, wherever the port sits on the plate.

    A relative error of (h / tau)^2 of order one, extrapolated (h / tau)^4; a port that goes round on a circle
    adds the error of its chord, (wi h)^2 / 24 before and its square after extrapolation. The hinge gives 1e-6 m.
    """
    final = np.sqrt(TORQUE / RESISTANCE)
    tau = INERTIA / (RESISTANCE * final)
    assert (RESISTANCE, final, tau) == pytest.approx((1.306548, 1.237235, 3.86723), rel=1e-6)
    rates = [hinged(h, 2.0, place).signal("hinge", "angular_rate")[-1] for h in (0.1, 0.05)]
    exact = final * np.tanh(2.0 / tau)
    share = (0.1 / tau) ** 2 + (final * 0.1) ** 2 / 24
    assert rates[0] == pytest.approx(exact, rel=share)
    assert (4 * rates[1] - rates[0]) / 3 == pytest.approx(exact, rel=share**2 + 2e-6)
    late, share = hinged(0.2, 16.0, place), 4 * share
    assert late.signal("hinge", "angular_rate")[-1] == pytest.approx(1.237235, rel=share + np.exp(-32 / tau))
    seen = late.signal("drag", "drag_torque")[-1] + place * -late.signal("drag", "drag_force")[-1]
    assert seen == pytest.approx(-TORQUE, rel=2 * share)


def falling(h, until, native=HAS_NATIVE, **start):
    """A plate that floats freely, its drag at a port in its middle."""
    length, width = 2.0, 1.5
    parts = [
        rigid("plate", 10.0, (2.0, 3.0, 5.0), {"middle": (0, 0, 0)}, **start),
        Part("drag", "drag", {}, plate(-0.5 * length, 0.5 * length, width)),
    ]
    links = [Link(("plate", "middle"), ("drag", "body"))]
    run = completed(until, parts, links, settings=at_steps(h), iteration=TIGHT, native=native)
    return run, length, width


def test_falling_plate():
    """Closed form: v = vt tanh(g t / vt) with m g = 1/2 rho c_d A vt^2; energy to the iteration at any step."""
    gravity, until = 9.81, 1.0
    speeds = []
    for h in (0.05, 0.025):
        run, length, width = falling(h, until, gravity=(0.0, 0.0, -gravity))
        final = np.sqrt(2 * 10.0 * gravity / (DENSITY * COEFFICIENT * length * width))
        speeds.append(-run.signal("plate", "linear_momentum")[-1, 2] / 10.0)
        assert np.abs(run.scene("energy_residual")).max() < 1e-9 * 10.0 * final**2
    exact = final * np.tanh(gravity * until / final)
    share = (gravity * 0.05 / final) ** 2
    assert speeds[0] == pytest.approx(exact, rel=share)
    assert (4 * speeds[1] - speeds[0]) / 3 == pytest.approx(exact, rel=share**2)
    run = falling(0.5, 20.0, gravity=(0.0, 0.0, -gravity))[0]
    assert run.signal("drag", "normal_velocity")[-1] == pytest.approx(-final, rel=1e-6)
    assert run.signal("drag", "drag_force")[-1] == pytest.approx(10.0 * gravity, rel=1e-6)
    assert np.abs(run.scene("energy_residual")).max() < 1e-9 * 10.0 * final**2


def test_spinning_about_its_middle():
    """Closed form of J w' = -B w^2 for a plate that goes one way on one side and the other way on the other."""
    rate, until = 3.0, 2.0
    rates = []
    for h in (0.05, 0.025):
        run, length, width = falling(h, until, initial_angular_velocity=(0.0, rate, 0.0))
        rates.append(run.signal("plate", "angular_momentum")[-1, 1] / 3.0)
        assert np.abs(run.scene("energy_residual")).max() < 1e-9
        assert np.abs(run.signal("plate", "linear_momentum")).max() < 1e-12
    resistance = DENSITY * COEFFICIENT * width * length**4 / 64
    exact = rate / (1 + resistance * rate * until / 3.0)
    share = (resistance * rate * 0.05 / 3.0) ** 2
    assert exact < 0.5 * rate
    assert rates[0] == pytest.approx(exact, rel=share)
    assert (4 * rates[1] - rates[0]) / 3 == pytest.approx(exact, rel=share**2 + 1e-9)


def test_tumbling_plate_closes_its_energy_balance():
    """Conservation: kinetic energy + heat; a turn of w h a step is iterated to 1e-13, twice whose share may be left."""
    spin = (0.5, 1.0, -0.3)
    for h in (0.02, 0.01):
        run, *_ = falling(h, 1.0, initial_angular_velocity=spin, initial_velocity=(0.2, 0.1, 1.0))
        heat = run.signal("drag", "dissipated_energy")
        assert np.all(np.diff(heat) > 0.0)
        assert heat[-1] > 0.3 * run.signal("plate", "kinetic_energy")[0]
        left = 2e-13 / (np.linalg.norm(spin) * h) * (1.0 / h)
        assert np.abs(run.scene("energy_residual")).max() < left * heat[-1]


def drag(mode="mean", start=-0.4, end=1.1, width=0.7):
    return made(PlateDrag, mode, **plate(start, end, width))


@given(turn=THREE, velocity=THREE, spin=THREE)
def test_strips_one_by_one(turn, velocity, spin):
    """Independent formulation: forces and moments of 4000 strips; the midpoint rule errs by a few 1e-8 of them."""
    component, c = drag("endpoint")
    u = inputs(component, port_motion((1, 2, 3), turn, velocity, spin))
    x = component.initial(c, u)
    axes = Rotation.from_rotvec(turn).as_matrix()
    edges = np.linspace(-0.4, 1.1, 4001)
    arms = 0.5 * (edges[:-1] + edges[1:])[:, None] * axes[:, 0]
    speeds = (np.array(velocity) + np.cross(spin, arms)) @ axes[:, 2]
    each = -0.5 * DENSITY * COEFFICIENT * 0.7 * (1.5 / 4000) * speeds * np.abs(speeds)
    forces = each[:, None] * axes[:, 2]
    exact = np.concatenate((forces.sum(0), np.cross(arms, forces).sum(0)))
    y = component.outputs(c, x, u)
    assert y == pytest.approx(exact, abs=1e-6 * (np.abs(each).sum() + 1e-6))
    middle = (np.array(velocity) + np.cross(spin, 0.35 * axes[:, 0])) @ axes[:, 2]
    assert component.observe(c, x, u)[:3] == pytest.approx((axes[:, 2] @ y[:3], axes[:, 1] @ y[3:], middle))
    power = -(each * speeds).sum()
    assert component.rates(c, x, u)[0] == pytest.approx(power, abs=1e-6 * power + 1e-12)


@given(
    first=st.tuples(THREE, THREE),
    second=st.tuples(THREE, THREE),
    flipped=st.booleans(),
    h=st.sampled_from((1e-3, 1.0)),
)
def test_heat_is_the_work_taken(first, second, flipped, h):
    """Passivity: the heat is the work of the wrench and never negative but for round-off, at any step size.

    Either sign of a quaternion is the same orientation.
    """
    component, c = drag()
    u0, u1 = (inputs(component, port_motion(*motion)) for motion in (first, second))
    x0 = component.initial(c, u0)
    heat = component.observe(c, component.step(c, x0, u1, h), u1)[3]
    if flipped:
        u1[component.input_layout["body.orientation"]] *= -1.0
    x1 = component.step(c, x0, u1, h)
    y = component.outputs(c, x1, u1)
    round_off = 1e-13 * (np.abs(y).sum() + heat) + 1e-300
    assert heat >= -round_off
    assert component.observe(c, x1, u1)[3] == pytest.approx(heat, abs=round_off)
    assert work(y, u0, u1, 1) + heat == pytest.approx(0.0, abs=round_off)
    half = Rotation.from_rotvec(first[1])
    change = Rotation.from_rotvec(second[1]) * half.inv()
    normal = (Rotation.from_rotvec(0.5 * change.as_rotvec()) * half).apply((0, 0, 1))
    force = wrenches(y, 1)[0][0]
    assert np.cross(force, normal) == pytest.approx(np.zeros(3), abs=round_off)


@given(first=st.floats(-2, 2), last=st.floats(-2, 2))
def test_means_of_squares(first, last):
    """Definition: means of v |v| and t v |v| for linear v, by Gauss quadrature, exact on both sides of v's zero."""
    still = [first / (first - last)] if first * last < 0.0 else []
    ends = [0.0, *still, 1.0]

    def mean(weight):
        def density(t):
            v = first + t * (last - first)
            return weight(t) * v * np.abs(v)

        return sum(fixed_quad(density, a, b, n=3)[0] for a, b in pairwise(ends))

    exact = mean(np.ones_like), mean(lambda t: t)
    assert mean_squares(first, last) == pytest.approx(exact, rel=1e-12, abs=1e-13)


@needs_native
def test_native_fmus_with_one_port_are_coupled():
    """The native solver follows the same path as components in process, to the tolerance of the iteration."""
    motion = {"initial_angular_velocity": (0.5, 1.0, -0.3), "initial_velocity": (0.2, 0.1, 1.0)}
    found, expected = (falling(0.02, 0.5, native, **motion)[0] for native in (True, False))
    assert found.times == expected.times
    for name in ("drag_force", "drag_torque", "normal_velocity", "dissipated_energy"):
        assert found.signal("drag", name) == pytest.approx(expected.signal("drag", name), rel=1e-9, abs=1e-9)
