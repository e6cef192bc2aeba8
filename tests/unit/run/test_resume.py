"""Runs that go on from a checkpoint: in every bit as without the interruption, or a sentence why they cannot."""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.results.recorder import SignalGroup
from orchestrator.results.result import Result
from orchestrator.results.result_file import ResultWriter
from orchestrator.run.checkpoint import Checkpoint, checkpoint_file
from orchestrator.run.run import RunError

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.*W-no-end"),  # nothing stops it
]
TWO_PANELS = Path(__file__).parents[2] / "scenes" / "two_panels.toml"


def copies_of_checkpoints(patch, folder):
    """Pairs of a result and its checkpoint, as they were whenever a checkpoint had been written."""
    found = []
    write = Checkpoint.write

    def and_copy(self, result):
        write(self, result)
        copy = folder / f"cut{len(found)}.h5"
        shutil.copy(result, copy)
        shutil.copy(checkpoint_file(result), checkpoint_file(copy))
        found.append(copy)

    patch.setattr(Checkpoint, "write", and_copy)
    return found


@pytest.fixture
def interruptions(monkeypatch, tmp_path):
    return copies_of_checkpoints(monkeypatch, tmp_path)


def assert_same_bits(one, other):
    """Times, signals, events and estimated errors of two results; the first may be open."""
    a, b = one if isinstance(one, Result) else Result.open(one), Result.open(other)
    assert a.complete
    assert b.complete
    assert a.time.tobytes() == b.time.tobytes()
    assert a.events == b.events
    for component in a.components:
        for variable in a.variables(component):
            np.testing.assert_array_equal(a.signal(component, variable), b.signal(component, variable))
    assert a.estimated_errors == b.estimated_errors
    for name in ("steps", "iterations", "rejected_steps"):
        assert a.statistics.get(name) == b.statistics.get(name)


@pytest.mark.parametrize(
    ("variant", "after"),
    [pytest.param((), [8], marks=pytest.mark.thorough), ("spring_latch", [6, 10])],
    ids=["kinematic", "spring"],
)
def test_resumed_run_is_the_one_that_was_not_interrupted(tmp_path, interruptions, variant, after):
    """Identity of every bit, from checkpoints between and after latch-ups, locks and springs."""
    whole = tmp_path / "whole.h5"
    scene = fanfold.load("amos3", variant, {"scene.tolerance": 1e-2})
    fanfold.simulate(scene, rigid="all", checkpoint=1.1, save=whole, estimate=not variant)
    opened = Result.open(whole)
    assert len(opened.events) == 3
    assert len(interruptions) == 12
    assert not checkpoint_file(whole).exists()
    for cut in (interruptions[k] for k in after):
        fanfold.resume(cut)
        assert_same_bits(opened, cut)
        assert not checkpoint_file(cut).exists()


def hung(side, pinned):
    """A ball on a rope in the wind, which the master's static search does not bring to rest; or on a pin as well."""
    scene = fanfold.Scene("hung", until="0.2 s", preload=True, gravity=(0, 0, -9.81), tolerance=1e-3)
    scene.base(points={"top": (0, 0, 2), "below": (0, 0, 0)})
    rigid = {"mass": 2.0, "inertia": (0.2, 0.2, 0.3), "points": {"middle": (0, 0, 0), "pin": (0, 0, 0)}}
    scene.body("ball", place={"body": "base", "point": "below"}, rigid=rigid)
    scene.connection(
        "rope", "suspension", ports={"upper": ("base", "top"), "lower": ("ball", "middle")},
        parameters={"stiffness": 500.0, "preload": 2.0 * 9.81, "preload_length": 2.0},
    )  # fmt: skip
    law = [{"profile": "constant", "value": side}]
    scene.connection(
        "wind", "load", structure={"direction": (1, 0, 0), "force": law}, ports={"body": ("ball", "middle")}
    )
    if pinned:
        ports = {"inboard": ("base", "below"), "outboard": ("ball", "pin")}
        scene.connection("pin", "hinge", ports=ports, preset="revolute")
    return scene


