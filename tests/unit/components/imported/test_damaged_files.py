"""Files of finite elements that are damaged, or made to do harm: sentences, and no memory for what is not there."""

import tracemalloc
import zipfile
from io import BytesIO

import numpy as np
import pytest

from components.contract.component import ComponentError
from components.imported import opening
from components.imported.matrices import to_matrices
from components.imported.reading import read
from components.imported.text.decks import read_deck
from tests.references.archives import mark_encrypted
from tests.references.imports.frame_model import bar_frame, frame_data, imported

DATA = frame_data(bar_frame())


def stored(path, **changes):
    """An npz file with arrays, or bytes in the place of some."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in (to_matrices(DATA) | changes).items():
            if not isinstance(array, bytes):
                buffer = BytesIO()
                np.lib.format.write_array(buffer, np.asarray(array), allow_pickle=True)
                array = buffer.getvalue()
            archive.writestr(f"{name}.npy", array)
    return {"file": str(path)}


def array_bytes(header):
    """An array of a header alone."""
    text = header.ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def encrypted(path):
    files = stored(path)
    mark_encrypted(path)
    return files


def bare_array(path):
    with path.open("wb") as file:
        np.save(file, np.eye(3))
    return {"file": str(path)}


def as_text(path, text):
    path.write_text(text)
    nodes = path.with_name("nodes.csv")
    nodes.write_text("1,0,0,0\n")
    return {"stiffness": str(path), "mass": str(path), "coordinates": str(nodes)}


def announced(header, size):
    return lambda path: as_text(path, f"%%MatrixMarket matrix {header} real general\n{size}\n1 1 1.0\n")


TINY = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {(10**12, 4)}, }}"
DAMAGED = {
    "encrypted": encrypted,
    "header of brackets": lambda path: stored(path, mass=array_bytes("(((")),
    "header cut off": lambda path: stored(path, mass=array_bytes(TINY)[:40]),
    "more announced than there is": lambda path: stored(path, mass=array_bytes(TINY)),
    "objects": lambda path: stored(path, mass=np.array([{}])),
    "no archive": bare_array,
    "stiffness of 1e308": lambda path: stored(path, stiffness=np.full((72, 72), 1e308)),
    "mass of 1e308": lambda path: stored(path, mass=np.full((72, 72), 1e308)),
    "mass of 1e300": lambda path: stored(path, mass=np.full((72, 72), 1e300)),
    "1e12 entries": announced("coordinate", "10 10 1000000000000"),
    "dense and large": announced("array", "100000 100000"),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_damaged_matrices_are_sentences(tmp_path, damage):
    """Reproductions, each of which was a traceback, all memory, or a body of 7.6 kg."""
    with pytest.raises(ComponentError, match=r"\w{3}.* \w"):
        imported(DAMAGED[damage](tmp_path / "body.npz")).model()


@pytest.mark.parametrize("key", ["file", "stiffness"])
@pytest.mark.parametrize("ending", [".npz", ".mtx", ".inp", ".op4", ""])
def test_a_device_is_no_file(tmp_path, key, ending):
    """Reproduction: /dev/zero by another name was read to the end of the memory."""
    path = tmp_path / f"zero{ending}"
    path.symlink_to("/dev/zero")
    with pytest.raises(ComponentError, match="no file"):
        read({key: path})


def test_members_that_nobody_asks_for_are_not_read(tmp_path):
    """Memory: 100 MB of zeros beside a frame whose matrices have 0.1 MB."""
    files = stored(tmp_path / "body.npz", bomb=np.zeros(12_500_000))
    tracemalloc.start()
    imported(files).data()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 50e6


def test_matrices_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(opening, "LARGEST", 1000)
    with pytest.raises(ComponentError, match="MB"):
        imported(stored(tmp_path / "body.npz")).data()


def test_decks_include_files_by_their_paths(tmp_path):
    """A folder, a parent and an absolute path; a file that is included again is read once, as nodes stand once."""
    (tmp_path / "mesh").mkdir()
    (tmp_path / "mesh" / "a.inp").write_text("*NODE\n1,0,0,0\n*INCLUDE, INPUT=../b.inp\n")
    (tmp_path / "b.inp").write_text("*NODE\n2,1,0,0\n")
    path = tmp_path / "s.inp"
    path.write_text(f"*INCLUDE, INPUT=mesh/a.inp\n*INCLUDE, INPUT={tmp_path}/b.inp\n*NODE\n3,0,1,0\n")
    np.testing.assert_array_equal(read_deck(path), [[1, 0, 0, 0], [2, 1, 0, 0], [3, 0, 1, 0]])


@pytest.mark.parametrize("name", ["mesh/none.inp", "../none.inp", "/none.inp", "", ".", "a\0b", "/dev/zero"])
def test_includes_that_are_no_files_are_sentences(tmp_path, name):
    """Reproduction: tracebacks of pathlib. What a body is read from is listed without them."""
    path = tmp_path / "s.inp"
    path.write_text(f"*INCLUDE, INPUT={name}\n*NODE\n1,0,0,0\n")
    if name:
        with pytest.raises(ComponentError):
            read_deck(path)
    else:
        assert len(read_deck(path)) == 1  # nothing is included
    files = as_text(tmp_path / "k.csv", "1\n") | {"coordinates": str(path)}
    with pytest.raises(ComponentError):
        imported(files).data()


def test_many_includes_end(tmp_path):
    """Reproductions: thirty files of two includes each are 2^30 readings; 1500 nested ones were a RecursionError."""
    for k in range(30):
        (tmp_path / f"t{k}.inp").write_text(2 * f"*INCLUDE, INPUT=t{k + 1}.inp\n")
    (tmp_path / "t30.inp").write_text("*NODE\n1,0,0,0\n")
    assert len(read_deck(tmp_path / "t0.inp")) == 1
    for k in range(1500):
        (tmp_path / f"n{k}.inp").write_text(f"*INCLUDE, INPUT=n{k + 1}.inp\n")
    (tmp_path / "n1500.inp").write_text("*NODE\n1,0,0,0\n")
    assert len(read_deck(tmp_path / "n0.inp")) == 1
