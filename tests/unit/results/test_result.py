"""Results: what is written can be read back, an interrupted run too, and errors are sentences."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from orchestrator.assembly import Geometry, HingeLine
from orchestrator.results.recorder import SignalGroup
from orchestrator.results.result import Result, ResultError
from orchestrator.results.result_file import ResultWriter
from orchestrator.results.signal import Signal
from tests.references import synthetic_result as reference

GROUPS = (
    SignalGroup("panel", ("pose", "energy"), ("m", "J"), (3, 1), ("Where it is", "What it has")),
    SignalGroup("hinge", ("angle",), ("rad",), (1,), ("How far it is open",)),
)
LINES = (HingeLine("hl1", ("hinge",), "hinge", True, False),)

RUNNING = """
import sys
import numpy as np
from orchestrator.results.recorder import SignalGroup
from orchestrator.results.result_file import ResultWriter
names = tuple(f"v{k}" for k in range(8))
groups = [SignalGroup(f"c{k}", names, ("1",) * 8, (1,) * 8, names) for k in range(12)]
writer = ResultWriter(sys.argv[1], groups, {"scene": "text"}, {}, [])
for k in range(10**9):
    writer.append(0.5 * k, [np.full(8, float(k + i)) for i in range(12)])
    if k == 100:
        writer.event(50.0, "hl1", "latch-up")
    if k == 2000:
        print("running", flush=True)
