"""Stress recovery against closed forms, polynomials that the elements hold, and direct static solutions."""

import numpy as np
import pytest
from numpy.polynomial import polynomial
from scipy import linalg, sparse
from scipy.sparse.linalg import splu

from components.contract.component import ComponentError
from components.contract.frames import skew
from components.flexible import stress as stress_module
from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.flexible.panel import PlateElements, panel_model
from components.flexible.plate import HingeArm, Panel, Plate
from components.flexible.reduction import inertia_relief, orthonormal_modes
from components.flexible.stress import (
    FaceSheets,
    hot_spots,
    nodes_around,
    nodes_in_rectangle,
    stress_recovery,
    von_mises,
)
from tests.references import catalogue

SKIN, DISTANCE = 0.30e-3, 25.3e-3
SHEETS = FaceSheets.sandwich(SKIN, DISTANCE)
PLATE = Plate(1.5, 1.16, 4.3, (15700.0, 15700.0, 2800.0, 165.0), (98e6, 98e6, 5e6, 10e6))
ARM = BeamSection(6.7e6, 141.0, 30.17, 740.0)
POINTS = ("root_left", "root_right", "tip_left", "tip_right")


def test_von_mises_closed_forms():
    """Uniaxial |s|, shear sqrt(3) t, equal biaxial |s|, and s1² - s1 s2 + s2² in any axes."""
    cases = {(-7.0, 0.0, 0.0): 7.0, (0.0, 0.0, 2.0): 2.0 * np.sqrt(3.0), (5.0, 5.0, 0.0): 5.0}
    np.testing.assert_allclose(von_mises(np.array(list(cases))), list(cases.values()), rtol=1e-14)
    s1, s2, angle = 4.0, -1.5, np.linspace(0.0, np.pi, 7)
    mean, half = 0.5 * (s1 + s2), 0.5 * (s1 - s2)
    turned = np.column_stack(
        [mean + half * np.cos(2 * angle), mean - half * np.cos(2 * angle), half * np.sin(2 * angle)]
    )
    np.testing.assert_allclose(von_mises(turned), np.sqrt(s1**2 - s1 * s2 + s2**2), rtol=1e-14)


def degrees_of_freedom(plate, w, u, v):
    """Values of all degrees of freedom for polynomials with coefficients [x power, y power]."""
    x, y = plate.places.T
    along_x, along_y = polynomial.polyder(w, axis=0), polynomial.polyder(w, axis=1)
    by_kind = [w, along_x, along_y, polynomial.polyder(along_x, axis=1), u, v]
    values = np.array([polynomial.polyval2d(x, y, c) for c in by_kind])
    return values[plate.kind, np.arange(x.size)]


def test_resultants_of_polynomials_are_exact():
    """Patch test: bicubic deflections and biquadratic stretching are in the elements, so N and M are exact."""
    material = Plate(2.0, 1.0, 1.0, (7.0, 5.0, 2.0, 3.0), (1.1, 0.9, 0.2, 0.4))
    elements = PlateElements(material, [0.0, 0.3, 2.0], [-0.5, 0.1, 0.5], 0.5)
    rng = np.random.default_rng(4)
    w, u, v = rng.standard_normal((4, 4)), rng.standard_normal((3, 3)), rng.standard_normal((3, 3))
    nodes = elements.nodes({})
    found = (nodes.resultants @ degrees_of_freedom(elements, w, u, v)).reshape(-1, 6)

    def derivative(c, along_x, along_y):
        c = polynomial.polyder(polynomial.polyder(c, along_x, axis=0), along_y, axis=1)
        return polynomial.polyval2d(*nodes.positions[:, :2].T, c)

    e = (derivative(u, 1, 0), derivative(v, 0, 1), derivative(u, 0, 1) + derivative(v, 1, 0))
    k = (derivative(w, 2, 0), derivative(w, 0, 2), 2 * derivative(w, 1, 1))
    expected = [1.1 * e[0] + 0.2 * e[1], 0.2 * e[0] + 0.9 * e[1], 0.4 * e[2]]
    expected += [-7.0 * k[0] - 2.0 * k[1], -2.0 * k[0] - 5.0 * k[1], -3.0 * k[2]]
    np.testing.assert_allclose(found, np.transpose(expected), atol=1e-10 * np.abs(expected).max())


