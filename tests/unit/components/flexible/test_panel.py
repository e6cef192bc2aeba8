"""Plates and panels against published, closed-form and independently computed numbers."""

import numpy as np
import pytest
import skfem
from scipy import sparse
from scipy.sparse.linalg import eigsh
from skfem.helpers import dd, ddot

from components.contract.component import ComponentError
from components.flexible.beam_frame import BeamSection
from components.flexible.laminate import Layer, laminate_stiffness
from components.flexible.panel import PlateElements, panel_model
from components.flexible.plate import HingeArm, Panel, Plate, sandwich_stiffness

NU = 0.3
UNIT = Plate(1.0, 1.0, 1.0, (1.0, 1.0, NU, 0.5 * (1 - NU)), (1.0, 1.0, NU, 0.5 * (1 - NU)))
CONVERGED = {
    "FFFF": [13.468, 19.596, 24.270, 34.801, 34.801, 61.093],
    "CFFF": [3.4710, 8.5065, 21.285, 27.199, 30.955, 54.186],
    "SSSS": np.pi**2 * np.array([2, 5, 5, 8, 10, 10]),
    "CCCC": [35.985, 73.394, 73.394, 108.22, 131.58, 132.21],
    "CFCF": [22.166, 26.404, 43.593, 61.173, 67.172],
    "SFSF": [9.631, 16.135, 36.726, 38.945, 46.738],
}
LEISSA = {"FFFF": [13.489, 19.789, 24.432], "CFFF": [3.4917], "CCCC": [35.992, 73.413, 73.413]}


def unit_plate(element_size=1 / 28):
    return PlateElements(UNIT, [0.0, 1.0], [0.0, 1.0], element_size)


def bending_mass(plate):
    weights = sparse.diags_array(np.repeat(plate.masses, 3))
    return plate.displacement.T @ weights @ plate.displacement


def supported_frequencies(plate, edges, count):
    """Lowest bending frequencies; `edges` are C, S or F at x = 0, y = 0, x = 1, y = 1."""
    held = plate.kind >= 4
    for edge, (axis, end) in zip(edges, ((0, 0.0), (1, 0.0), (0, 1.0), (1, 1.0)), strict=True):
        along = 2 if axis == 0 else 1
        kinds = {"C": [0, 1, 2, 3], "S": [0, along], "F": []}[edge]
        held |= (np.abs(plate.places[:, axis] - end) < 1e-9) & np.isin(plate.kind, kinds)
    free = np.flatnonzero(~held)
    stiffness, mass = (sparse.csc_array(m)[free][:, free] for m in (plate.stiffness, bending_mass(plate)))
    rigid = {"FFFF": 3}.get(edges, 0)
    values = eigsh(stiffness, count + rigid, mass, sigma=-1.0, return_eigenvectors=False)
    return np.sqrt(np.sort(values)[rigid:])


@pytest.mark.parametrize("edges", CONVERGED)
def test_square_plates(edges):
    """Converged Ritz and Bogner-Fox-Schmit rows, SSSS pi^2 (m^2 + n^2); Leissa 1973 is up to 1 % higher."""
    expected = np.array(CONVERGED[edges])
    found = supported_frequencies(unit_plate(), edges, expected.size)
    np.testing.assert_allclose(found, expected, rtol=1e-4)
    if edges in LEISSA:
        np.testing.assert_allclose(found[: len(LEISSA[edges])], LEISSA[edges], rtol=0.01)