@pytest.mark.parametrize("pinned", [False, True])
def test_runs_that_start_in_equilibrium_resume(tmp_path, interruptions, pinned):
    """Regression: bodies were built where they are written, joints were held, and "fmu.ball ... are not the same"."""
    whole = tmp_path / "whole.h5"
    fanfold.simulate(hung(5.0, pinned), checkpoint=0.05, save=whole, estimate=False)
    cut = interruptions[0]
    fanfold.resume(cut)
    assert_same_bits(whole, cut)


EVENTS = """
[[event]]
name = "motor_fails"
when = { component = "middle_line", variable = "angle", above = "0.02 deg" }
set = { middle_line = { motor_stiffness = 0 } }

[[event]]
name = "breaks"
time = "0.06 s"
release = ["middle_left"]
"""


def test_events_are_kept(tmp_path, interruptions):
    """Identity of every bit, from checkpoints between and after events."""
    path, whole = tmp_path / "wing.toml", tmp_path / "whole.h5"
    path.write_text(f"extends = '{TWO_PANELS}'\n{EVENTS}", encoding="utf-8")
    fanfold.simulate(path, until=0.08, checkpoint=0.025, save=whole, estimate=False, rigid="all")
    events = Result.open(whole).events
    assert [name for _, name, _ in events] == ["motor_fails", "breaks"]
    for cut in interruptions[1:3]:
        fanfold.resume(cut)
        assert_same_bits(whole, cut)


def test_rows_after_the_checkpoint_are_made_again(tmp_path, interruptions):
    """A kill some time after a checkpoint: what was written since goes, and comes again."""
    whole = tmp_path / "whole.h5"
    fanfold.simulate(TWO_PANELS, until=1.0, checkpoint=0.25, save=whole, estimate=False)
    first, later = interruptions[0], interruptions[2]
    assert Result.open(later).time.size > Result.open(first).time.size
    shutil.copy(later, first)
    fanfold.resume(first)
    assert_same_bits(whole, first)


def test_python_fmus_resume(tmp_path, interruptions):
    """Identity of every bit where PythonFMUs keep their states themselves."""
    whole = tmp_path / "whole.h5"
    fanfold.simulate(
        TWO_PANELS, until=0.01, checkpoint=0.006, save=whole, estimate=False, backend="python", rigid="all"
    )
    fanfold.resume(interruptions[-1])
    assert_same_bits(whole, interruptions[-1])


