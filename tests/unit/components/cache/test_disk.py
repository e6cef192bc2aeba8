"""The cache on disk: what it returns is what was computed, whatever happened to its files and folders."""

import hashlib
import os
import tempfile

import pytest

from components.cache import disk

KEY = hashlib.sha256(b"one").hexdigest()
OTHER = hashlib.sha256(b"other").hexdigest()


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """A cache folder that does not exist yet, and temporary files beside it."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("FANFOLD_CACHE", str(tmp_path / "deep" / "cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    return tmp_path / "deep" / "cache"


class Build:
    """Computes bytes and counts how often."""

    def __init__(self, content=b"bytes"):
        self.content, self.times = content, 0

    def __call__(self):
        self.times += 1
        return self.content


@pytest.mark.parametrize(
    ("environment", "folder"),
    [
        ({"FANFOLD_CACHE": "/a"}, "/a"),
        ({"FANFOLD_CACHE": "", "XDG_CACHE_HOME": "/b"}, "/b/fanfold"),
        ({"FANFOLD_CACHE": "", "XDG_CACHE_HOME": "", "HOME": "/c"}, "/c/.cache/fanfold"),
    ],
)
def test_folder(environment, folder, monkeypatch):
    """Bookkeeping: the order in which the environment is asked."""
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert str(disk.folder()) == folder


def test_computed_once_for_each_key():
    """Bookkeeping: a key is computed once, another key or group is another file."""
    build = Build()
    assert [disk.kept("a", KEY, build) for _ in range(3)] == [b"bytes"] * 3
    assert build.times == 1
    disk.kept("a", OTHER, build)
    disk.kept("b", KEY, build)
    assert build.times == 3


@pytest.mark.parametrize("flipped", [0, 31, 32, 36, None])
def test_any_damage_is_found(place, flipped):
    """Bookkeeping: one bit anywhere, or a missing end, and the file is computed and written again."""
    build = Build()
    disk.kept("a", KEY, build)
    (file,) = place.iterdir()
    sound = file.read_bytes()
    spoilt = bytearray(sound)
    if flipped is None:
        del spoilt[20:]
    else:
        spoilt[flipped] ^= 4
    file.write_bytes(spoilt)
    assert disk.kept("a", KEY, build) == b"bytes"
    assert (build.times, file.read_bytes()) == (2, sound)


def test_empty_content_is_content():
    """Bookkeeping: nothing at all, computed, is not the same as an empty file."""
    build = Build(b"")
    assert [disk.kept("a", KEY, build) for _ in range(2)] == [b"", b""]
    assert build.times == 1


def test_folder_that_cannot_be_written(place, tmp_path):
    """Bookkeeping: a folder of the user's own among temporary files takes its place, closed to others, and is told."""
    assert disk.unwritable_cache() == ""
    place.rmdir()
    place.write_text("a file, not a folder")
    build = Build()
    assert [disk.kept("a", KEY, build) for _ in range(2)] == [b"bytes"] * 2
    assert build.times == 1
    (own,) = (tmp_path / "tmp").iterdir()
    assert (disk.written_folder(), own.stat().st_mode & 0o777) == (own, 0o700)
    told = disk.unwritable_cache()
    assert all(named in told for named in (str(place), str(own), "FANFOLD_CACHE"))


@pytest.mark.parametrize("trap", ["open to others", "link", "file"])
def test_what_others_could_have_written_is_not_read(place, tmp_path, trap):
    """Safety: a temporary folder that others can write to is not used; everything is computed then."""
    place.parent.mkdir()
    place.write_text("")
    build = Build()
    disk.kept("a", KEY, build)
    (own,) = (tmp_path / "tmp").iterdir()
    if trap == "open to others":
        own.chmod(0o777)
    else:
        own.rename(tmp_path / "elsewhere")
        own.symlink_to(tmp_path / "elsewhere") if trap == "link" else own.write_text("")
    assert disk.kept("a", KEY, build) == b"bytes"
    assert (build.times, disk.written_folder()) == (2, None)
    told = disk.unwritable_cache()
    assert str(place) in told
    assert str(own) not in told


def test_growth_is_bounded(place, monkeypatch):
    """Bookkeeping: beyond the limit the least recently used go, others' files stay, and the newest is there."""
    monkeypatch.setattr(disk, "LIMIT", 2000)
    place.mkdir(parents=True)
    (place / "mine.txt").write_text("x" * 5000)
    keys = [hashlib.sha256(bytes([k])).hexdigest() for k in range(40)]
    for k, key in enumerate(keys):
        disk.kept("a", key, Build(b"x" * 68))
        os.utime(place / f"a-{key}", (k, k))
        if k:
            disk.kept("a", keys[0], Build(b"x" * 68))  # in use all the time
        assert sum(entry.size for entry in disk.entries(place)) <= 2000
    left = {entry.path.name for entry in disk.entries(place)}
    assert {f"a-{keys[0]}", f"a-{keys[39]}", f"a-{keys[35]}"} <= left
    assert f"a-{keys[1]}" not in left
    assert (place / "mine.txt").exists()


def test_clear_takes_its_own_files_only(place):
    """Bookkeeping: files and remains of interrupted writers go, everything else in the folder stays."""
    disk.kept("a", KEY, Build(b"123"))
    (place / f"a-{KEY}.tmpq1").write_text("half")
    (place / "thesis.tex").write_text("")
    assert {entry.size for entry in disk.clear(place)} == {35, 4}
    assert [path.name for path in place.iterdir()] == ["thesis.tex"]


def test_failed_write_leaves_nothing(tmp_path):
    """Bookkeeping: where the content cannot be put in place, no temporary file stays."""
    (tmp_path / "taken").mkdir()
    with pytest.raises(OSError, match="taken"):
        disk.replace_file(tmp_path / "taken", b"content")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["taken", "tmp"]
