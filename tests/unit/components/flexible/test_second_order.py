"""Displacements to second order against the geometry of what bends without stretching."""

import numpy as np
import pytest
from scipy.integrate import simpson

from components.contract.component import ComponentError
from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.flexible.modal import ModalData, inertia_invariants
from components.flexible.panel import PlateElements, panel_model
from components.flexible.plate import HingeArm, Panel, Plate, sandwich_stiffness
from components.flexible.reduction import craig_bampton, orthonormal_modes
from components.flexible.second_order import second_order_shapes, symmetric

SECTION = BeamSection(1e9, 1000.0, 3000.0, 700.0, 1.3, 1e-4)
LENGTH = 1.5
PLATE = Plate(1.0, 1.0, 1.0, (1.0, 1.0, 0.3, 0.35), (1.0, 1.1, 0.3, 0.35))


def slanted_beam(elements=24):
    """A beam in a general direction."""
    tip = LENGTH * np.array([0.6, -0.48, 0.64])
    return beam_frame({"root": (0.0, 0.0, 0.0), "tip": tip}, [Member("root", "tip", SECTION, elements)])


def node_motions(model):
    """Motions (6, n) of the nodes along the slanted beam, in order."""
    count = model.stiffness.shape[0] // 6
    order = [0, *range(2, count), 1]
    identity = np.eye(6 * count)
    return [identity[6 * i : 6 * i + 6] for i in order]


def test_a_beam_shortens_by_half_the_integral_of_its_squared_slopes():
    """Closed form: distance of the ends to second order, whatever the mean axes, for any two modes at once.

    The square of the distance is L^2 + 2 L d.a + |d|^2 of the first order d; inextensible, it is
    L^2 - L int theta^2 dx + |d across|^2, with slopes theta to the mean axes.
    """
    model = slanted_beam()
    data = craig_bampton(model, ["root", "tip"], 6, second_order_modes=8)
    _, modes = orthonormal_modes(model, ["root", "tip"], 6)
    axis = data.point_positions[1] / LENGTH
    turns = np.array([motion[3:] @ modes[:, :8] for motion in node_motions(model)])
    across = turns - axis[None, :, None] * np.einsum("a,qaj->qj", axis, turns)[:, None]
    slopes = np.einsum("qaj,qak->qjk", across, across)
    fine, coarse = (simpson(slopes[::n], dx=n * LENGTH / (len(turns) - 1), axis=0) for n in (1, 2))
    found = np.einsum("a,ajk->jk", axis, data.second_order_points[1, :3] - data.second_order_points[0, :3])
    # Simpson's rule leaves a fifteenth of what every second node changes, bounded by a tenth
    bound = 0.1 * np.abs(fine - coarse).max()
    assert bound < 0.01 * np.abs(fine).max()
    assert np.abs(found + fine).max() < bound


def panel():
    """A sandwich on three rigid arms and one that bends."""
    stiffness = sandwich_stiffness(2e-4, 0.01, 70e9, 0.3, 27e9)
    soft = BeamSection(1e6, 300.0, 200.0, 100.0)
    places = ((0.3, "inboard"), (-0.3, "inboard"), (0.25, "outboard"))
    arms = (
        *(HingeArm(f"arm{k}", y, edge) for k, (y, edge) in enumerate(places)),
        HingeArm("soft", -0.25, "outboard", section=soft),
    )
    return panel_model(Panel(Plate(1.0, 0.8, 2.0, *stiffness), arms, element_size=0.2))


def test_strain_of_a_plate():
    """Definition: the strains of a bicubic deflection and quadratic motion in the plane, exact in the elements."""
    plate = PlateElements(PLATE, [0.0, 0.7, 1.0], [0.0, 0.4, 1.0], 0.4)
    x, y = plate.places.T
    fields = [
        x**3 * y - x * y**2,
        3 * x**2 * y - y**2,
        x**3 - 2 * x * y,
        3 * x**2 - 2 * y,
        x**2 + x * y,
        y**2 - x * y,
    ]
    q = np.choose(plate.kind, fields)
    px, py = plate.positions[:, 0], plate.positions[:, 1]
    along_x, along_y = 3 * px**2 * py - py**2, px**3 - 2 * px * py
    expected = np.concatenate([2 * px + py, 2 * py - px, px - py])
    strain = plate.strain()
    assert strain.linear @ q == pytest.approx(expected, abs=1e-12)
    # of_pairs counts a shape with itself once: twice what the strain holds
    products = np.concatenate([along_x**2, along_y**2, 2 * along_x * along_y])
    assert strain.of_pairs(q[:, None])[:, 0] == pytest.approx(products, abs=1e-12)
    in_plane = np.where(plate.kind < 4, 0.0, q)
    stress = strain.linear.T @ (strain.stiffness @ (strain.linear @ q))
    assert stress == pytest.approx(plate.stiffness @ in_plane, abs=1e-12)


