"""Imported finite elements: against the same model made here, closed forms of statics, and broken files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import io, sparse

from components.contract.component import ComponentError
from components.flexible.finite_elements import OutputRows
from components.flexible.modal import rigid_motion
from components.flexible.reduction import craig_bampton, orthonormal_modes
from components.imported.agreement import free_hertz
from components.imported.data import FiniteElementData, transformed
from components.imported.matrices import to_matrices, write_npz
from components.imported.points import JoinedPoint
from components.imported.reduced import reduced_data
from tests.references.imports.frame_model import JOINTS, POINTS, bar_frame, frame_data, imported


def _stored(folder: Path, data: FiniteElementData, **other) -> Path:
    path = folder / "frame.npz"
    np.savez(path, **{**to_matrices(data), **other})
    return path


def test_full_matrices_reduce_to_the_frequencies_and_masses_of_the_frame_itself(tmp_path):
    frame = bar_frame()
    own = craig_bampton(frame, ("left", "right", "tip"), 5)
    body = imported(_stored(tmp_path, frame_data(frame)))
    found = craig_bampton(body.model(), ("left", "right", "tip"), 5)
    np.testing.assert_allclose(found.frequency, own.frequency, rtol=1e-7)
    np.testing.assert_allclose(found.center_of_mass, own.center_of_mass, atol=1e-12)
    np.testing.assert_allclose(found.inertia, own.inertia, atol=1e-12 * np.trace(own.inertia))
    assert found.mass == pytest.approx(own.mass, rel=1e-12)
    np.testing.assert_allclose(np.abs(found.translation), np.abs(own.translation), atol=1e-6)


def test_inertia_in_the_deformation_converges_with_the_square_of_the_elements(tmp_path):
    """It comes from masses lumped to nodes, where the frame itself has samples within its elements."""
    errors = []
    for elements in (4, 8):
        frame = bar_frame(elements)
        own = craig_bampton(frame, ("left", "right", "tip"), 3)
        found = craig_bampton(
            imported(_stored(tmp_path, frame_data(frame))).model(), ("left", "right", "tip"), 3
        )
        exact = np.abs(own.invariant8[:3])
        errors.append(np.abs(np.abs(found.invariant8[:3]) - exact).max() / exact.max())
    assert errors[0] < 0.2
    assert errors[1] < errors[0] / 3.0


def test_matrix_market_and_columns_hold_the_same(tmp_path):
    data = frame_data(bar_frame())
    files = {name: str(tmp_path / f"{name}.mtx") for name in ("stiffness", "mass")}
    io.mmwrite(files["stiffness"], sparse.coo_array(data.stiffness), symmetry="general", precision=17)
    io.mmwrite(files["mass"], sparse.coo_array(data.mass), symmetry="general", precision=17)
    files["coordinates"] = str(tmp_path / "nodes.csv")
    table = [
        f"{n}, {x!r}, {y!r}, {z!r}"
        for n, (x, y, z) in zip(data.nodes, data.coordinates.tolist(), strict=True)
    ]
    Path(files["coordinates"]).write_text("# node, x, y, z\n" + "\n".join(table))
    found = imported(files).data()
    assert abs(found.stiffness - data.stiffness).max() <= 1e-15 * abs(data.stiffness).max()
    np.testing.assert_array_equal(found.dofs, data.dofs)


def test_units_and_displacement_axes_change_nothing(tmp_path):
    """The same frame in mm and t, a node of it in axes turned at random."""
    data = frame_data(bar_frame())
    turn = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0]
    change = sparse.lil_array(sparse.eye_array(len(data.dofs)))
    change[12:15, 12:15] = change[15:18, 15:18] = turn.T
    local = replace(
        transformed(data, sparse.csr_array(change), data.dofs),
        axes=np.array([turn if k == 2 else np.eye(3) for k in range(len(data.nodes))]),
    )
    from components.imported.data import checked, in_si

    scale = sparse.diags_array(np.where(local.dofs[:, 1] <= 3, 1e-3, 1.0))  # m per mm
    energy = 1e3  # 1 J is 1e3 t mm2/s2 ... 1 t mm2/s2 = 1e-3 J
    millimetres = replace(
        local,
        stiffness=sparse.csr_array(energy * scale @ local.stiffness @ scale),
        mass=sparse.csr_array(energy * scale @ local.mass @ scale),
        coordinates=1e3 * local.coordinates,
    )
    found = in_si(checked(millimetres), 1e-3, 1e3)
    assert abs(found.stiffness - data.stiffness).max() <= 1e-12 * abs(data.stiffness).max()
    assert abs(found.mass - data.mass).max() <= 1e-12 * abs(data.mass).max()


def test_a_rigid_element_is_a_node_with_its_arm(tmp_path):
    """One node on a rigid arm: the motion of the point is that of the node, moved; all others stay as they are."""
    data = frame_data(bar_frame())
    place = (2.0, 0.0, 0.1)
    joined = (JoinedPoint("tool", (3,), place),)
    body = imported(_stored(tmp_path, data), points=POINTS[:2], rigid_elements=joined)
    model = body.model()
    load = np.random.default_rng(5).standard_normal(6)
    arm = rigid_motion(np.array(JOINTS["tip"]) - place)
    rows = np.concatenate([model.attachment_dofs[name] for name in ("left", "right")])
    free = np.setdiff1d(np.arange(model.stiffness.shape[0]), rows)
    force = np.zeros(model.stiffness.shape[0])
    force[model.attachment_dofs["tool"]] = arm.T @ load
    moved = np.zeros_like(force)
    moved[free] = np.linalg.solve(model.stiffness.toarray()[np.ix_(free, free)], force[free])
    whole = data.stiffness.toarray()[12:, 12:]
    direct = np.linalg.solve(whole, np.concatenate([load, np.zeros(len(whole) - 6)]))[:6]
    np.testing.assert_allclose(arm @ moved[model.attachment_dofs["tool"]], direct, rtol=1e-9)


def test_a_mean_shares_a_force_out_and_stiffens_nothing(tmp_path):
    """A load on the mean of three nodes is the forces on them that have its resultant and least squares."""
    data = frame_data(bar_frame())
    body = imported(_stored(tmp_path, data), points=POINTS[:1], means=(JoinedPoint("middle", (4, 7, 10)),))
    model = body.model()
    np.testing.assert_allclose(model.mass, bar_frame().mass, rtol=1e-12)
    point = model.attachment_dofs["middle"]
    held = np.setdiff1d(np.arange(model.stiffness.shape[0]), model.attachment_dofs["left"])
    load = np.array([3.0, -2.0, 5.0, 0.4, 0.3, -0.2])
    force = np.zeros(model.stiffness.shape[0])
    force[point] = load
    moved = np.linalg.solve(model.stiffness.toarray()[np.ix_(held, held)], force[held])
    # energy of the same load on the frame itself, its nodal forces being the weights of the mean
    places = data.coordinates[[3, 6, 9]]
    fit = np.concatenate([rigid_motion(place - places.mean(axis=0))[:3] for place in places])
    nodal = np.linalg.pinv(fit).T @ load
    np.testing.assert_allclose(nodal.reshape(3, 3).sum(axis=0), load[:3], atol=1e-12)
    full = np.zeros(len(data.dofs))
    for k, node in enumerate((3, 6, 9)):
        full[6 * node : 6 * node + 3] = nodal[3 * k : 3 * k + 3]
    direct = np.linalg.solve(data.stiffness.toarray()[6:, 6:], full[6:])
    assert force[held] @ moved == pytest.approx(full[6:] @ direct, rel=1e-9)


def _unsymmetric(data):
    entries = data.stiffness.toarray()
    row, column = divmod(int(np.argmin(entries)), len(entries))  # the largest coupling, which is negative
    entries[row, column] *= 1.1
    return replace(data, stiffness=sparse.csr_array(entries))


def _grounded(data):
    return replace(data, stiffness=sparse.csr_array(data.stiffness + 50.0 * sparse.eye_array(len(data.dofs))))


def _not_a_number(data):
    values = data.mass.copy()
    values.data[5] = np.nan
    return replace(data, mass=values)


BROKEN = {
    "stiffness.*symmetric": _unsymmetric,
    "rigid motions.*energy": _grounded,
    "mass: 1 values.*finite": _not_a_number,
    "1 nodes .* 5": lambda d: replace(
        d, nodes=np.delete(d.nodes, 4), coordinates=np.delete(d.coordinates, 4, axis=0)
    ),
    "of freedom .*listed": lambda d: replace(d, dofs=d.dofs[:-2]),
    "mass matrix": lambda d: replace(d, mass=d.mass[:-6, :-6]),
    "kg/m3": lambda d: replace(
        transformed(
            d, sparse.csr_array(sparse.diags_array(np.where(d.dofs[:, 1] <= 3, 1e-3, 1.0))), d.dofs
        ),
        coordinates=1e3 * d.coordinates,
    ),
}  # fmt: skip


@pytest.mark.parametrize("told", BROKEN)
def test_a_broken_model_is_a_sentence(tmp_path, told):
    body = imported(_stored(tmp_path, BROKEN[told](frame_data(bar_frame()))))
    with pytest.raises(ComponentError, match=told):
        body.model()


def _as_reduced(change):
    """The frame reduced to its corners, with its samples of mass and recovered nodes changed."""
    return lambda data, folder: change(
        reduced_data(imported(_stored(folder, data)).model(), ("left", "right", "tip"), (), 6)
    )


FOREIGN = {
    "mass samples: .*by 1 ": lambda d: replace(d, samples=replace(d.samples, masses=2.0 * d.samples.masses)),
    "sample_positions .*sample_displacement": lambda d: replace(
        d, samples=replace(d.samples, positions=d.samples.positions + np.array((5.0, 0.0, 0.0)))
    ),
    "rigid motions.*place": lambda d: replace(
        d, recovery=replace(d.recovery, coordinates=d.recovery.coordinates[::-1])
    ),
}


@pytest.mark.parametrize("told", FOREIGN)
def test_what_comes_along_and_is_of_another_model_is_a_sentence(tmp_path, told):
    """Rigid motions. Regression: "no problem found", and loads 3 to 10 % off."""
    data = _as_reduced(FOREIGN[told])(frame_data(bar_frame()), tmp_path)
    write_npz(tmp_path / "changed.npz", data)
    with pytest.raises(ComponentError, match=told):
        imported(tmp_path / "changed.npz").model()


def test_a_coarse_model_comes_back_as_it_went(tmp_path):
    """Round trip through what an export writes, here and 50 m off. Regression: lumped samples were refused."""
    here = frame_data(bar_frame(2))
    for data in (here, replace(here, coordinates=here.coordinates + np.array((50.0, 0.0, 0.0)))):
        body = reduced_data(imported(_stored(tmp_path, data)).model(), ("left", "right", "tip"), (), 6)
        write_npz(tmp_path / "back.npz", body)
        assert not [row for row in imported(tmp_path / "back.npz").agreement() if row.problem]


def test_a_point_on_a_node_without_all_its_stiffness(tmp_path):
    """Message: the rotation about the normal of a flat shell. Regression: "negative energy"."""
    data = frame_data(bar_frame())
    gone = np.flatnonzero((data.dofs[:, 0] == 1) & (data.dofs[:, 1] == 6))
    keep = sparse.diags_array(np.where(np.isin(np.arange(len(data.dofs)), gone), 0.0, 1.0))
    bare = replace(
        data,
        stiffness=sparse.csr_array(keep @ data.stiffness @ keep),
        mass=sparse.csr_array(keep @ data.mass @ keep),
    )
    with pytest.raises(ComponentError, match="left about z"):
        imported(_stored(tmp_path, bare)).model()


def test_rows_that_nothing_meets_change_nothing(tmp_path):
    """A node without elements, as flat shells have rotations. Regression: its zeros were "negative energy"."""
    data = frame_data(bar_frame())
    loose = sparse.csr_array((6, 6))
    wider = replace(
        data,
        stiffness=sparse.csr_array(sparse.block_diag([data.stiffness, loose])),
        mass=sparse.csr_array(sparse.block_diag([data.mass, loose])),
        nodes=np.append(data.nodes, 99),
        coordinates=np.vstack([data.coordinates, [0.3, 0.2, 0.1]]),
        dofs=np.vstack([data.dofs, [(99, component) for component in range(1, 7)]]),
    )
    one, other = (free_hertz(imported(_stored(tmp_path, d)).model(), 4) for d in (data, wider))
    np.testing.assert_allclose(other, one, rtol=1e-12)


def test_files_cut_off_and_points_that_are_not_there_are_sentences(tmp_path):
    path = _stored(tmp_path, frame_data(bar_frame()))
    with pytest.raises(ComponentError, match="node 99"):
        imported(path, points=(("left", 99),)).model()
    path.write_bytes(path.read_bytes()[:4000])
    with pytest.raises(ComponentError, match="npz"):
        imported(path).model()
    write_npz(path, frame_data(bar_frame()))  # compressed
    content = path.read_bytes()
    path.write_bytes(content[:300] + bytes(200) + content[500:])
    with pytest.raises(ComponentError, match="npz"):
        imported(path).model()


def test_what_is_stated_is_compared(tmp_path):
    from components.imported.agreement import Stated

    path = _stored(tmp_path, frame_data(bar_frame()))
    mass = bar_frame().mass
    assert not [row for row in imported(path, stated=Stated(mass=1.009 * mass)).agreement() if row.problem]
    with pytest.raises(ComponentError, match="is stated"):
        imported(path, stated=Stated(mass=1.011 * mass)).model()


def test_rows_of_stress_come_along_when_a_body_is_reduced(tmp_path):
    """Of the reduced body read back, in its free modes, they are those of the full one."""
    data = frame_data(bar_frame())
    rows = np.random.default_rng(2).standard_normal((4, len(data.dofs)))
    rigid = data.rigid_motions()
    rows -= rows @ rigid @ np.linalg.pinv(rigid)
    outputs = OutputRows(("a", "b", "c", "d"), ("Pa", "N", "N.m", "N/m"), 1e6 * rows)
    full = imported(_stored(tmp_path, replace(data, outputs=outputs))).model()
    path = tmp_path / "reduced.npz"
    write_npz(path, reduced_data(full, ("left", "right", "tip"), (), 6))
    reduced = imported(path).model()
    stresses = []
    for model in (full, reduced):
        modes = orthonormal_modes(model, ("left", "right", "tip"), 6)[1][:, :8]
        stresses.append(np.abs(model.outputs.rows @ modes))
    np.testing.assert_allclose(stresses[1], stresses[0], atol=1e-6 * np.abs(stresses[0]).max())
    assert reduced.outputs.units == outputs.units