"""


def write(path, rows=450):
    geometry = {"panel": Geometry(np.eye(3), np.ones((3, 3, 2)), [[0, 1, 2, 2]])}
    with ResultWriter(path, GROUPS, {"scene": "a = 1\nµ = 2"}, geometry, LINES) as writer:
        for k in range(rows):
            writer.append(0.1 * k, [np.arange(4.0) + k, np.array([-1.0 * k])])
        writer.event(1.5, "hinge", "latch-up at 90°")
        writer.statistics({"steps": rows, "seconds": 2.5, "coupling": "newton"})
    return path


@pytest.fixture
def result(tmp_path):
    return Result.open(write(tmp_path / "run.h5"))


def test_signals_come_back_in_shape_and_order(result):
    k = np.arange(450.0)
    assert result.components == ("panel", "hinge")
    assert result.variables("panel") == ("pose", "energy")
    np.testing.assert_array_equal(result.time, 0.1 * k)
    np.testing.assert_array_equal(result.signal("panel", "pose"), k[:, None] + np.arange(3.0))
    np.testing.assert_array_equal(result.signal("panel", "energy"), k + 3.0)
    np.testing.assert_array_equal(result.signal("hinge", "angle"), -k)


def test_units_and_descriptions(result):
    assert result.unit("panel", "energy") == "J"
    assert result.description("hinge", "angle").startswith("How far")
    assert result.recording("angle") == ("hinge",)
    assert result.has("panel", "pose")
    assert not result.has("wing", "pose")


def test_everything_around_the_signals(result):
    assert result.complete
    assert result.events == [(1.5, "hinge", "latch-up at 90°")]
    assert result.statistics == {"steps": 450, "seconds": 2.5, "coupling": "newton"}
    assert result.provenance == {"scene": "a = 1\nµ = 2"}
    assert result.hinge_lines == LINES
    np.testing.assert_array_equal(result.geometry["panel"].shapes, np.ones((3, 3, 2)))
    np.testing.assert_array_equal(result.geometry["panel"].faces, [[0, 1, 2, 2]])


def test_layout_of_the_file(tmp_path):
    with h5py.File(write(tmp_path / "run.h5")) as file:
        assert file["time"].attrs["unit"] == "s"
        assert file["signals/panel/pose"].shape == (450, 3)
        assert file["signals/hinge/angle"].attrs["unit"] == "rad"
        assert {file["events"][name].shape for name in ("time", "component", "event")} == {(1,)}
        assert file["events/event"].asstr()[0] == "latch-up at 90°"


@pytest.mark.parametrize("rows", [1, 199, 200, 201])
def test_any_number_of_rows(tmp_path, rows):
    result = Result.open(write(tmp_path / "run.h5", rows))
    assert result.time.size == rows
    assert result.signal("hinge", "angle")[-1] == -(rows - 1.0)


def test_long_event_text_is_cut_between_characters(tmp_path):
    with ResultWriter(tmp_path / "run.h5", GROUPS, {}, {}, ()) as writer:
        writer.append(0.0, [np.zeros(4), np.zeros(1)])
        writer.event(0.0, "hinge", "a" + "é" * 200)
    assert Result.open(tmp_path / "run.h5").events[0][2] == "a" + "é" * 127


def test_run_that_fails_leaves_an_incomplete_result(tmp_path):
    def run():
        with ResultWriter(tmp_path / "run.h5", GROUPS, {}, {}, ()) as writer:
            writer.append(0.0, [np.zeros(4), np.zeros(1)])
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run()
    result = Result.open(tmp_path / "run.h5")
    assert not result.complete
    assert result.time.size == 1


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs kill -9")
def test_killed_run_is_readable_up_to_the_last_flush(tmp_path):
    path = tmp_path / "run.h5"
    root = Path(__file__).parents[3]
    with subprocess.Popen(
        [sys.executable, "-c", RUNNING, str(path)], cwd=root, stdout=subprocess.PIPE, text=True
    ) as run:
        assert run.stdout.readline() == "running\n"
        run.send_signal(signal.SIGKILL)
    result = Result.open(path)
    assert not result.complete
    assert result.time.size >= 2000
    assert result.events == [(50.0, "hl1", "latch-up")]
    k = np.arange(result.time.size)
    np.testing.assert_array_equal(result.time, 0.5 * k)
    for i, name in enumerate(f"c{i}" for i in range(12)):
        np.testing.assert_array_equal(result.signal(name, "v7"), k + i)


def test_second_run_to_the_same_file_is_refused(tmp_path):
    """Bad input: the run that came first goes on; when it is done, or was killed, its place can be taken."""
    path = tmp_path / "run.h5"
    first = ResultWriter(path, GROUPS, {}, {}, ())
    assert "is writing" in message(write, path)
    first.append(0.0, [np.zeros(4), np.zeros(1)])
    first.close()
    assert Result.open(path).time.size == 1
    assert Result.open(write(path)).time.size == 450
    assert [found.name for found in tmp_path.iterdir()] == ["run.h5"]


def test_result_that_is_replaced_is_told_of(tmp_path):
    """Bad input: another file takes the place of the one that is being written."""
    path = tmp_path / "run.h5"
    writer = ResultWriter(path, GROUPS, {}, {}, ())
    write(tmp_path / "other.h5").replace(path)
    assert "or replaced" in message(writer.flush)
    assert Result.open(path).time.size == 450


def test_a_file_of_that_name_is_always_readable(tmp_path, monkeypatch):
    """Whatever stops the writing before its first row, there is no file, or one that HDF5 reads."""
    path = tmp_path / "run.h5"

    def stop(*_):
        assert not path.exists()
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("orchestrator.results.result_file._write_geometry", stop)
        with pytest.raises(KeyboardInterrupt):
            ResultWriter(path, GROUPS, {}, {}, ())
    assert list(tmp_path.iterdir()) == []
    writer = ResultWriter(path, GROUPS, {}, {}, ())
    copy = tmp_path / "copy.h5"
    copy.write_bytes(path.read_bytes())
    with h5py.File(copy, "r") as file:
        assert file["time"].shape == (0,)
    writer.close()


def test_rows_are_written_though_no_other_comes(tmp_path):
    """Time: rows of a run that stands still in a long step reach the disk."""
    path, copy = tmp_path / "run.h5", tmp_path / "copy.h5"
    with ResultWriter(path, GROUPS, {}, {}, ()) as writer:
        for k in range(5):
            writer.append(0.1 * k, [np.zeros(4), np.zeros(1)])
        deadline = time.monotonic() + 30.0
        rows = 0
        while rows < 5 and time.monotonic() < deadline:
            time.sleep(0.1)
            copy.write_bytes(path.read_bytes())
            rows = Result.open(copy).time.size
    assert rows == 5


def test_failure_of_a_flush_by_time_is_told(tmp_path):
    """Nothing silent: rows that cannot be written end the run with the next one."""
    path = tmp_path / "run.h5"

    def run():
        with ResultWriter(path, GROUPS, {}, {}, ()) as writer:
            writer.append(0.0, [np.zeros(4), np.zeros(1)])
            path.unlink()
            deadline = time.monotonic() + 30.0
            while time.monotonic() < deadline:
                time.sleep(0.05)
                writer.append(time.monotonic(), [np.zeros(4), np.zeros(1)])

    assert "or replaced" in message(run)


def test_large_results_are_compressed_without_loss(tmp_path, monkeypatch):
    """Independent path: signals, attributes and order as they were written; smooth ones take half the space."""
    monkeypatch.setattr("orchestrator.results.compact.SMALLEST", 1)
    path, rows = tmp_path / "run.h5", 30_000
    when = np.linspace(0.0, 30.0, rows)
    waves = np.column_stack([np.exp(-k * when) * np.sin((k + 1.0) * when) for k in range(4)] + [when])
    with ResultWriter(path, GROUPS, {"scene": "x"}, {}, LINES) as writer:
        for t, row in zip(when.tolist(), waves, strict=True):
            writer.append(t, [row])
        writer.flush()
        written = path.stat().st_size
    result = Result.open(path)
    assert path.stat().st_size < 0.75 * written
    np.testing.assert_array_equal(result.time, when)
    np.testing.assert_array_equal(result.signal("panel", "pose"), waves[:, :3])
    np.testing.assert_array_equal(result.signal("hinge", "angle"), waves[:, 4])
    assert result.variables("panel") == ("pose", "energy")
    assert result.components == ("panel", "hinge")
    assert result.description("hinge", "angle").startswith("How far")
    assert result.provenance == {"scene": "x"}
    assert result.complete
    assert [found.name for found in tmp_path.iterdir()] == ["run.h5"]


def test_result_that_there_is_no_room_to_compress_stays(tmp_path, monkeypatch):
    """Full disk: compression needs room for both; without, the result stays as it was written."""
    monkeypatch.setattr("orchestrator.results.compact.SMALLEST", 1)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("orchestrator.results.compact._copy_rows", full)
    assert Result.open(write(tmp_path / "run.h5")).complete
    assert [found.name for found in tmp_path.iterdir()] == ["run.h5"]


@pytest.fixture
def size_limit():
    """Sets how many bytes a file may have, as quotas do, until the test ends."""
    resource = pytest.importorskip("resource")
    usual, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    yield lambda size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    resource.setrlimit(resource.RLIMIT_FSIZE, (usual, hard))


@pytest.mark.parametrize("room", [0, 140_000, 340_000, 540_000])
def test_file_that_may_grow_no_further_keeps_its_rows(tmp_path, size_limit, room):
    """Independent path: the rows that were handed over; a quota is met at any point of a chunk.

    Rows of the first chunk have room before any is made. Regression: a run kept none, or lost those of its last second.
    """
    path, names = tmp_path / "run.h5", tuple("abcdefgh")
    groups = [SignalGroup(f"c{k}", names, ("1",) * 8, (1,) * 8, ("",) * 8) for k in range(3)]
    writer = ResultWriter(path, groups, {}, {}, ())
    size_limit(path.stat().st_size + room)
    writer.event(0.0, "hl1", "latch-up")

    def fill():
        with writer:
            for k in range(20_000):
                handed[0] = k + 1
                writer.append(float(k), [np.full(8, float(k + g)) for g in range(3)])

    handed = [0]
    with pytest.raises(ResultError) as caught:
        fill()
    assert "(File " in str(caught.value)
    result = Result.open(path)
    assert result.time.size == 1000 * (1 + room // 250_000) == handed[0]
    assert f"t = {result.time[-1]:.6g} s" in str(caught.value)
    assert not result.complete
    assert result.events == [(0.0, "hl1", "latch-up")]
    np.testing.assert_array_equal(result.time, np.arange(result.time.size))
    for g in range(3):
        for name in names:
            np.testing.assert_array_equal(result.signal(f"c{g}", name), result.time + g)


def test_a_run_whose_first_rows_have_no_room_does_not_begin(tmp_path, monkeypatch):
    """Full disk: an error before the first step, and an earlier result stays in every byte."""
    path = write(tmp_path / "run.h5")
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("orchestrator.results.result_file.reserve", full)
    assert "(No space " in message(ResultWriter, path, GROUPS, {}, {}, ())
    assert path.read_bytes() == before
    assert [found.name for found in tmp_path.iterdir()] == ["run.h5"]


def test_a_disk_that_fills_within_a_second_takes_no_row(tmp_path, monkeypatch):
    """Full disk: its first thousand rows had their room; what is handed over then is refused at once."""
    path, handed = tmp_path / "run.h5", []

    def full(*_):
        raise OSError(28, "No space left on device")

    def fill():
        with ResultWriter(path, GROUPS, {}, {}, ()) as writer:
            monkeypatch.setattr("orchestrator.results.result_file.reserve", full)
            while True:
                handed.append(float(len(handed)))
                writer.append(handed[-1], [np.zeros(4), np.zeros(1)])

    assert "t = 999 s" in message(fill)
    assert Result.open(path).time.tolist() == handed


def test_nothing_of_what_is_reserved_stays(tmp_path):
    path = write(tmp_path / "run.h5")
    with h5py.File(path) as file:
        assert path.stat().st_size == file.id.get_filesize()
        assert file.id.get_freespace() < path.stat().st_size / 2


def test_appending_is_cheap(tmp_path):
    groups = [SignalGroup(f"c{k}", tuple("abcdefgh"), ("1",) * 8, (1,) * 8, ("",) * 8) for k in range(12)]
    values = [np.zeros(8) for _ in groups]
    with ResultWriter(tmp_path / "run.h5", groups, {}, {}, ()) as writer:
        costs = []
        for _ in range(5):
            start = time.process_time()
            for k in range(1000):
                writer.append(float(k), values)
            costs.append((time.process_time() - start) / 1000)
    assert min(costs) < 30e-6  # 8e-6 on an idle machine


def message(function, *arguments):
    with pytest.raises(ResultError) as caught:
        function(*arguments)
    text = str(caught.value)
    assert "\n" not in text
    return text


def test_unknown_names_are_answered_with_the_known_ones(result):
    assert "panel, hinge" in message(result.signal, "wing", "angle")
    assert "angle" in message(result.unit, "hinge", "tension")


def test_files_that_are_no_results(tmp_path):
    assert "none.h5" in message(Result.open, tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("time,angle\n")
    assert "text.h5" in message(Result.open, tmp_path / "text.h5")
    h5py.File(tmp_path / "other.h5", "w").close()
    assert "other.h5" in message(Result.open, tmp_path / "other.h5")


def test_truncated_file(tmp_path):
    path = write(tmp_path / "run.h5")
    path.write_bytes(path.read_bytes()[:-2000])
    assert "truncated" in message(Result.open, path)


def test_damaged_file(tmp_path):
    path = write(tmp_path / "run.h5")
    with h5py.File(path, "r+") as file:
        del file["events"]
    assert "damaged" in message(Result.open, path)


def test_result_without_rows(tmp_path):
    ResultWriter(tmp_path / "run.h5", GROUPS, {}, {}, ()).close()
    assert "communication" in message(Result.open, tmp_path / "run.h5")


def test_place_that_cannot_be_written_to(tmp_path):
    arguments = (tmp_path / "none" / "run.h5", GROUPS, {}, {}, ())
    assert "none" in message(ResultWriter, *arguments)


def test_synthetic_deployment_writes_every_signal(tmp_path):
    time, signals = reference.signals()
    result = Result.open(reference.write(tmp_path / "run.h5"))
    np.testing.assert_array_equal(result.time, time)
    for name, variables in signals.items():
        for variable, (unit, values) in variables.items():
            assert result.unit(name, variable) == unit
            np.testing.assert_array_equal(result.signal(name, variable), values)


def test_devices_and_pipes_are_no_results(tmp_path):
    """Bad input: what is there and is no file stays what it is."""
    pipe = tmp_path / "pipe.h5"
    os.mkfifo(pipe)
    with pytest.raises(ResultError, match=r"pipe\.h5"):
        ResultWriter(pipe, GROUPS, {}, {}, ())
    assert pipe.is_fifo()


def test_a_link_is_written_through(tmp_path):
    """The file that a symbolic link points to holds the result."""
    link, target = tmp_path / "link.h5", tmp_path / "target.h5"
    link.symlink_to(target)
    with ResultWriter(link, GROUPS, {}, {}, ()) as writer:
        writer.append(0.0, [np.zeros(4), np.zeros(1)])
    assert link.is_symlink()
    assert Result.open(target).complete


def test_result_that_is_taken_away_is_told_of(tmp_path):
    """Bad input: the folder is deleted in the middle of a run, which must not go on into nothing."""
    folder = tmp_path / "runs"
    folder.mkdir()
    writer = ResultWriter(folder / "run.h5", GROUPS, {}, {}, ())
    writer.append(0.0, [np.zeros(4), np.zeros(1)])
    (folder / "run.h5").unlink()
    folder.rmdir()
    assert "or replaced" in message(writer.flush)
    assert "or replaced" in message(writer.close)
    assert not folder.exists()


@pytest.mark.parametrize("rows", [50, 5000])
def test_a_result_replaced_since_it_was_opened_is_told(tmp_path, rows):
    """Tried by a stranger: a reader met the rows of another run, and said that its result was damaged."""
    opened = Result.open(reference.write(tmp_path / "run.h5"))
    other = reference.write(tmp_path / "other.h5")
    with h5py.File(other, "r+") as file:
        stretched = np.linspace(0.0, 3.0, rows)
        for dataset in [file["time"], *(d for group in file["signals"].values() for d in group.values())]:
            dataset.resize(rows, 0)
        file["time"][:] = stretched
    os.replace(other, opened.path)
    with pytest.raises(ResultError, match="another result"):
        opened.signal("base", "interface_force")


def test_a_flag_is_that_of_the_row_before():
    """Rule: a contact is open or closed; half way between two rows it is not half of both."""
    times = np.array([0.0, 1.0, 2.0])
    flag = Signal(np.array([0.0, 1.0, 1.0]), times, "1", "pad.in_contact")
    assert flag.at([0.0, 0.5, 1.0, 1.5]).tolist() == [0.0, 0.0, 1.0, 1.0]
    assert Signal(np.array([0.0, 1.0, 1.5]), times, "m", "pad.gap").at(0.5) == 0.5
