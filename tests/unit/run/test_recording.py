"""What a result keeps: headline numbers, extreme values and events of fewer rows and signals are those of all."""

import json
import warnings

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from components.contract.roles import INTERFACE_LOAD, LOAD
from orchestrator.analysis.impact import impacts
from orchestrator.assembly import HingeLine
from orchestrator.cli.main import main
from orchestrator.results.key_figures import headline
from orchestrator.results.peaks import peak
from orchestrator.results.recorder import MemoryRecorder, SignalGroup
from orchestrator.results.result import Result
from orchestrator.run.recording import Recording


def refuse(sentence):
    raise AssertionError(sentence)


@pytest.fixture(scope="module")
def whole():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return fanfold.simulate("amos3", rigid="all", tolerance=1e-3, estimate=False)


@pytest.mark.parametrize("spacing", [0.02, 0.3, 100.0])
def test_numbers_of_fewer_rows_are_those_of_all(whole, spacing):
    """Independent path: every number and every extreme value from all rows, in every bit."""
    thin = Recording(spacing).applied(whole, refuse)
    assert thin.time.size < 0.75 * whole.time.size
    assert np.diff(thin.time).max() <= 2.0 * max(spacing, np.diff(whole.time).max())
    assert headline(thin) == whole.headline
    for name in whole.components:
        for variable in whole.variables(name):
            here, there = thin.signal(name, variable), whole.signal(name, variable)
            np.testing.assert_array_equal(here.min(axis=0), there.min(axis=0))
            np.testing.assert_array_equal(here.max(axis=0), there.max(axis=0))
            np.testing.assert_array_equal(here, there[np.isin(whole.time, thin.time)])


def test_both_sides_of_events_are_kept(whole):
    thin = Recording(1.0).applied(whole, refuse)
    for when, _, _ in whole.events:
        there = whole.time[np.abs(whole.time - when) < 2e-7]
        np.testing.assert_array_equal(thin.time[np.abs(thin.time - when) < 2e-7], there)


@pytest.mark.parametrize("seed", range(8))
def test_peaks_and_touches_of_random_rows_stay(seed):
    """Input that nobody chose: swings and noise between events anywhere, and a point that bounces."""
    result = random_result(np.random.default_rng(seed))
    thin = Recording(0.5).applied(result, refuse)
    assert thin.time.size < result.time.size
    assert headline(thin) == headline(result)
    assert impacts(thin) == impacts(result)
    for of in result.in_role(LOAD, INTERFACE_LOAD):
        for here, there in zip(columns(thin, of), columns(result, of), strict=True):
            assert peak(thin, here) == peak(result, there)


def columns(result, of):
    return result.signal(*of).reshape(result.time.size, -1).T


def random_result(random):
    """A line that latches, an interface, a load and a contact; times as of variable steps with events in between."""
    contact = ("penetration", "contact_force", "dissipated_energy")
    groups = [
        SignalGroup("hinge", ("angle", "latch_torque"), ("rad", "N.m"), (1, 1), ("",) * 2),
        SignalGroup("base", ("interface_force",), ("N",), (3,), ("",), (INTERFACE_LOAD,)),
        SignalGroup("damper", ("damper_torque",), ("N.m",), (1,), ("",), (LOAD,)),
        SignalGroup("bumper", contact, ("m", "N", "J"), (1,) * 3, ("",) * 3),
    ]
    line = HingeLine("HL", ("hinge",), "hinge", True, False)
    recorder = MemoryRecorder(groups, {"tolerance": "1e-4"}, {}, [line])
    time = np.cumsum(random.uniform(1e-3, 1e-2, 3000))
    events = np.sort(random.choice(time.size, 3, replace=False))
    frequency, noise = random.uniform(3.0, 30.0, 6), random.uniform(0.0, 0.2, 6)
    waves = np.sin(np.outer(time, frequency)) * np.exp(-random.uniform(0.0, 0.5) * time)[:, None]
    waves += noise * random.normal(size=waves.shape)
    depth = np.sin(3.0 * time) - 0.9
    force = np.maximum(depth, 0.0)
    for k, t in enumerate(time.tolist()):
        row = [waves[k, :2], waves[k, 2:5], waves[k, 5:], np.array([depth[k], force[k], 0.1 * t])]
        recorder.extend(np.array([t]), np.concatenate(row)[None])
        if k in events:
            recorder.event(t, "HL", "HL latch-up")
            recorder.extend(np.array([t]), 1.5 * np.concatenate(row)[None])
    return recorder.result()


def test_command_keeps_what_is_asked_for(tmp_path):
    """Through the command line: file, numbers, signals, and what the file tells of itself."""
    runs = {}
    for name, asked in (("all", ()), ("part", ("--record", "0.5", "--signals", "hinge_left,*.frame_*"))):
        path = tmp_path / f"{name}.h5"
        command = ["run", "workbench", "--rigid", "all", "--until", "5", "--no-refine", "--json", "--output"]
        found = CliRunner().invoke(main, [*command, str(path), *asked])
        assert found.exit_code == 0, found.output
        runs[name] = json.loads(found.stdout), Result.open(path)
    (numbers, whole), (fewer, part) = runs["all"], runs["part"]
    costs = {"output", "wall_time_s", "real_time_factor", "fmu_time_share"}
    assert {k: v for k, v in fewer.items() if k not in costs} == {
        k: v for k, v in numbers.items() if k not in costs
    }
    assert part.provenance["recorded_rows"] == "one in 0.5 s, events, peaks"
    assert part.provenance["recorded_signals"] == "*.frame_*, hinge_left"
    assert part.has("panel", "frame_position")
    assert not part.has("panel", "angular_momentum")
    assert whole.has("panel", "angular_momentum")
    assert part.time.size < whole.time.size
    assert sorted(path.name for path in tmp_path.iterdir()) == ["all.h5", "part.h5"]


def test_bodies_without_their_pose_are_not_drawn(whole):
    assert whole.geometry
    assert not Recording(None, ["hl1_*"]).applied(whole, refuse).geometry


def test_a_pattern_that_matches_nothing_loses_nothing(whole):
    told = []
    kept = Recording(None, ["hl1_*", "hl9_*"]).applied(whole, told.append)
    assert kept.components == whole.components
    assert len(told) == 1
    assert "hl9_*" in told[0]
    assert "hl1_hinge" in told[0]


@pytest.mark.parametrize("spacing", [0.0, -1.0])
def test_spacings_that_cannot_be_are_refused(spacing):
    with pytest.raises(fanfold.FanfoldError, match="recorded rows"):
        fanfold.simulate("workbench", record=spacing)