def test_kronecker_products_equal_two_dimensional_assembly():
    """Independent formulation: scikit-fem's own Bogner-Fox-Schmit element on a non-uniform mesh."""
    plate = Plate(1.0, 0.7, 2.0, (3.0, 2.0, 0.4, 0.5), (1.0, 1.0, 0.3, 0.3))
    x, y = [0.0, 0.1, 0.5, 1.0], [-0.35, 0.0, 0.1, 0.35]
    ours = PlateElements(plate, x, y, 1.0)
    basis = skfem.CellBasis(skfem.MeshQuad.init_tensor(np.array(x), np.array(y)), skfem.ElementQuadBFS())

    @skfem.BilinearForm
    def stiffness(u, v, _):
        h = dd(u)
        xx, yy, xy = h[0, 0], h[1, 1], h[0, 1]
        moment = np.array([[3.0 * xx + 0.4 * yy, 2 * 0.5 * xy], [2 * 0.5 * xy, 2.0 * yy + 0.4 * xx]])
        return ddot(moment, dd(v))

    @skfem.BilinearForm
    def mass(u, v, _):
        return 2.0 * u * v

    def spectrum(k, m):
        return np.linalg.eigvals(np.linalg.solve(m.toarray(), k.toarray())).real

    bend = np.flatnonzero(ours.kind < 4)
    mine = spectrum(ours.stiffness[bend][:, bend], sparse.csr_array(bending_mass(ours))[bend][:, bend])
    theirs = spectrum(stiffness.assemble(basis), mass.assemble(basis))
    np.testing.assert_allclose(np.sort(mine)[3:], np.sort(theirs)[3:], rtol=1e-6)


def test_clamped_plate_under_a_central_load():
    """Timoshenko's clamped square plate: deflection 5.61e-3 P a^2 / D under a point load at the centre."""
    plate = PlateElements(UNIT, [0.0, 0.5, 1.0], [0.0, 0.5, 1.0], 1 / 16)
    edge = np.any(np.abs(plate.places - 0.5) > 0.5 - 1e-9, axis=1)
    free = np.flatnonzero(~edge & (plate.kind < 4))
    center = plate.motion(0.5, 0.5)[[2]]
    load = center.toarray()[0]
    motion = np.zeros(load.size)
    motion[free] = sparse.linalg.spsolve(sparse.csc_array(plate.stiffness)[free][:, free], load[free])
    assert (center @ motion)[0] == pytest.approx(5.61e-3, rel=2e-3)


@pytest.mark.parametrize("strain", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.3, -0.2, 0.5)])
def test_uniform_stretch(strain):
    """Patch test: a uniform strain has the energy ½ e A e per area and no force inside the mesh."""
    plate = Plate(2.0, 1.0, 1.0, (1.0, 1.0, 0.1, 0.1), (7.0, 5.0, 2.0, 3.0))
    elements = PlateElements(plate, [0.0, 0.3, 2.0], [-0.5, 0.1, 0.5], 0.4)
    exx, eyy, gxy = strain
    x, y = elements.places.T
    motion = np.where(elements.kind == 4, exx * x + gxy * y, np.where(elements.kind == 5, eyy * y, 0.0))
    force = elements.stiffness @ motion
    e = np.array(strain)
    stiffness = np.array([[7.0, 2.0, 0.0], [2.0, 5.0, 0.0], [0.0, 0.0, 3.0]])
    assert motion @ force == pytest.approx(2.0 * e @ stiffness @ e)
    inside = (x > 1e-9) & (x < 2.0 - 1e-9) & (np.abs(y) < 0.5 - 1e-9)
    assert np.abs(force[inside]).max() < 1e-12


def test_motion_at_a_point():
    """Closed form: for w = x^2 y the rotation is (w_y, -w_x) = (x^2, -2 x y); in plane half the curl."""
    plate = unit_plate(0.3)
    x, y = plate.places.T
    w = np.select([plate.kind == k for k in range(4)], [x**2 * y, 2 * x * y, x**2, 2 * x])
    values = w + np.where(plate.kind == 4, -0.2 * y, 0.0) + np.where(plate.kind == 5, 0.6 * x, 0.0)
    found = plate.motion(0.37, 0.81) @ values
    expected = [-0.2 * 0.81, 0.6 * 0.37, 0.37**2 * 0.81, 0.37**2, -2 * 0.37 * 0.81, 0.4]
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_translations_on_a_grid_are_those_of_its_points():
    """Independent path: every point on its own, on both sides of an element's edge and at the ends."""
    plate = unit_plate(0.25)
    x, y = np.array([0.0, 0.25, 0.26, 1.0]), np.array([0.1, 0.5, 1.0])
    expected = sparse.vstack([plate.motion(a, b)[:3] for a in x for b in y])
    np.testing.assert_array_equal(plate.translations(x, y).toarray(), expected.toarray())


