"""Tables as spreadsheets and other programs write them: the same numbers, whatever separators and letters."""

import numpy as np
import pytest
from scipy import io, sparse

from components.contract.component import ComponentError
from components.imported.text.entries import read_columns
from tests.references.imports import matrix_writers as write
from tests.references.imports.frame_model import bar_frame, frame_data, imported

DATA = frame_data(bar_frame())
TABLE = [[1, 0, -0.25, 3], [12, 0.5, 1e-3, 0]]
WRITTEN = {
    "heading, tabs, decimal commas": "Node\tX (m)\tY (m)\tZ (m)\t\n1\t0\t-0,25\t3\t\n12\t0,5\t1,0E-03\t0\t\n",
    "semicolons, decimal commas": "1;0;-0,25;3\n12;0,5;0,001;0\n",
    "semicolons, points": "Nodes of panel 2\n;[m];[m];[m]\n1;0;-0.25;3;\n12;.5;1e-3;0;\n",
    "quotes": '"Node","X","Y","Z"\r\n"1","0","-0.25","3"\r\n"12","0.5","0.001","0"\r\n',
    "blanks, decimal commas": " 1  0   -0,25  3\n12  0,5  1,0e-3  0\n",
    "commas with blanks, Fortran": "1, 0, -2.5D-01, 3\n12, 5.d-1, 1.D-3, 0\n",
    "old Mac": "node x y z\r1 0 -0.25 3\r12 0.5 0.001 0\r",
}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
@pytest.mark.parametrize("way", WRITTEN)
def test_tables_are_the_numbers_that_were_written(tmp_path, way, encoding):
    path = tmp_path / "nodes.txt"
    path.write_bytes(("Größe\n" + WRITTEN[way]).encode(encoding))
    np.testing.assert_array_equal(read_columns(path), TABLE)


@pytest.mark.parametrize(
    "content", [b"1 0 0 0\n2 0 O.5 0\n", b"Node\n", b"1;0;0;0\n2;;0;0\n", b"\x00\x01 1 2"]
)
def test_damaged_tables_are_sentences(tmp_path, content):
    (tmp_path / "nodes.txt").write_bytes(content)
    with pytest.raises(ComponentError, match=r"nodes\.txt: "):
        read_columns(tmp_path / "nodes.txt")


@pytest.mark.parametrize("rows", ["matrix", "entries"])
def test_a_mapping_of_integers_names_the_node_of_every_six_rows(tmp_path, rows):
    """Matrix Market arrays of integers, as Ansys writes its mapping. Regression: the size was read as data."""
    order = np.arange(len(DATA.nodes))[::-1]
    places = np.ravel(6 * order[:, None] + np.arange(6))
    files = {"dofs": tmp_path / "map.mtx", "coordinates": write.columns(tmp_path, DATA)}
    io.mmwrite(files["dofs"], DATA.nodes[order][:, None])
    for name in ("stiffness", "mass"):
        matrix = sparse.coo_array(getattr(DATA, name).tocsr()[places][:, places])
        files[name] = tmp_path / f"{name}.mtx"
        if rows == "matrix":
            io.mmwrite(files[name], matrix, precision=17)
        else:
            np.savetxt(files[name], np.column_stack([matrix.row + 1, matrix.col + 1, matrix.data]))
    model = imported(files).model()
    assert model.mass == pytest.approx(bar_frame().mass, rel=1e-12)
    np.testing.assert_allclose(model.center_of_mass, bar_frame().center_of_mass, atol=1e-12)
