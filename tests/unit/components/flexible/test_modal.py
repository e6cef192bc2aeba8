"""Reduction, inertia invariants, modal data: closed forms, published numbers, sums over the samples."""

import numpy as np
import pytest
from scipy import linalg

from components.body_parts.inertia_coupling import InertiaCoupling, symmetric_product
from components.contract.component import ComponentError
from components.contract.frames import skew
from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.flexible.modal import ModalData, default_damping, inertia_invariants, rigid_motion
from components.flexible.panel import panel_model
from components.flexible.plate import HingeArm, Panel, Plate
from components.flexible.reduction import (
    craig_bampton,
    fixed_interface_frequencies,
    free_frequencies,
    orthonormal_modes,
)

PLATE = Plate(1.5, 1.16, 4.3, (15700.0, 15700.0, 2800.0, 165.0), (98e6, 98e6, 5e6, 10e6))
ARM = BeamSection(6.7e6, 141.0, 30.17, 740.0)
SIDES = (("left", 0.565), ("right", -0.565))


def coarse_panel(edges=("inboard",), element_size=0.15):
    arms = tuple(
        HingeArm(f"{edge}_{side}", y, edge, section=ARM, point_mass=0.05)
        for edge in edges
        for side, y in SIDES
    )
    return panel_model(Panel(PLATE, arms, {"center": (0.805, 0.0)}, element_size=element_size))


def spatial_frame():
    """Lopsided frame out of any plane, so that no invariant vanishes by symmetry."""
    section = BeamSection(4e6, 900.0, 500.0, 300.0, 0.8, 0.02)
    joints = {"a": (0, 0, 0), "b": (1.1, 0.2, 0.1), "c": (0.7, -0.6, 0.5)}
    members = [Member("a", "b", section, 5), Member("b", "c", section, 5, 0.3)]
    return beam_frame(joints, members, {"c": 0.4})


MODELS = {
    "panel": (coarse_panel(), ("inboard_left", "inboard_right")),
    "four": (
        coarse_panel(("inboard", "outboard"), 0.3),
        ("inboard_left", "inboard_right", "outboard_left", "outboard_right"),
    ),
    "frame": (spatial_frame(), ("a", "c")),
}


@pytest.fixture(params=MODELS, scope="module")
def reduced(request):
    model, points = MODELS[request.param]
    frequency, modes = orthonormal_modes(model, points, 6)
    return model, points, frequency, modes, craig_bampton(model, points, 6)


def deformed(model, modes, eta):
    arms = model.positions - model.center_of_mass
    return arms, (model.displacement @ modes @ eta).reshape(-1, 3)


def test_modes_are_orthonormal(reduced):
    """Definition: unit modal mass, stiffness the squared frequencies."""
    model, _, frequency, modes, _ = reduced
    gram = modes.T @ (model.mass_matrix @ modes)
    np.testing.assert_allclose(gram, np.eye(frequency.size), atol=1e-8)
    stiffness = modes.T @ (model.stiffness @ modes)
    scale = np.outer(frequency, frequency)
    np.testing.assert_allclose(stiffness / scale, np.eye(frequency.size), atol=1e-6)


def test_i3_and_i4_vanish(reduced):
    """Table 1-1 of the thesis for modes without rigid motion: I3 = I4 = 0, I6 = 1, to round-off."""
    model, _, _, modes, _ = reduced
    arms = model.positions - model.center_of_mass
    found = inertia_invariants(model.masses, arms, model.displacement @ modes)
    assert np.abs(found.i2).max() < 1e-14 * found.i1
    assert np.abs(found.i3).max() < 1e-12
    assert np.abs(found.i4).max() < 1e-12
    np.testing.assert_allclose(found.i6, np.eye(len(found.i6)), atol=1e-8)


