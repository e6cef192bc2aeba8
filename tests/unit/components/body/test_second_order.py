"""Bodies with second-order modes against columns, a rotating blade and the conservation of energy."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.linalg import eigh

from components.body import Body
from components.contract.component import ComponentError
from components.contract.frames import exponential, rotation_matrix
from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.flexible.reduction import craig_bampton
from orchestrator.assembly import Part
from orchestrator.assembly.statics.placed_body import PlacedBody
from tests.unit.components.body.body_cases import modal, motions, total_energy
from tests.unit.components.prepared import prepared

LENGTH, BENDING, LINE_MASS = 2.0, 300.0, 0.8
ENDS = ("root", "tip")
EULER = np.pi**2 * BENDING / LENGTH**2


class Beam(NamedTuple):
    """A straight beam along x as a body with ports at its ends, and its constants."""

    body: Body
    constants: object
    flap: np.ndarray
    """indices of the modes that bend along z"""


def beam(modes, second_order=True, gyration_radius=1e-4):
    """With so many fixed-interface modes, half of them along z."""
    section = BeamSection(1e9, BENDING, 900.0, 200.0, LINE_MASS, gyration_radius)
    model = beam_frame({"root": (0, 0, 0), "tip": (LENGTH, 0, 0)}, [Member(*ENDS, section, 40)])
    free = craig_bampton(model, ENDS, modes)
    data = craig_bampton(model, ENDS, modes, second_order_modes=free.frequency.size if second_order else 0)
    body = Body(data.with_damping(0.0).to_arrays(), [{"name": name, "point": name} for name in ENDS])
    largest = np.abs(data.translation[1]).max(axis=0)
    return Beam(body, prepared(body), np.flatnonzero(np.abs(data.translation[1, 2]) > 0.9 * largest))


def pull(force):
    """Inputs (24,): held forces along x that stretch the beam."""
    u = np.zeros(24)
    u[0], u[6] = -force, force
    return u


def stiffness_under(found, force):
    """Of the flap modes, derivatives of their forces in the equations of motion, (F, F)."""
    body, c, flap = found
    x, u = body.initial(c, np.zeros(24)), pull(force)
    rows = []
    for mode in flap:
        bent = x.copy()
        modal(bent, body.modes)[0][mode] = 1e-6
        # forces are odd in the coordinates along z, so that the next order is 1e-12
        rows.append(-1e6 * body.rates(c, bent, u)[-body.modes :][flap])
    return np.array(rows)


def test_euler_load():
    """Closed form pi^2 EI / L^2 of a column between loads along x, from above as by any Ritz basis.

    Half of it is the clamped column under its load, pi^2 EI / 4 (L/2)^2. Constraint modes hold ends, and normal modes
    between them converge with the fourth power of their number.
    """
    errors = []
    for modes in (4, 8, 16):
        found = beam(modes)
        free, unit = (stiffness_under(found, force) for force in (0.0, 1.0))
        loads = eigh(unit - free, 0.5 * (free + free.T), eigvals_only=True)
        errors.append(1.0 / loads[-1] / EULER - 1.0)
    assert 0.0 < errors[2] < errors[1] < errors[0] < 3e-3
    assert errors[2] < 1e-4


BLADE = {0.0: 3.5160, 1.0: 3.6817, 2.0: 4.1373, 3.0: 4.7973, 6.0: 7.3604, 12.0: 13.1702}
"""First flap frequencies of a cantilever that turns about its root, by its rate (Wright and others 1982)."""


def potential(found, eta, rate):
    """Of the body clamped at its root in axes that turn about z there at a rate: strain less centrifugal energy, J."""
    body = found.body
    turns = body._placed.turns(eta)[0]
    axes = rotation_matrix(exponential(tuple(-turns)))
    center = -axes @ (body.arms[0] + body._placed.displacements(eta)[0])
    inertia = body.inertia.matrix(eta)
    moment = body.data.mass * (center[0] ** 2 + center[1] ** 2) + axes[2] @ inertia @ axes[2]
    return 0.5 * float((body.data.frequency * eta) @ (body.data.frequency * eta)) - 0.5 * rate**2 * moment


def flap_frequency(found, rate):
    """First flap frequency (rad/s) of the clamped beam that turns about z."""
    body, flap = found.body, found.flap
    units = np.eye(body.modes)[flap]
    scale = 1e-4 * LENGTH / np.abs(body.data.translation[1, 2]).max()
    rest = potential(found, 0.0 * units[0], rate)

    def second(one, other):
        plus, minus = (potential(found, scale * (one + sign * other), rate) for sign in (1, -1))
        return plus - minus

    # quadratic up to the fourth order: V(a + b) - V(a - b) is 2 a K b, and V is even
    stiffness = np.array([[second(a, b) for b in units] for a in units]) / (2.0 * scale**2)
    diagonal = np.array([2.0 * (potential(found, scale * a, rate) - rest) for a in units]) / scale**2
    np.fill_diagonal(stiffness, diagonal)
    turn = -body.rotation[0][:, flap]
    center = -body.translation[0][:, flap] - np.cross(turn, body.arms[0], axisa=0, axisc=0)
    mass = np.eye(flap.size) + body.data.mass * center.T @ center + turn.T @ body.data.inertia @ turn
    return float(np.sqrt(eigh(0.5 * (stiffness + stiffness.T), mass, eigvals_only=True)[0]))


def test_a_turning_blade_stiffens():
    """Published flap frequencies of a cantilever, up to twelve times its scale of rates, to the last digits."""
    found, scale = beam(12), np.sqrt(BENDING / LINE_MASS) / LENGTH**2
    ratios = {rate: flap_frequency(found, rate * scale) / scale for rate in BLADE}
    assert ratios == pytest.approx(BLADE, rel=5e-5)
    assert flap_frequency(beam(12, second_order=False), 3.0 * scale) < 0.95 * BLADE[3.0] * scale


@pytest.mark.parametrize("h", [1e-3, 5e-3])
@pytest.mark.parametrize("force", [-0.8 * EULER, 3.0 * EULER, 10.0 * EULER])
def test_held_forces_do_the_work_of_the_ports(force, h):
    """Conservation law: the energy of a bent beam grows by force times travel of its ends, to what iterations leave.

    Symmetric bending leaves the axes at rest, so that no turn within a step errs.
    """
    body, c, flap = beam(6, gyration_radius=0.05)
    x, u = body.initial(c, np.zeros(24)), pull(force)
    modal(x, body.modes)[0][flap[0]] = 0.05
    start, place = total_energy(body, c, x), motions(body, c, x)[:, 0]
    rows = []
    for _ in range(50):
        x = body.step(c, x, u, h)
        travel = motions(body, c, x)[:, 0] - place
        rows.append((force * float(travel[1] - travel[0]), total_energy(body, c, x) - start))
    work, gained = np.transpose(rows)
    assert np.abs(work).max() > 0.05 * start
    assert gained == pytest.approx(work, rel=0, abs=50 * 1e-12 * (np.abs(work).max() + start))


@pytest.mark.parametrize("ratio", [-0.8, 10.0])
def test_end_moments_bend_a_beam_less_the_more_it_is_pulled(ratio):
    """Closed form of a beam-column between pinned ends: their slope is M L tan(v) / (2 EI v), v = L sqrt(P / EI) / 2.

    With a pull tan gives way to tanh. As of any Ritz basis the slopes are too small; they converge with nearly the
    third power of the number of fixed-interface modes, as slopes at ends do.
    """
    force, moment = ratio * EULER, 1e-3
    v = 0.5 * np.pi * np.sqrt(abs(ratio))
    slope = moment * LENGTH / (2.0 * BENDING * v) * (np.tanh(v) if force > 0.0 else np.tan(v))
    errors = []
    for modes in (8, 16):
        body = beam(modes).body
        u = pull(force)
        u[4], u[10] = -moment, moment
        wrenches = u[:12].reshape(2, 6)
        placed = PlacedBody(Part("beam", "body", body.structure, {}))
        for _ in range(10):
            bent = np.linalg.solve(placed.stiffness(wrenches)[6:, 6:], placed.forces(wrenches)[6:])
            placed.move(np.concatenate((np.zeros(6), bent)))
        turns = placed.motions()[:, 5] * 2.0
        assert turns[0] == pytest.approx(-turns[1], rel=1e-6)
        errors.append(1.0 - turns[1] / slope)
    assert 0.0 < errors[1] < errors[0] / 6.0 < 5e-4


def test_a_body_without_the_inertia_of_second_order_is_refused():
    """Sentence: levels of coupling that drop invariant 9 would stiffen it under end loads only."""
    found = beam(4).body.structure
    with pytest.raises(ComponentError, match=r"inertia_coupling .*'partial'"):
        Body(found["modal"], found["ports"], "partial")
