"""Entries in any order, in npz files too, and what decks say of where nodes are."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from components.contract.component import ComponentError
from components.flexible.finite_elements import OutputRows
from components.imported.matrices import to_matrices
from components.imported.reading import read
from tests.references.imports import matrix_writers as write
from tests.references.imports.frame_model import bar_frame, frame_data, imported

DATA = frame_data(bar_frame())


def test_a_triangle_in_the_order_of_the_deck(tmp_path):
    """Each entry once, by the order of nodes in a deck that counts down: both triangles of sorted nodes have some."""
    files = write.entries_by_node(tmp_path, DATA)
    for name in ("stiffness", "mass"):
        rows = [line.split(",") for line in files[name].read_text().splitlines() if line[:1].isdigit()]
        turned = [(*words[2:4], *words[0:2], words[4]) if k % 2 else words for k, words in enumerate(rows)]
        files[name].write_text("\n".join(",".join(words) for words in turned))
    found = imported(files).data()
    for name in ("stiffness", "mass"):
        one, other = getattr(found, name), getattr(DATA, name)
        assert abs(one - other).max() <= 1e-12 * abs(other).max()


@pytest.mark.parametrize("dofs", [True, False])
@pytest.mark.parametrize("labels", [True, False])
def test_entries_of_outputs_in_npz_are_the_rows_themselves(tmp_path, dofs, labels):
    """One force, of the first node alone: as many columns as the model has, one row."""
    row = np.zeros((1, len(DATA.dofs)))
    along = DATA.coordinates[1] - DATA.coordinates[0]
    row[0, 0:3], row[0, 6:9] = -along, along
    data = replace(DATA, outputs=OutputRows(("bar",), ("N",), row))
    stored = to_matrices(data)
    for name in ("stiffness", "mass", "force"):
        entries = sparse.coo_array(stored.pop(name))
        stored[f"{name}_entries"] = np.column_stack([entries.row + 1, entries.col + 1, entries.data])
    if not dofs:
        del stored["dofs"]
    if labels:
        stored["force_labels"] = np.array(["bar"])
    np.savez(tmp_path / "frame.npz", **stored)
    found = imported(tmp_path / "frame.npz").data().outputs
    assert found.labels == ("bar" if labels else "force 1",)
    np.testing.assert_array_equal(found.rows, row)


def test_decks_of_parts_and_instances_are_refused(tmp_path):
    """The line behind *INSTANCE moves all its nodes; K and M do not tell."""
    files = write.entries_by_node(tmp_path, DATA)
    with files["coordinates"].open("a") as deck:
        deck.write("*Instance, name=wing-1, part=wing\n0., 10., 0.\n*End Instance\n")
    with pytest.raises(ComponentError, match=r"job\.inp: line \d+: \*Instance"):
        imported(files).data()


@pytest.mark.parametrize(
    ("card", "refused"), [("GRDSET,,,,,,5\n", True), ("GRDSET,,5\n", True), ("GRDSET,,,,,,,6\n", False)]
)
def test_axes_that_grids_have_by_default_are_refused(tmp_path, card, refused):
    """Bulk data: GRDSET gives CP and CD to every GRID without; pyYeti passes it by. Constraints (PS) are no axes."""
    path = write.dmig(tmp_path / "job.pch", DATA)
    path.write_text(card + path.read_text())
    if refused:
        with pytest.raises(ComponentError, match=r"job\.pch: GRDSET"):
            imported(path).data()
    else:
        imported(path).data()


def test_entries_of_tables_are_as_wide_as_these(tmp_path):
    """Places of masses have three columns, of whatever model. Regression: they got as many as it has rows."""
    stored = to_matrices(DATA)
    del stored["dofs"]
    stored |= {"sample_masses": np.ones(2), "sample_displacement": np.zeros((6, len(DATA.dofs)))}
    stored["sample_positions_entries"] = np.array([[1, 1, 0.5], [2, 3, 0.25]])
    np.savez(tmp_path / "frame.npz", **stored)
    np.testing.assert_array_equal(
        read({"file": tmp_path / "frame.npz"}).samples.positions, [[0.5, 0, 0], [0, 0, 0.25]]
    )