@pytest.mark.parametrize("z", [0.0, 0.03])
def test_insert_patch_is_rigid(z):
    """Geometry: any motion of a fitting with a rigid arm moves the plate under its patch as a rigid body."""
    arms = (HingeArm("a", 0.0, "outboard", point_mass=0.1, patch=0.2, length=0.1, z=z),)
    model = panel_model(Panel(UNIT, arms, {"on": (0.95, 0.05)}, plate_start=0.0, element_size=0.2))
    tip = model.point_positions["a"]
    np.testing.assert_allclose(tip, [1.1, 0.0, z])
    values = np.zeros(model.stiffness.shape[0])
    motion = np.array([1.0, 2.0, 3.0, 0.4, 0.5, 0.6])
    values[model.attachment_dofs["a"]] = motion
    arm = model.point_positions["on"] - tip
    expected = np.append(motion[:3] + np.cross(motion[3:], arm), motion[3:])
    np.testing.assert_allclose(model.point_motions["on"] @ values, expected, atol=1e-11)


def test_patch_beyond_the_plate():
    """The message names the arm."""
    with pytest.raises(ComponentError, match="'far'"):
        panel_model(Panel(UNIT, (HingeArm("far", 0.49, patch=0.1),)))


def test_sandwich_formula():
    """Data sheet: skins 0.30 mm, E 163.5 GPa, G 1.72 GPa, core 25 mm give D11 15 700 and D66 165 N.m."""
    bending, membrane = sandwich_stiffness(0.30e-3, 25e-3, 163.5e9, 0.0, 1.72e9)
    assert bending[0] == pytest.approx(15700.0, rel=1e-3)
    assert bending[3] == pytest.approx(165.0, rel=2e-3)
    assert membrane[0] == pytest.approx(98e6, rel=2e-3)


def test_thick_skins_are_layers_of_a_laminate():
    """Two ways: skins of 2 mm on a core of 1 mm without stiffness. Regression: their own bending was left out, 13 %."""
    skin, core = Layer(2e-3, 70e9, 70e9, 0.3, 70e9 / 2.6), Layer(1e-3, 1.0, 1.0, 0.0, 1.0)
    bending, membrane, _ = laminate_stiffness([skin, core, skin])
    found = sandwich_stiffness(2e-3, 1e-3, 70e9, 0.3, 70e9 / 2.6)
    np.testing.assert_allclose(found, (bending, membrane), rtol=1e-9)


def test_arms_off_the_mid_plane_bend_nothing_in_rigid_motion():
    """Rigid motions have no strain, but for round-off of the stiffest element, and points move with them."""
    section = BeamSection(6.7e6, 141.0, 30.17, 740.0)
    arms = tuple(
        HingeArm(f"{edge}_arm", 0.2, edge, section=section, point_mass=0.05, patch=0.2, length=0.1, z=z)
        for edge, z in (("inboard", 0.03), ("outboard", -0.02))
    )
    model = panel_model(Panel(UNIT, arms, plate_start=0.1, element_size=0.2))
    np.testing.assert_allclose(model.point_positions["outboard_arm"], [1.2, 0.2, -0.02])
    assert np.abs(model.stiffness @ model.rigid_motions).max() < 1e-14 * np.abs(model.stiffness).max()
    for name, place in model.point_positions.items():
        x, y, z = place
        expected = [[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]
        moved = (model.point_motions[name] @ model.rigid_motions)[:3]
        np.testing.assert_allclose(moved, expected, atol=1e-12)