def test_constant_curvature_next_to_an_insert():
    """What an insert carries is no part of the average: nodes on its edge keep the exact value."""
    elements = PlateElements(PLATE, [0.0, 0.4, 1.0], [0.0, 0.3, 1.0], 0.1)
    insert = ((0.0, 0.4), (0.0, 0.3))
    nodes = elements.nodes([insert])
    w = np.zeros((3, 3))
    w[2, 0] = 0.5
    found = (nodes.resultants @ degrees_of_freedom(elements, w, np.zeros((1, 1)), np.zeros((1, 1)))).reshape(
        -1, 6
    )
    x, y = nodes.positions[:, :2].T
    inner = (x < 0.4 - 1e-9) & (y < 0.3 - 1e-9)
    np.testing.assert_allclose(found[~inner, 3], -PLATE.bending[0], rtol=1e-9)
    assert np.all(found[inner] == 0.0)
    on_insert = nodes.insert_distance() < 1e-12
    np.testing.assert_array_equal(on_insert, (x < 0.4 + 1e-9) & (y < 0.3 + 1e-9))
    assert nodes.insert_distance().max() == pytest.approx(np.hypot(0.6, 0.7))
    assert len(nodes.faces) == 10 * 10 - 4 * 3


def navier_moment(terms=401):
    """Moment in the centre of a simply supported unit square under unit pressure, nu = 0.3 (Navier)."""
    m = np.arange(1, terms, 2)[:, None]
    n = m.T
    signs = (-1.0) ** ((m - 1) / 2 + (n - 1) / 2)
    return 16.0 / np.pi**4 * np.sum(signs * (m**2 + 0.3 * n**2) / (m * n * (m**2 + n**2) ** 2))


def test_square_plate_under_pressure():
    """Navier's series (0.0479 q a²). Second derivatives of cubics err by q h² / (12 D): second order in h."""
    plate = Plate(1.0, 1.0, 1.0, (1.0, 1.0, 0.3, 0.35), (1.0, 1.0, 0.3, 0.35))
    errors = []
    for size in (0.1, 0.05):
        elements = PlateElements(plate, [0.0, 1.0], [0.0, 1.0], size)
        x, y = elements.places.T
        held = elements.kind >= 4
        held |= np.isin(elements.kind, (0, 2)) & ((x == 0.0) | (x == 1.0))
        held |= np.isin(elements.kind, (0, 1)) & ((y == 0.0) | (y == 1.0))
        load = elements.displacement.T @ np.kron(elements.masses, [0.0, 0.0, 1.0])
        motion = static(elements.stiffness, np.flatnonzero(held), load)
        nodes = elements.nodes({})
        center = nodes_around(nodes.positions, (0.5, 0.5), 1e-6)
        assert center.size == 1
        moment = (nodes.resultants @ motion).reshape(-1, 6)[center[0], 3]
        errors.append(abs(moment / navier_moment() - 1.0))
    assert navier_moment() == pytest.approx(0.0479, abs=5e-5)
    assert errors[1] < 0.05**2 / 12.0 / 0.0479 * 1.3  # both curvatures err, the second counts with nu
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def static(stiffness, held, load):
    """Displacements (n,) or (n, k) under a load with some degrees of freedom held: sparse LU."""
    free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
    motion = np.zeros_like(load)
    motion[free] = splu(sparse.csc_array(stiffness)[free][:, free]).solve(load[free])
    return motion


