"""Disks that a result is not going to fit on are told of while the run goes."""

from shutil import disk_usage

import pytest

import orchestrator as fanfold
from orchestrator.messages import code_of
from orchestrator.run import free_space
from orchestrator.run.free_space import FreeSpace

CHUNK = 1_000_000


@pytest.fixture
def disk(monkeypatch):
    """Sets the bytes that are free, on a disk that every step looks at."""
    monkeypatch.setattr(free_space, "_SECONDS", 0.0)

    def has(free):
        usage = disk_usage("/")._replace(free=free)
        monkeypatch.setattr(free_space.shutil, "disk_usage", lambda folder: usage)

    return has


@pytest.mark.parametrize(("free", "told"), [(8.4e6, 0), (7.4e6, 1)])
def test_what_the_rest_of_a_run_takes_is_foretold(tmp_path, disk, free, told):
    """Closed form: a chunk each second, looked at when the second is written, of ten leaves eight to come."""
    path, sentences, shown = tmp_path / "result.h5", [], []
    watch = FreeSpace(path, 10.0, sentences.append, lambda time, h: shown.append(time))
    disk(free)
    for time in (0.5, 1.0, 1.5, 2.0):
        path.write_bytes(bytes(CHUNK * int(time)))
        watch(time, 0.5)
    assert len(sentences) == told
    assert shown == [0.5, 1.0, 1.5, 2.0]
    if told:
        assert code_of(sentences[0]) == "W-disk"
        assert all(part in sentences[0] for part in ("t = 2 s", "7.4 MB", "8 MB"))


def test_a_pace_is_not_taken_from_the_first_instants(tmp_path, disk):
    """A thousand steps right after release say nothing of the minutes that follow."""
    path, sentences = tmp_path / "result.h5", []
    watch = FreeSpace(path, 100.0, sentences.append, lambda time, h: None)
    disk(1.0)
    for count in range(1, 4):
        path.write_bytes(bytes(CHUNK * count))
        watch(0.1 * count, 0.1)
    assert sentences == []


def test_a_run_tells_once(tmp_path, disk, monkeypatch):
    disk(1.0)
    monkeypatch.setattr("orchestrator.results.result_file._ROWS", 20)
    with pytest.warns(fanfold.FanfoldWarning) as told:
        fanfold.simulate("workbench", until=2.0, save=tmp_path / "result.h5", estimate=False)
    found = [str(one.message) for one in told if "MB free" in str(one.message)]
    assert len(found) == 1
    assert str(tmp_path / "result.h5") in found[0]


@pytest.mark.parametrize(("seconds", "told"), [(5000.0, []), (5002.0, ["5 GB by 5002 s"])])
def test_a_large_result_is_told_of_once(tmp_path, disk, monkeypatch, seconds, told):
    """Closed form: a megabyte a second comes to five gigabytes after 5,000 s."""
    monkeypatch.setattr(free_space, "_SHORTEST", 0.0)
    path, sentences = tmp_path / "result.h5", []
    watch = FreeSpace(path, seconds, sentences.append, lambda time, h: None)
    disk(1e12)
    for time in (1.0, 2.0, 3.0, 4.0):
        path.write_bytes(bytes(CHUNK * int(time)))
        watch(time, 1.0)
    assert len(sentences) == len(told)
    for part, sentence in zip(told, sentences, strict=True):
        assert part in sentence
