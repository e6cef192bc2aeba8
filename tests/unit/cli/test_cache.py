"""The cache as a user meets it: told, cleared, damaged, or in a place that cannot be written to."""

import tempfile

import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.cli.main import main


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("FANFOLD_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1794880800")
    return tmp_path / "cache"


def exported(folder):
    return {path.name: path.read_bytes() for path in fanfold.export("workbench", folder, rigid="all")}


def told(*arguments, exit_code=0):
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == exit_code, result.output
    return result


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param("empty", marks=pytest.mark.thorough),
        pytest.param("cut", marks=pytest.mark.thorough),
        "one bit",
    ],
)
def test_no_damaged_file_of_the_cache_is_exported(damage, cache, tmp_path):
    """R1: whatever file of the cache is damaged, what is exported is what was, and the cache is whole again."""
    sound = exported(tmp_path / "first")
    files = [path for path in cache.rglob("*") if path.is_file()]
    assert files
    for path in files:
        content = path.read_bytes()
        middle = len(content) // 2
        flipped = content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]
        path.write_bytes({"empty": b"", "cut": content[:middle], "one bit": flipped}[damage])
    fanfold.load("workbench").check()
    assert exported(tmp_path / "second") == sound
    assert exported(tmp_path / "third") == sound


def test_place_and_size_are_told(cache):
    """Bookkeeping: the command counts what is there, and clears it."""
    assert told("cache").stdout == f"{cache}: 0 files, 0.0 MB of 500 MB at most\n"
    exported("out")
    found = fanfold.cache()
    size = sum(path.stat().st_size for path in cache.iterdir())
    assert (found.folder, found.files, found.size) == (cache, len(list(cache.iterdir())), size)
    assert told("cache", "--clear").stdout == f"{cache}: {found.files} files, {size / 1e6:.1f} MB removed\n"
    assert list(cache.iterdir()) == []


def test_start_values_add_nothing(cache):
    """Bookkeeping: values of a study's parameters do not let the cache grow."""
    scene = fanfold.load("workbench")
    sizes = set()
    for friction in (0.1, 0.2, 0.3):
        fanfold.export(scene.with_settings({"friction.coefficient": friction}), "out", rigid="all")
        sizes.add((fanfold.cache().files, fanfold.cache().size))
    assert len(sizes) == 1


def test_place_that_cannot_be_written(cache, tmp_path, monkeypatch):
    """Bookkeeping: the run goes on among temporary files, and says so once with the way out."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    cache.write_text("")
    run = told("run", "workbench", "--rigid", "all", "--until", "0.02", "--no-estimate", exit_code=3)
    assert (run.stderr.count("[W-cache]"), run.stderr.count(str(cache))) == (1, 1)
    assert f"{tmp_path / 'tmp'}" in run.stderr
    assert f"{tmp_path / 'tmp'}" in told("cache").stderr