@pytest.mark.parametrize("kind", ["sandwich", "solid"])
def test_cantilever_strip(kind):
    """Statically determinate: faces carry -+ F L d / (b t (d² + t²/3)), or 6 F L / (b h²), and +N / A when pulled."""
    plate = Plate(1.0, 0.1, 1.0, (50.0, 50.0, 0.0, 25.0), (8e6, 8e6, 0.0, 4e6))
    model = panel_model(Panel(plate, plate_start=0.0, element_size=0.05))
    elements = PlateElements(plate, [0.0, 1.0], [-0.05, 0.0, 0.05], 0.05)
    held = np.flatnonzero(np.abs(elements.places[:, 0]) < 1e-12)
    force, pull = 3.0, 40.0
    edge = np.linspace(-0.05, 0.05, 5)
    weights = np.array([1, 4, 2, 4, 1]) / 12.0  # Simpson's rule in both elements: exact for cubics
    motions = sum(w * elements.motion(1.0, y) for y, w in zip(edge, weights, strict=True))
    load = motions.T @ np.array([pull, 0.0, force, 0.0, 0.0, 0.0])
    sheets = SHEETS if kind == "sandwich" else FaceSheets.solid(2e-3)
    of_sandwich = DISTANCE / (0.1 * SKIN * (DISTANCE**2 + SKIN**2 / 3.0))
    per_moment = of_sandwich if kind == "sandwich" else 6.0 / (0.1 * 2e-3**2)
    area = 0.1 * (2.0 * SKIN if kind == "sandwich" else 2e-3)
    motion = static(model.stiffness, held, load)
    recovery = stress_recovery(model, sheets, motion[:, None])
    found = recovery.stress(np.ones(1))
    arm = 1.0 - recovery.positions[:, 0]
    bending, tension = per_moment * force * arm, pull / area
    np.testing.assert_allclose(found[:, 0, 0], tension - bending, rtol=1e-6)
    np.testing.assert_allclose(found[:, 1, 0], tension + bending, rtol=1e-6)
    np.testing.assert_allclose(found[:, :, 1:], 0.0, atol=1e-6 * bending.max())
    np.testing.assert_allclose(recovery.von_mises(np.ones(1)), tension + bending, rtol=1e-6)


@pytest.fixture(scope="module")
def panel():
    """A honeycomb panel with four hinge arms, coarse enough to be quick."""
    arms = [
        HingeArm(f"{line}_{side}", sign * 0.565, edge, section=ARM, point_mass=0.15)
        for line, edge in (("root", "inboard"), ("tip", "outboard"))
        for side, sign in (("left", 1.0), ("right", -1.0))
    ]
    return panel_model(Panel(PLATE, tuple(arms), {"center": (0.805, 0.0)}, element_size=0.1))


@pytest.fixture(scope="module")
def reduced(panel):
    """Frequencies and modes by the number of fixed-interface modes."""
    return {count: orthonormal_modes(panel, POINTS, count) for count in (10, 20)}


def clamped(model):
    """Degrees of freedom of the two root hinges."""
    return np.concatenate([model.attachment_dofs[name] for name in POINTS[:2]])


def modal_solution(model, frequency, modes, load):
    """Modal coordinates of the static solution with the root hinges clamped, from the reduced body alone."""
    basis = np.hstack([model.rigid_motions, modes])
    stiffness = np.concatenate([np.zeros(6), frequency**2])[:, None]
    allowed = linalg.null_space(basis[clamped(model)])
    reduced = np.linalg.solve(allowed.T @ (stiffness * allowed), allowed.T @ (basis.T @ load))
    return (allowed @ reduced)[6:]


def inertia_load(model, acceleration, gradient):
    """Load of an acceleration field a + G s, s from the centre of mass."""
    field = acceleration + (model.positions - model.center_of_mass) @ np.transpose(gradient)
    return -model.displacement.T @ (np.repeat(model.masses, 3) * field.ravel())


def compared(model, modes, coordinates, load):
    """Von Mises stresses at all nodes: recovered from the modes, and of the direct static solution."""
    motion = static(model.stiffness, clamped(model), load)
    direct = stress_recovery(model, SHEETS, motion[:, None]).von_mises(np.ones(1))
    return stress_recovery(model, SHEETS, modes).von_mises(coordinates), direct


@pytest.mark.parametrize("component", range(6))
def test_wrench_at_an_attachment_point(panel, reduced, component):
    """Direct static solution: constraint modes hold it, so only round-off is left, at every node."""
    frequency, modes = reduced[10]
    load = np.zeros(len(modes))
    load[panel.attachment_dofs["tip_left"][component]] = 10.0
    modal, direct = compared(panel, modes, modal_solution(panel, frequency, modes, load), load)
    np.testing.assert_allclose(modal, direct, atol=1e-5 * direct.max())


