"""Shells and beams that CalculiX expands into solids, and solids of reduced integration."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy import linalg, sparse

from components.contract.component import ComponentError
from components.flexible.reduction import fixed_interface_frequencies
from components.imported.data import INTERNAL, FiniteElementData
from components.imported.matrices import write_npz
from components.imported.points import JoinedPoint
from components.imported.reading import read
from components.imported.text.decks import read_deck
from tests.references.imports.frame_model import imported

TEE = Path(__file__).parents[3] / "references" / "imports" / "calculix" / "tee.sti"
HELD = (2.301489e2, 1.231379e3, 1.868839e3)
"""rad/s; of the same shells and beam with nodes 1 and 4 held, from *FREQUENCY of CalculiX 2.20."""
THICKNESS, WIDTH, HEIGHT = 0.004, 0.02, 0.01


def test_expanded_nodes_are_where_calculix_puts_them():
    """Definition: half of the thickness along the normal of a shell, corners of the section of a beam."""
    data = read({"file": TEE})
    flat = np.array([data.coordinates[data.place(part)] for part in data.parts(2)])
    np.testing.assert_allclose(flat, [[0.1, 0, -0.5 * THICKNESS], [0.1, 0, 0.5 * THICKNESS]], atol=1e-9)
    upright = np.array([data.coordinates[data.place(part)] for part in data.parts(8)])
    np.testing.assert_allclose(np.abs(upright - [0.2, 0.1, 0.1]), [[0.5 * THICKNESS, 0, 0]] * 2, atol=1e-9)
    along = np.array([0.1, 0, -0.05]) / np.hypot(0.1, 0.05)
    first = np.array([0.1, 0.2, 1.0]) - along * (np.array([0.1, 0.2, 1.0]) @ along)
    first = first / np.linalg.norm(first)
    second = np.cross(along, first)
    corners = [0.5 * (a * WIDTH * first + b * HEIGHT * second) for a in (1, -1) for b in (1, -1)]
    found = np.array([data.coordinates[data.place(part)] for part in data.parts(9)]) - [0.3, 0, -0.05]
    off = np.linalg.norm(found[:, None] - np.array(corners), axis=2)
    np.testing.assert_allclose(off.min(axis=0), 0.0, atol=1e-8)
    np.testing.assert_allclose(off.min(axis=1), 0.0, atol=1e-8)
    assert set(data.dofs_of(5)) == set(range(1, 7)), "shells and a beam meet in a knot that turns"
    assert int(np.sum(data.dofs[:, 1] == INTERNAL)) == 4 * 9 + 2, (
        "three nodes an element, thickness of two knots"
    )


def test_shells_and_a_beam_of_calculix():
    """Its own frequencies: digits of the first; 3e-5 of others, as it leaves the thickness of the held edge free.

    A node of the beam is an attachment point, as its section spans a plane.
    """
    root = JoinedPoint("root", (1, 4))
    model = imported(TEE, points=(("end", 9),), rigid_elements=(root,), nodes=(("corner", 8),)).model()
    volume = 0.3 * 0.1 * THICKNESS + WIDTH * HEIGHT * np.hypot(0.1, 0.05)
    assert model.mass == pytest.approx(2700.0 * volume, rel=1e-9)
    np.testing.assert_allclose(model.point_positions["end"], [0.3, 0, -0.05], atol=1e-9)
    np.testing.assert_allclose(model.point_positions["root"], [0, 0.05, 0], atol=1e-9)
    np.testing.assert_allclose(model.point_positions["corner"], [0.2, 0.1, 0.1], atol=1e-9)
    held = imported(TEE, points=(), rigid_elements=(root,)).model()
    found = fixed_interface_frequencies(held, ("root",), 3)
    assert found[0] == pytest.approx(HELD[0], rel=3e-7)
    np.testing.assert_allclose(found, HELD, rtol=4e-5)


def test_a_node_that_is_a_part_itself_stays_in_its_place(tmp_path):
    """A mass of 0.5 kg at node 2: CalculiX keeps the node and drops its lower part, 2 x middle - upper. Definition."""
    dofs = TEE.with_suffix(".dof").read_text().split()
    lower, upper = np.array([np.flatnonzero(np.array(dofs) == f"2.{k}") for k in (1, 2, 3)]).T
    change = np.eye(len(dofs))
    change[lower, lower], change[lower, upper] = 2.0, -1.0
    for ending in (".sti", ".mas"):
        row, column, value = np.loadtxt(TEE.with_suffix(ending)).T
        row, column = row.astype(int) - 1, column.astype(int) - 1
        matrix = np.zeros((len(dofs), len(dofs)))
        matrix[row, column] = matrix[column, row] = value
        matrix = change.T @ matrix @ change
        if ending == ".mas":
            matrix[lower, lower] += 0.5
        row, column = np.nonzero(np.triu(matrix))
        found = np.column_stack([row + 1, column + 1, matrix[row, column]])
        np.savetxt(tmp_path / f"tee{ending}", found, fmt="%d %d %.14g")
    for ending in (".dof", ".inp"):
        (tmp_path / f"tee{ending}").write_text(TEE.with_suffix(ending).read_text())
    data = read({"file": tmp_path / "tee.sti"})
    found = np.array([data.coordinates[data.place(part)] for part in data.parts(2)])
    np.testing.assert_allclose(found, [[0.1, 0, 0], [0.1, 0, 0.5 * THICKNESS]], atol=1e-8)
    root = JoinedPoint("root", (1, 4))
    heavier, light = (
        imported(file, points=(), rigid_elements=(root,)).model() for file in (tmp_path / "tee.sti", TEE)
    )
    assert heavier.mass == pytest.approx(light.mass + 0.5, rel=1e-9)
    moment = heavier.mass * heavier.center_of_mass - light.mass * light.center_of_mass
    np.testing.assert_allclose(moment, [0.05, 0, 0], atol=1e-8)


@pytest.mark.parametrize("offset", ["0.5", "-.5", "0.", "-0.0"])
def test_offsets_of_shells_are_refused(tmp_path, offset):
    """Mean places are those of nodes only without them."""
    deck = TEE.with_suffix(".inp").read_text().replace("=shell, MAT", f"=shell, OFFSET={offset}, MAT", 1)
    (tmp_path / "tee.inp").write_text(deck)
    if float(offset):
        with pytest.raises(ComponentError, match=r"tee\.inp: line \d+: .*OFFSET"):
            read_deck(tmp_path / "tee.inp")
    else:
        assert len(read_deck(tmp_path / "tee.inp")) == 9


def _bricks(count):
    """Bricks of 20 nodes in a row with reduced integration (2 x 2 x 2), of aluminium; Zienkiewicz and Taylor."""
    size = np.array([0.1, 0.04, 0.02])
    corners = np.array([at for at in product((-1, 0, 1), repeat=3) if np.count_nonzero(at) >= 2], dtype=float)

    def shapes(at):
        inside = np.prod(np.where(corners == 0.0, 1.0 - at**2, 0.5 * (1.0 + at * corners)), axis=1)
        corner = np.all(corners != 0.0, axis=1)
        return np.where(corner, inside * (corners @ at - 2.0), inside)

    lame, shear = 70e9 * 0.3 / (1.3 * 0.4), 70e9 / 2.6
    elastic = np.diag([2.0 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    stiffness, mass = np.zeros((60, 60)), np.zeros((60, 60))
    for at in product((-(3**-0.5), 3**-0.5), repeat=3):
        slopes = np.array([shapes(np.array(at) + 1e-30j * unit).imag / 1e-30 for unit in np.eye(3)])
        x, y, z = slopes * 2.0 / size[:, None]
        strain, none = np.zeros((6, 60)), np.zeros(20)
        for row, parts in enumerate(
            ([x, none, none], [none, y, none], [none, none, z], [y, x, none], [none, z, y], [z, none, x])
        ):
            strain[row] = np.ravel(parts, order="F")
        moved = np.kron(shapes(np.array(at)), np.eye(3))
        stiffness += np.prod(size / 2.0) * strain.T @ elastic @ strain
        mass += 2700.0 * np.prod(size / 2.0) * moved.T @ moved
    places = np.vstack([size * (0.5 * corners + [k + 0.5, 0.5, 0.5]) for k in range(count)])
    places, number = np.unique(np.round(places, 9), axis=0, return_inverse=True)
    rows = (3 * number.reshape(count, 20, 1) + np.arange(3)).reshape(count, 60)
    whole = np.zeros((2, 3 * len(places), 3 * len(places)))
    for own in rows:
        whole[:, own[:, None], own] += stiffness, mass
    nodes = np.arange(1, len(places) + 1)
    dofs = np.column_stack([np.repeat(nodes, 3), np.tile([1, 2, 3], len(nodes))])
    return FiniteElementData(*map(sparse.csr_array, whole), nodes, places, dofs)


def test_motions_without_stiffness_and_mass_are_kept_out_of_the_modes(tmp_path):
    """Against the eigenvalues in the complement of these motions, with a rigid root, to 1e-8 of springs and mass."""
    data = _bricks(3)
    assert np.sum(linalg.eigvalsh(data.stiffness.toarray()) < 1.0) == 6 + 4, (
        "rigid motions, and four that cost nothing"
    )
    write_npz(tmp_path / "bar.npz", data)
    root = data.nodes[data.coordinates[:, 0] == 0.0]
    body = imported(
        tmp_path / "bar.npz", points=(), rigid_elements=(JoinedPoint("root", tuple(root.tolist())),)
    )
    free = np.flatnonzero(~np.isin(data.dofs[:, 0], root))
    stiffness, mass = (matrix.toarray()[np.ix_(free, free)] for matrix in (data.stiffness, data.mass))
    values, vectors = linalg.eigh(stiffness / np.trace(stiffness) + mass / np.trace(mass))
    kept = vectors[:, values > 1e-12]
    # motions without mass but with stiffness have no frequency
    exact = 1.0 / linalg.eigh(kept.T @ mass @ kept, kept.T @ stiffness @ kept, eigvals_only=True)[::-1][:4]
    found = fixed_interface_frequencies(body.model(), ("root",), 4)
    np.testing.assert_allclose(found**2, exact, rtol=2e-5)