def test_inertia_of_the_deformed_body(reduced):
    """Independent sum over the samples: J = sum m skew(s + u)^T skew(s + u) for random modal coordinates."""
    model, _, frequency, modes, data = reduced
    eta = np.random.default_rng(3).standard_normal(frequency.size) * 0.02
    arms, u = deformed(model, modes, eta)
    cross = skew(arms + u)
    brute = np.einsum("q,qji,qjk->ik", model.masses, cross, cross)
    coupling = InertiaCoupling(data, "full").at(eta)
    found = [symmetric_product(coupling.inertia, axis) for axis in np.eye(3)] + coupling.b @ coupling.b.T
    np.testing.assert_allclose(found, brute, atol=1e-12 * np.abs(brute).max())
    assert np.abs(brute - data.inertia).max() > 1e-4 * np.abs(brute).max()


def test_gyroscopic_coupling(reduced):
    """Independent sum over the samples: B = sum m (s + u) x phi_k, with I4 + I5 eta, not I4 - I5 eta."""
    model, _, frequency, modes, data = reduced
    eta = np.random.default_rng(4).standard_normal(frequency.size)
    arms, u = deformed(model, modes, eta)
    shapes = (model.displacement @ modes).reshape(-1, 3, frequency.size)
    brute = np.einsum("q,qij,qjk->ik", model.masses, skew(arms + u), shapes)
    np.testing.assert_allclose(np.tensordot(eta, data.invariant5, 1), brute, atol=1e-11)


def test_invariants_one_by_one():
    """Table 1-1 written out as loops over three masses and two modes."""
    rng = np.random.default_rng(5)
    m, s, phi = rng.random(3) + 0.5, rng.standard_normal((3, 3)), rng.standard_normal((3, 3, 2))
    found = inertia_invariants(m, s, phi.reshape(9, 2))
    masses = range(3)
    np.testing.assert_allclose(found.i3, sum(m[p] * phi[p] for p in masses))
    np.testing.assert_allclose(found.i4, sum(m[p] * skew(s[p]) @ phi[p] for p in masses))
    np.testing.assert_allclose(found.i7, sum(m[p] * skew(s[p]).T @ skew(s[p]) for p in masses))
    for j in range(2):
        columns = [skew(phi[p, :, j]) for p in masses]
        np.testing.assert_allclose(found.i5[j], sum(m[p] * columns[p] @ phi[p] for p in masses), atol=1e-14)
        np.testing.assert_allclose(found.i8[j], sum(m[p] * skew(s[p]) @ columns[p] for p in masses))
        for k in range(2):
            other = [skew(phi[p, :, k]) for p in masses]
            np.testing.assert_allclose(found.i9[j, k], sum(m[p] * columns[p] @ other[p] for p in masses))


def test_rigid_motions_are_exact_and_strainless(reduced):
    """Geometry: samples and points move by t + theta x r; the strain energy is round-off; modes have none."""
    model, _, _, modes, _ = reduced
    expected = np.concatenate([rigid_motion(p)[:3] for p in model.positions])
    np.testing.assert_allclose(model.displacement @ model.rigid_motions, expected, atol=1e-12)
    for name, position in model.point_positions.items():
        motion = model.point_motions[name] @ model.rigid_motions
        np.testing.assert_allclose(motion, rigid_motion(position), atol=1e-11)
    force = np.abs(model.stiffness @ model.rigid_motions).max()
    assert force < 1e-14 * np.abs(model.stiffness).max()
    assert np.abs(modes.T @ (model.mass_matrix @ model.rigid_motions)).max() < 1e-12


def test_display_grid_moves_rigidly(reduced):
    """Geometry: the coarse grid follows a rigid motion exactly."""
    model = reduced[0]
    expected = np.concatenate([rigid_motion(p)[:3] for p in model.display_positions])
    np.testing.assert_allclose(model.display_displacement @ model.rigid_motions, expected, atol=1e-11)
    assert model.display_faces.max() == len(model.display_positions) - 1