def test_force_in_the_middle_of_the_plate(panel, reduced):
    """Direct static solution, 1 % at the hot spots: fixed-interface modes converge on a point load away from it."""
    frequency, modes = reduced[20]
    load = 10.0 * panel.point_motions["center"].toarray()[2]
    modal, direct = compared(panel, modes, modal_solution(panel, frequency, modes, load), load)
    away = (
        np.linalg.norm(panel.plate.positions[:, :2] - (0.805, 0.0), axis=1) > 0.15
    )  # logarithmic singularity
    hot = np.flatnonzero(away)[hot_spots(direct[away], panel.plate.positions[away], 0.05, 10)]
    np.testing.assert_allclose(modal[hot], direct[hot], rtol=0.01)


FIELDS = {
    "lifted": (np.array([0.0, 0.0, 9.81]), np.zeros((3, 3))),
    "turning about the hinge line": (np.array([0.0, 0.0, -7.5]), skew(np.array([0.0, 10.0, 0.0]))),
}


@pytest.mark.parametrize("name", FIELDS)
def test_inertia_in_bending(panel, reduced, name):
    """Direct static solution, 1 % at the hot spots, with 10 fixed-interface modes and no correction."""
    frequency, modes = reduced[10]
    load = inertia_load(panel, *FIELDS[name])
    modal, direct = compared(panel, modes, modal_solution(panel, frequency, modes, load), load)
    hot = hot_spots(direct, panel.plate.positions, 0.05, 10)
    np.testing.assert_allclose(modal[hot], direct[hot], rtol=0.01)


def test_static_correction_makes_inertia_exact(panel, reduced):
    """Direct static solution under any acceleration field and a wrench: round-off; in plane it is needed."""
    frequency, modes = reduced[10]
    relief = inertia_relief(panel, POINTS, frequency, modes)
    rng = np.random.default_rng(7)
    alpha, omega = skew(rng.standard_normal(3)), skew(rng.standard_normal(3))
    for acceleration, gradient in (
        (np.array([9.81, 0.0, 0.0]), np.zeros((3, 3))),
        (rng.standard_normal(3), alpha + omega @ omega),
    ):
        load = inertia_load(panel, acceleration, gradient)
        load[panel.attachment_dofs["tip_right"]] += rng.standard_normal(6)
        eta = modal_solution(panel, frequency, modes, load)
        field = np.concatenate([acceleration, gradient.T.ravel()])
        modal, direct = compared(panel, np.hstack([modes, relief]), np.concatenate([eta, field]), load)
        np.testing.assert_allclose(modal, direct, atol=1e-5 * direct.max())
    load = inertia_load(panel, np.array([9.81, 0.0, 0.0]), np.zeros((3, 3)))
    modal, direct = compared(panel, modes, modal_solution(panel, frequency, modes, load), load)
    assert np.abs(modal - direct).max() > 0.1 * direct.max()


def test_nodes_asked_for_are_those_of_the_whole_plate(panel, reduced):
    modes = reduced[10][1]
    whole = stress_recovery(panel, SHEETS, modes)
    chosen = np.intersect1d(
        nodes_in_rectangle(whole.positions, (0.3, 0.9), (-0.2, 0.4)),
        nodes_around(whole.positions, (0.6, 0.1), 0.3),
    )
    x, y = whole.positions[:, :2].T
    expected = (x >= 0.3) & (x <= 0.9) & (y >= -0.2) & (y <= 0.4) & (np.hypot(x - 0.6, y - 0.1) <= 0.3)
    np.testing.assert_array_equal(chosen, np.flatnonzero(expected))
    part = stress_recovery(panel, SHEETS, modes, chosen)
    np.testing.assert_array_equal(part.positions, whole.positions[chosen])
    np.testing.assert_array_equal(part.modal_stress, whole.modal_stress[chosen])
    np.testing.assert_array_equal(part.at([2, 0]).nodes, chosen[[2, 0]])