def refused(path):
    with pytest.raises(RunError) as caught:
        fanfold.resume(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.fixture(scope="module")
def cuts(tmp_path_factory):
    """Interrupted runs, with their checkpoints."""
    folder = tmp_path_factory.mktemp("cuts")
    with pytest.MonkeyPatch.context() as patch:
        found = copies_of_checkpoints(patch, folder)
        fanfold.simulate(TWO_PANELS, until=0.1, checkpoint=0.05, save=folder / "whole.h5", estimate=False)
    return found


@pytest.fixture
def cut(cuts, tmp_path):
    """One of its own."""
    shutil.copy(checkpoint_file(cuts[0]), tmp_path)
    return Path(shutil.copy(cuts[0], tmp_path))


def test_without_a_checkpoint(tmp_path):
    assert "run.h5.checkpoint" in refused(tmp_path / "run.h5")


@pytest.mark.parametrize("part", [0.0, 0.3, 0.6, 0.9, 0.999])
def test_damaged_checkpoint(cut, part):
    """Bad input: any byte may be wrong, or the file cut short; it is told, and no wrong state is gone on from."""
    path = checkpoint_file(cut)
    sound = path.read_bytes()
    place = int(part * len(sound))
    path.write_bytes(sound[:place] + bytes([sound[place] ^ 0x40]) + sound[place + 1 :])
    flipped = refused(cut)
    path.write_bytes(sound[:place])
    assert "is damaged" in flipped
    assert "is damaged" in refused(cut)


def test_other_fmus_or_versions(cut, monkeypatch):
    """Bad input: another FMU or library would go on to another result."""
    monkeypatch.setattr("orchestrator.run.run._versions", lambda: {"numpy": "0", "scipy": "1"})
    sentence = refused(cut)
    assert "numpy" in sentence


def test_result_that_ends_before_the_checkpoint(cut):
    """Bad input: a result and a checkpoint that do not belong together."""
    fanfold.simulate(TWO_PANELS, until=0.001, save=cut.with_name("short.h5"), estimate=False)
    checkpoint_file(cut).rename(checkpoint_file(cut.with_name("short.h5")))
    with pytest.raises(fanfold.FanfoldError, match=r"short\.h5"):
        fanfold.resume(cut.with_name("short.h5"))


def damaged_rows(whole):
    """Places of bytes in a result of which resuming must see that they are others: of rows and of events."""
    with h5py.File(whole) as file:
        chunks = [
            dataset.id.get_chunk_info(0).byte_offset
            for folder in (*file["signals"].values(), file["events"])
            for dataset in folder.values()
            if dataset.id.get_num_chunks()
        ]
        chunks.append(file["time"].id.get_chunk_info(0).byte_offset)
    return chunks


def test_rows_that_were_damaged_before_the_checkpoint(cut):
    """Regression: a flipped bit of them passed for what was written, in a run that goes on "in every bit"."""
    sound, state = cut.read_bytes(), checkpoint_file(cut).read_bytes()
    for place in damaged_rows(cut)[::7]:
        cut.write_bytes(sound[:place] + bytes([sound[place] ^ 0x01]) + sound[place + 1 :])
        with pytest.raises(fanfold.FanfoldError, match="checkpoint"):
            fanfold.resume(cut)
        assert checkpoint_file(cut).read_bytes() == state
    cut.write_bytes(sound)
    fanfold.resume(cut)


@pytest.mark.parametrize("rows", [0, 1, 999, 1000, 1001, 2000, 2345])
def test_places_are_met_again_and_checked(tmp_path, rows):
    """Identity: rows that were handed over, at and between the ends of chunks; the checksum of another is refused."""
    path, groups = tmp_path / "run.h5", [SignalGroup("c", ("v",), ("m",), (2,), ("",))]
    writer = ResultWriter(path, groups, {}, {}, ())
    for k in range(rows):
        writer.append(float(k), [np.array([k, -k])])
        if k % 500 == 0:
            writer.event(float(k), "c", f"at {k} µs")
    place = writer.place()
    writer.append(1e4, [np.zeros(2)])
    writer.close(complete=False)
    with pytest.raises(fanfold.FanfoldError, match=r"run\.h5"):
        ResultWriter.resumed(path, groups, place._replace(checksum=place.checksum ^ 1))
    with ResultWriter.resumed(path, groups, place) as writer:
        assert writer.place() == place
        writer.append(2e4, [np.ones(2)])
    result = Result.open(path)
    np.testing.assert_array_equal(result.time, [*range(rows), 2e4])
    np.testing.assert_array_equal(result.signal("c", "v")[:-1, 1], -np.arange(rows))
    assert result.events == [(float(k), "c", f"at {k} µs") for k in range(0, rows, 500)]


def test_runs_that_have_no_checkpoints(tmp_path):
    """Bad input: in memory, or with an explicit master."""
    with pytest.raises(RunError, match="in memory"):
        fanfold.simulate(TWO_PANELS, until=0.1, checkpoint=0.05)
    with pytest.raises(RunError, match="implicit"):
        fanfold.simulate(
            TWO_PANELS, until=0.1, checkpoint=0.05, save=tmp_path / "a.h5", master="jacobi", step=1e-5
        )
    with pytest.raises(RunError, match="positive"):
        fanfold.simulate(TWO_PANELS, until=0.1, checkpoint=-1.0, save=tmp_path / "a.h5")