@pytest.mark.parametrize("kept", [1, 4, 8])
def test_fixed_interface_modes_stay_exact(reduced, kept):
    """B12 (thesis, Table 3-3): clamping the reduced body's attachment points returns the modes it holds."""
    model, points, *_ = reduced
    data = craig_bampton(model, points, kept)
    arms = data.point_positions - data.center_of_mass
    rigid = np.concatenate([rigid_motion(p) for p in arms])
    shapes = np.concatenate([data.translation, data.rotation], axis=1).reshape(rigid.shape[0], -1)
    mass = linalg.block_diag(np.eye(3) * data.mass, data.inertia, np.eye(data.frequency.size))
    stiffness = np.diag(np.append(np.zeros(6), data.frequency**2))
    clamped = linalg.null_space(np.hstack([rigid, shapes]), rcond=1e-9)
    values = linalg.eigh(clamped.T @ stiffness @ clamped, clamped.T @ mass @ clamped, eigvals_only=True)
    exact = fixed_interface_frequencies(model, points, kept)
    np.testing.assert_allclose(np.sqrt(values), exact, rtol=1e-6)


@pytest.mark.parametrize("kept", [0, 5])
def test_statics_of_interface_loads_are_exact(reduced, kept):
    """Constraint modes: balanced loads at the attachment points do the same work in the full elements."""
    model, points, *_ = reduced
    data = craig_bampton(model, points, kept)
    boundary = np.concatenate([model.attachment_dofs[name] for name in points])
    balanced = linalg.null_space(model.rigid_motions[boundary].T)
    full_load = np.zeros((model.stiffness.shape[0], balanced.shape[1]))
    full_load[boundary] = balanced
    held = model.attachment_dofs[points[0]]
    free = np.setdiff1d(np.arange(model.stiffness.shape[0]), held)
    response = linalg.solve(model.stiffness[free][:, free].toarray(), full_load[free], assume_a="pos")
    shapes = np.concatenate([data.translation, data.rotation], axis=1).reshape(boundary.size, -1)
    compliance = balanced.T @ ((shapes / data.frequency**2) @ shapes.T) @ balanced
    exact = full_load[free].T @ response
    np.testing.assert_allclose(compliance, exact, atol=1e-6 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("edges", "fixed", "flexible"),
    [(("inboard",), 5, 11), (("inboard", "outboard"), 5, 23), (("inboard",), 0, 6), (("inboard",), 40, 46)],
)
def test_mode_counts(edges, fixed, flexible):
    """B7, B17 (thesis, 3.4.1.4): fixed-interface modes + 6 per attachment point - 6."""
    names = [f"{edge}_{side}" for edge in edges for side, _ in SIDES]
    data = craig_bampton(coarse_panel(edges), names, fixed, ["center"])
    assert data.frequency.size == flexible
    assert data.point_names == (*names, "center")
    assert np.all(np.diff(data.frequency) >= 0.0)


def test_reduced_modes_come_down_to_the_full_ones():
    """B11 trend (thesis, Table 3-2): more fixed-interface modes lower the free modes to the full ones."""
    model, points = MODELS["panel"]
    full = free_frequencies(model, 4)
    found = np.array([craig_bampton(model, points, n).frequency[:4] for n in (2, 3, 4, 5, 10)])
    assert np.all(np.diff(found, axis=0) <= 1e-6 * full)
    assert np.all(found >= full * (1.0 - 1e-9))
    seed = np.array([12.98702, 12.98702, 12.91614, 12.91577, 12.91187])
    np.testing.assert_allclose(found[:, 0] / (2 * np.pi), seed, rtol=0.006)
    np.testing.assert_allclose(
        found[1:, 1] / (2 * np.pi), [99.03446, 92.81318, 91.71484, 89.85175], rtol=0.04
    )


def test_default_damping():
    """B29 (thesis, D.2.1): 1 % below 100 Hz, 10 % to 1 kHz, critical above."""
    hertz = np.array([0.5, 99.9, 100.1, 999.0, 1001.0, 2e4])
    np.testing.assert_array_equal(default_damping(2 * np.pi * hertz), [0.01, 0.01, 0.1, 0.1, 1.0, 1.0])