@pytest.mark.parametrize("model", [slanted_beam(6), panel()])
def test_second_order_shapes_balance_and_keep_the_mean_axes(model):
    """Equilibrium K Psi = -E^T D beta of all degrees of freedom, also held ones; sums of m Psi and m s x Psi vanish."""
    names = list(model.attachment_dofs)
    shapes = orthonormal_modes(model, names, 4)[1][:, :5]
    response = second_order_shapes(model, shapes)
    strain = model.strain
    load = strain.linear.T @ (strain.stiffness @ strain.of_pairs(shapes))
    assert np.abs(model.stiffness @ response + load).max() < 1e-8 * np.abs(load).max()
    motion = (model.displacement @ response).reshape(len(model.masses), 3, -1)
    arms = model.positions - model.center_of_mass
    scale = model.mass * np.abs(motion).max()
    assert np.abs(np.tensordot(model.masses, motion, 1)).max() < 1e-12 * scale
    turning = np.cross(arms[:, :, None], motion, axisa=1, axisb=1, axisc=1)
    assert np.abs(np.tensordot(model.masses, turning, 1)).max() < 1e-12 * scale


def test_inertia_of_the_bent_body_is_that_of_its_moved_masses():
    """Definition: J to second order in the coordinates, from masses moved to second order."""
    model = slanted_beam(8)
    names = ["root", "tip"]
    data = craig_bampton(model, names, 4, second_order_modes=6)
    modes = orthonormal_modes(model, names, 4)[1]
    psi = symmetric(second_order_shapes(model, modes[:, :6]), 6)
    eta = np.zeros(data.frequency.size)
    eta[:6] = np.random.default_rng(1).standard_normal(6)

    turned = 0.5 * np.einsum("njk,j,k->n", psi, eta[:6], eta[:6])

    def inertia(scale):
        moved = modes @ (scale * eta) + scale**2 * turned
        arms = model.positions - model.center_of_mass + (model.displacement @ moved).reshape(-1, 3)
        return inertia_invariants(model.masses, arms, np.zeros((arms.size, 0))).i7

    second = 0.5 * (inertia(1e-3) + inertia(-1e-3) - 2.0 * data.inertia)
    expected = -1e-6 * np.einsum("jkab,j,k->ab", data.invariant9, eta, eta)
    # left is the fourth order, the inertia of the displacements of second order alone
    fourth = 1e-12 * turned @ (model.mass_matrix @ turned)
    assert fourth < 1e-3 * np.abs(expected).max()
    assert np.abs(second - expected).max() < fourth


def test_no_second_order_modes_is_the_linear_body_in_every_bit():
    """Definition; and modes that are kept keep what they do in pairs."""
    model = slanted_beam(6)
    linear, second = (craig_bampton(model, ["root", "tip"], 4, second_order_modes=count) for count in (0, 4))
    assert linear.second_order_points.size == 0
    for name in ("invariant5", "invariant8", "translation", "rotation"):
        assert np.array_equal(getattr(linear, name), getattr(second, name))
    kept = second.keep_modes([1, 3, 5])
    assert kept.second_order_modes == 2
    assert np.array_equal(kept.second_order_points[1, :, 0, 1], second.second_order_points[1, :, 1, 3])
    again = ModalData.from_arrays({k: np.asarray(v).tolist() for k, v in second.to_arrays().items()})
    assert np.array_equal(again.second_order_points, second.second_order_points)


def test_wrong_numbers_are_sentences():
    """More modes than there are, and tables that fit no number of modes."""
    with pytest.raises(ComponentError, match=r"11 .*10 modes"):
        craig_bampton(slanted_beam(6), ["root", "tip"], 4, second_order_modes=11)
    arrays = craig_bampton(slanted_beam(6), ["root", "tip"], 4).to_arrays()
    with pytest.raises(ComponentError, match="second_order_points has 7 numbers"):
        ModalData.from_arrays({**arrays, "second_order_points": np.zeros(7)})