def test_peak_over_chunks_of_time(panel, reduced, monkeypatch):
    """Brute force over the whole history: value, row and face of the first largest stress of every node."""
    recovery = stress_recovery(panel, SHEETS, reduced[10][1])
    eta = np.random.default_rng(2).standard_normal((57, reduced[10][0].size)) / reduced[10][0]
    history = von_mises(recovery.stress(eta))
    monkeypatch.setattr(stress_module, "_CHUNK", 10 * 6 * len(recovery.nodes))
    peak = recovery.peak(eta)
    flat = history.transpose(1, 0, 2).reshape(len(recovery.nodes), -1)
    loaded = flat.max(axis=1) > 0.0
    np.testing.assert_allclose(peak.value, flat.max(axis=1), rtol=1e-12)
    np.testing.assert_array_equal(peak.row[loaded], flat.argmax(axis=1)[loaded] // 2)
    np.testing.assert_array_equal(peak.face[loaded], flat.argmax(axis=1)[loaded] % 2)


def test_hot_spots_keep_their_distance():
    """Definition: falling values, no two within the radius, and nothing larger left out that is not near one."""
    rng = np.random.default_rng(5)
    positions = np.column_stack([rng.uniform(0.0, 1.0, (300, 2)), np.zeros(300)])
    values = rng.uniform(0.0, 1.0, 300)
    found = hot_spots(values, positions, 0.2, 8)
    assert found.size == 8
    assert found[0] == np.argmax(values)
    assert np.all(np.diff(values[found]) < 0.0)
    gaps = np.linalg.norm(positions[:, None] - positions[found], axis=2)
    assert np.all(gaps[found][~np.eye(8, dtype=bool)] > 0.2)
    larger = np.setdiff1d(np.flatnonzero(values > values[found[-1]]), found)
    assert np.all(gaps[larger].min(axis=1) <= 0.2)


def test_hot_spots_at_the_radius_and_without():
    positions = np.array([[0.0, 0.0, 0.0], [0.05, 0.0, 0.0], [0.11, 0.0, 0.0]])
    values = np.array([3.0, 2.0, 1.0])
    np.testing.assert_array_equal(hot_spots(values, positions, 0.05, 9), [0, 2])
    np.testing.assert_array_equal(hot_spots(values, positions, 0.0, 9), [0, 1, 2])
    np.testing.assert_array_equal(hot_spots(values[::-1], positions, 0.0, 2), [2, 1])


def test_face_sheets_have_the_stiffness_of_the_plates():
    """Lay-up of the data sheet: D = E t d² / 2 with E 163.5 GPa, D66 with G 1.72 GPa; three figures are given."""
    for name in ("amos3_panel1", "arabsat_panel_tip"):
        entry = catalogue.entry(name)
        sheets = entry.face_sheets
        skin = 0.5 / sheets.per_force
        distance = 1.0 / (sheets.per_moment * skin)
        d11, _, _, d66 = entry.panel.plate.bending
        assert 163.5e9 * skin * distance**2 / 2.0 == pytest.approx(d11, rel=5e-3)
        if name == "amos3_panel1":
            assert 1.72e9 * skin * distance**2 / 2.0 == pytest.approx(d66, rel=5e-3)


def test_unsuitable_input_is_told(panel, reduced):
    frequency, modes = reduced[10]
    for skin, distance in ((0.0, 0.02), (1e-3, -1.0), (np.nan, 0.02)):
        with pytest.raises(ComponentError, match="positive"):
            FaceSheets.sandwich(skin, distance)
    with pytest.raises(ComponentError, match="nodes are 0 to"):
        stress_recovery(panel, SHEETS, modes, [len(panel.plate.positions)])
    with pytest.raises(ComponentError, match="no node"):
        stress_recovery(panel, SHEETS, modes, [])
    with pytest.raises(ComponentError, match=f"{frequency.size} modes"):
        stress_recovery(panel, SHEETS, modes).stress(np.zeros(3))
    tube = BeamSection(1e6, 10.0, 10.0, 5.0, 0.3)
    beam = beam_frame({"a": (0, 0, 0), "b": (1, 0, 0)}, [Member("a", "b", tube, 2)], points=("a", "b"))
    with pytest.raises(ComponentError, match="plates only"):
        stress_recovery(beam, SHEETS, np.zeros((beam.stiffness.shape[0], 1)))