def test_modes_are_switched_off():
    """Bookkeeping: by index and by range in Hz, every field shrinks alike and the rest is untouched."""
    model, points = MODELS["panel"]
    data = craig_bampton(model, points, 4, ["center"])
    hertz = data.frequency / (2 * np.pi)
    less = data.switch_off(modes=[0], ranges=[(1000.0, np.inf)])
    keep = np.flatnonzero((np.arange(hertz.size) > 0) & (hertz < 1000.0))
    assert 0 < keep.size < hertz.size - 1
    np.testing.assert_array_equal(less.frequency, data.frequency[keep])
    np.testing.assert_array_equal(less.invariant9, data.invariant9[np.ix_(keep, keep)])
    np.testing.assert_array_equal(less.invariant5, data.invariant5[keep][:, :, keep])
    np.testing.assert_array_equal(less.translation, data.translation[:, :, keep])
    ModalData.from_arrays(less.to_arrays())
    assert data.keep_modes(np.zeros(hertz.size, dtype=bool)).frequency.size == 0
    with pytest.raises(ComponentError, match="no mode 99"):
        data.switch_off(modes=[99])


def test_damping_is_replaced():
    """Bookkeeping: one ratio for all modes; a negative one is refused."""
    model, points = MODELS["frame"]
    data = craig_bampton(model, points, 0)
    np.testing.assert_array_equal(data.with_damping(0.02).damping_ratio, np.full(6, 0.02))
    with pytest.raises(ComponentError, match="negative"):
        data.with_damping(-0.1)


def test_arrays_round_trip_and_are_checked():
    """Bookkeeping: fields survive as arrays and nested lists; missing fields, wrong shapes are named."""
    model, points = MODELS["frame"]
    data = craig_bampton(model, points, 1)
    arrays = data.to_arrays()
    lists = {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in arrays.items()}
    for copy in (ModalData.from_arrays(arrays), ModalData.from_arrays(lists)):
        for name, value in copy.to_arrays().items():
            np.testing.assert_array_equal(value, arrays[name])
    with pytest.raises(ComponentError, match="rotation"):
        ModalData.from_arrays({k: v for k, v in arrays.items() if k != "rotation"})
    with pytest.raises(ComponentError, match="invariant5 has shape"):
        ModalData.from_arrays(arrays | {"invariant5": np.zeros((2, 3, 2))})


def test_rigid_body_has_no_modes():
    """Bookkeeping: a rigid body is modal data with M = 0 and keeps its mass properties."""
    body = ModalData.rigid(2.0, (1.0, 0.0, 0.0), np.diag([1.0, 2.0, 2.5]), {"p": (0.0, 0.0, 0.0)})
    again = ModalData.from_arrays(body.to_arrays())
    assert again.frequency.size == 0
    assert again.translation.shape == (1, 3, 0)
    np.testing.assert_array_equal(again.inertia, np.diag([1.0, 2.0, 2.5]))


def test_point_masses_lose_their_rigid_motion():
    """Definition: whatever shapes come in, the modes have no momentum, no moment of it, and unit mass."""
    rng = np.random.default_rng(6)
    m, x, shapes = rng.random(5) + 0.2, rng.standard_normal((5, 3)), rng.standard_normal((15, 3))
    body = ModalData.from_point_masses(m, x, shapes, [1.0, 2.0, 3.0], {str(i): i for i in range(5)})
    phi = body.translation
    assert np.abs(np.tensordot(m, phi, 1)).max() < 1e-13
    assert np.abs(np.einsum("q,qij,qjk->ik", m, skew(x - body.center_of_mass), phi)).max() < 1e-13
    np.testing.assert_allclose(np.einsum("q,qij,qik->jk", m, phi, phi), np.eye(3), atol=1e-13)


def test_reduction_is_reproducible():
    """Determinism: two runs give the same bits, signs included."""
    model, points = MODELS["panel"]
    first, second = (craig_bampton(model, points, 5) for _ in range(2))
    np.testing.assert_array_equal(first.translation, second.translation)


def test_impossible_reductions_are_refused():
    """Messages name what is wrong."""
    model, points = MODELS["panel"]
    with pytest.raises(ComponentError, match="'nowhere'"):
        craig_bampton(model, ["nowhere"], 2)
    with pytest.raises(ComponentError, match="least one"):
        craig_bampton(model, [], 2)
    with pytest.raises(ComponentError, match="negative"):
        craig_bampton(model, points, -1)
