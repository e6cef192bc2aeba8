"""Studies: the same samples wherever they run, nothing lost by kills, influence against closed forms, the command."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
from concurrent.futures import Executor, Future
from contextlib import contextmanager, nullcontext
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.analysis.sampling import carry_out, workers
from orchestrator.analysis.sampling import sample as one_sample
from orchestrator.analysis.sampling.carry_out import asked_of
from orchestrator.analysis.sampling.distributions import StudyError
from orchestrator.analysis.sampling.influence import influence
from orchestrator.analysis.sampling.journal import Journal, journal_file
from orchestrator.analysis.sampling.plan import Plan
from orchestrator.analysis.sampling.sample import Sample, Task, run_sample
from orchestrator.analysis.sampling.study import Share, Study, runs_for
from orchestrator.analysis.sampling.varied import varied
from orchestrator.cli.main import main
from orchestrator.cli.study import _report as report
from orchestrator.run.errors import InterruptedRunError
from orchestrator.run.simulation import Options
from tests.unit.scene.scene_cases import SCENES

pytestmark = pytest.mark.filterwarnings("ignore:.*W-no-end")  # nothing stops it

ROOT = Path(__file__).parents[4]
WING = SCENES / "two_panels.toml"
VARY = {"friction.coefficient": "uniform(0.05, 0.2)", "hinge_line.root_line.motor.stowed*": "normal(1, 0.05)"}
ASKED = {"rigid": "all", "until": 0.3, "tolerance": 1e-2, "runs": 4}


@pytest.fixture(scope="module")
def here():
    """In this process."""
    return fanfold.study(WING, VARY, signals="root.angle", points=7, **ASKED)


def task():
    options = Options(rigid=frozenset({"all"}), until=0.3, tolerance=1e-2)
    return Task(fanfold.load(WING), options, signals=("root.angle",), points=7)


def settings_of(study, index):
    tree = fanfold.load(WING).tree
    drawn = ((one, float(study.parameters[one.name][index])) for one in study.plan.varied)
    return {key: value for one, v in drawn for key, value in one.settings(tree, v).items()}


def same(one, other):
    assert one.parameters.keys() == other.parameters.keys()
    for table in ("parameters", "numbers", "opened", "signals"):
        a, b = getattr(one, table), getattr(other, table)
        assert a.keys() == b.keys()
        for name in a:
            np.testing.assert_array_equal(a[name], b[name])
    assert (one.finished == other.finished).all()
    assert one.messages == other.messages


def test_a_sample_is_the_run_of_its_values(here):
    """Same numbers, bit for bit, as the run of the scene with these values, whose FMUs ran nothing before."""
    values = {name: column[2] for name, column in here.parameters.items()}
    scene = fanfold.load(WING)
    settings = {
        "friction.coefficient": values["friction.coefficient"],
        "hinge_line.root_line.motor.stowed": 1.6 * values["hinge_line.root_line.motor.stowed*"],
    }
    result = fanfold.simulate(
        scene.with_settings(settings), rigid="all", until=0.3, tolerance=1e-2, estimate=False
    )
    for number in result.headline.numbers():
        assert here.numbers[number.id][2] == number.value
    np.testing.assert_array_equal(
        here.signals["root.angle"][2],
        np.interp(np.linspace(0.0, 0.3, 7), result.time, result["root", "angle"]),
    )


def test_a_killed_worker_takes_no_sample_with_it(here):
    """Kill: one of two processes dies after the first sample; all samples come, as in one process."""
    opened = []

    @contextmanager
    def watched(count):
        with workers.local(count) as pool:
            opened.append(pool)
            yield pool

    shared = task()
    jobs = [(k, settings_of(here, k)) for k in range(4)]
    found = []
    for sample in workers.carried_out(shared, jobs, 2, watched):
        if not found:
            os.kill(next(iter(opened[0]._processes)), signal.SIGKILL)
        found.append(sample)
    assert len(opened) == 2
    assert sorted(sample.index for sample in found) == [0, 1, 2, 3]
    same(Study.of(asked_of(shared, here.plan), found), here)


class Deadly(fanfold.Scene):
    """A scene that ends the process it is run in where friction is 0.1."""

    def with_settings(self, settings):
        if dict(settings).get("friction.coefficient") == 0.1:
            os._exit(1)
        return super().with_settings(settings)


@pytest.mark.thorough
def test_the_sample_that_ends_processes_is_known():
    """One of three ends whatever runs it: it is named, and the others come."""
    shared = replace(task(), scene=Deadly.load(WING))
    jobs = [(k, {"friction.coefficient": value}) for k, value in enumerate((0.05, 0.1, 0.2))]
    found = {sample.index: sample for sample in workers.carried_out(shared, jobs, 2, workers.local)}
    assert sorted(found) == [0, 1, 2]
    assert (found[0].message, found[2].message) == ("", "")
    assert "died" in found[1].message


@pytest.mark.thorough
def test_a_cluster_gives_the_same_samples(here):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        found = fanfold.study(
            WING, VARY, signals="root.angle", points=7, cluster=cluster.scheduler_address, **ASKED
        )
    same(found, here)


def test_an_interrupted_study_goes_on(here, tmp_path):
    """Kill: a journal whose last line was cut off; what it lacks runs, and the file is that of a whole study."""
    path = tmp_path / "study.h5"
    with Journal.begin(path, here.asked) as journal:
        journal.append(run_sample(task(), 3, settings_of(here, 3)))
        with pytest.raises(StudyError, match=r"study\.h5\.journal: .*writing"):
            fanfold.resume_study(path)
    with journal_file(path).open("a") as file:
        file.write('{"index": 0, "mess')
    with pytest.raises(StudyError, match=r"study\.h5\.journal: .*`fanfold study"):
        fanfold.study(WING, VARY, save=path, **ASKED)
    found = fanfold.resume_study(path)
    same(found, here)
    same(fanfold.Study.open(path), here)
    assert not journal_file(path).exists()
    rows = list(csv.reader(path.with_suffix(".csv").open()))
    assert rows[0][:3] == ["sample", "friction.coefficient", "hinge_line.root_line.motor.stowed*, 1"]
    assert [float(row[1]) for row in rows[1:]] == here.parameters["friction.coefficient"].tolist()


def test_a_damaged_line_of_a_journal_is_drawn_again(here, tmp_path):
    """Flips: whichever byte of a journal changes, no sample is read that is not one that was written."""
    path, generator = tmp_path / "study.h5", np.random.default_rng(1)
    written = [Sample(k, numbers={"latch time": (0.1 * k, "s", None)}, opened={"L": True}) for k in range(3)]
    with Journal.begin(path, here.asked) as journal:
        for sample in written:
            journal.append(sample)
    text = journal_file(path).read_bytes()
    first = text.index(b"\n") + 1
    lines = {json.dumps(asdict(sample)) for sample in written}
    for place in generator.integers(first, len(text), 100):
        damaged = bytearray(text)
        damaged[place] ^= 1 << int(generator.integers(0, 8))
        journal_file(path).write_bytes(damaged)
        journal, _, samples = Journal.resume(path)
        with journal:
            journal.append(written[0])  # what follows stands on a line of its own
        again, _, more = Journal.resume(path)
        with again:
            assert {json.dumps(asdict(sample)) for sample in samples} < lines
            assert len(samples) >= 1
            assert 0 in [sample.index for sample in more]
    journal_file(path).write_bytes(b"{" + text)
    with pytest.raises(StudyError, match=r"study\.h5\.journal: .*damaged"):
        Journal.resume(path)


def test_a_cluster_without_its_scheduler_is_a_sentence(tmp_path, monkeypatch):
    """Regression: CancelledError as a traceback; the journal stays, and the sentence has the command to go on with."""

    class Gone(Executor):
        def submit(self, *_):
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
            return future

    monkeypatch.setattr(carry_out, "dask", lambda address: lambda count: nullcontext(Gone()))
    path = tmp_path / "study.h5"
    with pytest.raises(StudyError, match="tcp://host:1: ") as refused:
        fanfold.study(WING, VARY, cluster="tcp://host:1", save=path, **ASKED)
    assert f"fanfold study {path}" in str(refused.value)
    assert journal_file(path).exists()


def test_the_tracker_of_semaphores_prints_nothing():
    """Regression: after the kill of a worker, loky's tracker printed the traceback of a KeyError on the terminal."""
    code = """
from loky.backend import resource_tracker
from orchestrator.analysis.sampling import workers
with workers.local(2) as pool:
    pool.submit(int).result()
    resource_tracker.unregister("/of-no-worker", "semlock")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, cwd=ROOT)
    assert (done.returncode, done.stderr) == (0, "")


def test_an_interrupted_run_is_no_failed_sample(here, tmp_path, monkeypatch):
    """Regression: Ctrl-C within a run counted as its failure, and the study went on; the sample runs again later."""
    path, run = tmp_path / "study.h5", one_sample.simulate

    def interrupted(scene, *arguments, **others):
        if journal_file(path).exists() and len(journal_file(path).read_text().splitlines()) > 1:
            raise InterruptedRunError("interrupted at t = 0.1 s")
        return run(scene, *arguments, **others)

    with monkeypatch.context() as patch:
        patch.setattr(one_sample, "simulate", interrupted)
        with pytest.raises(KeyboardInterrupt):
            fanfold.study(WING, VARY, save=path, signals="root.angle", points=7, **ASKED)
    same(fanfold.resume_study(path), here)


def test_a_finished_study_is_shown_again(here, tmp_path):
    """Regression: "there is no journal of an interrupted study", and no command showed the table again."""
    here.save(tmp_path / "whole.h5")
    same(fanfold.resume_study(tmp_path / "whole.h5"), here)


def studied(file, method, *options):
    """What the command tells of a short study of the wing."""
    drawn = [word for key, text in VARY.items() for word in ("--vary", f"{key}={text}")]
    quick = ["--rigid", "all", "--until", "0.2", "--tolerance", "1e-2"]
    command = ["study", str(WING), *quick, "--method", method, *options, *drawn, "--output", str(file)]
    return CliRunner().invoke(main, command, catch_exceptions=False)


def test_shares_of_variance_and_what_lets_lines_latch_are_told(tmp_path):
    """Output; bounds are of the 2 N samples that repeat no value of others. Regression: 4 N counted."""
    file = tmp_path / "s.h5"
    told = studied(file, "sobol-indices", "--runs", "2")
    assert told.exit_code == 0
    assert "variance" in " ".join(told.output.split())
    again = CliRunner().invoke(main, ["study", str(file), "--json"], catch_exceptions=False)
    moved = json.loads(again.stdout)["influence"]["interface_force_peak.z"]
    assert moved["variance_shares"].keys() == moved["changes"].keys() == set(VARY)
    study = fanfold.Study.open(file)
    assert len(study.messages) == 8
    assert all(share.among == 4 for share in study.not_opening().values())


def test_worst_cases_are_told_with_their_samples(tmp_path):
    """Definition. Regression: designs had quantiles of a handful of points, below their worst case."""
    file = tmp_path / "corners.h5"
    told = studied(file, "corners")
    assert "highest" in told.output
    assert "median" not in told.output
    values = fanfold.Study.open(file).numbers["interface_force_peak.z"]
    again = CliRunner().invoke(main, ["study", str(file), "--json"], catch_exceptions=False)
    found = json.loads(again.stdout)["extremes"]["interface_force_peak.z"]["highest"]
    assert found == {"value": values.max(), "sample": int(values.argmax())}


def test_what_every_run_is_given_is_not_varied():
    """Message. Regression: the option won in all samples, and the table listed what was drawn."""
    with pytest.raises(StudyError, match=r"scene.until .*until = 0.3"):
        fanfold.study(WING, {"scene.until": "uniform(1, 2)"}, **ASKED)


def test_failed_samples_are_named_and_stop_nothing(tmp_path):
    """A value that no scene can have, among others that it can."""
    vary = {"friction.coefficient": "values(-1, 0.05, 0.1)"}
    found = fanfold.study(
        WING, vary, method="grid", rigid="all", until=0.05, tolerance=1e-2, save=tmp_path / "s.h5"
    )
    assert found.finished.tolist() == [False, True, True]
    assert "friction.coefficient" in found.failed[0]
    assert np.isnan(found.numbers["end_time"][0])


def test_what_cannot_begin_is_refused_before_the_first_run(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "ANSWER", 0.5)
    (tmp_path / "notes.h5").write_text("notes")
    for vary, options, said in (
        ({"friction.coeficient": "uniform(0, 1)"}, {}, "coefficient"),
        ({"friction.coefficient": "uniform(0, 1)"}, {"save": tmp_path / "notes.h5"}, "notes.h5"),
        ({"friction.coefficient": "uniform(0, 1)"}, {"workers": 0}, "0 workers"),
        ({"friction.coefficient": "uniform(0, 1)"}, {"cluster": "tcp://127.0.0.1:9"}, "Dask"),
    ):  # fmt: skip
        with pytest.raises(fanfold.FanfoldError) as refused:
            fanfold.study(WING, vary, **options)
        assert said in str(refused.value)
    with pytest.raises(StudyError, match=r"neither such a file nor a journal no\.h5\.journal"):
        fanfold.resume_study(tmp_path / "no.h5")


def synthetic(here, method, numbers, runs=256, texts=("a=uniform(0, 1)", "b=uniform(0, 1)")):
    """A study whose numbers are functions of its parameters."""
    texts = list(texts)
    plan = Plan(tuple(map(varied, texts)), method, runs)
    asked = {**here.asked, "varied": texts, "method": method, "runs": runs}
    samples = [
        Sample(k, numbers={name: (f(*row), "N", None) for name, f in numbers.items()}, opened={"L": k > 0})
        for k, row in enumerate(plan.samples().tolist())
    ]
    return fanfold.Study.of_record(Study.of(asked, samples))


def test_signals_that_nothing_matches_are_told_before_the_samples_run():
    """Regression: a study kept none, without a word."""
    with pytest.warns(fanfold.FanfoldWarning, match=r"nope\*.*W-signals"):
        fanfold.study(WING, VARY, signals=["root.angle", "scene.*", "nope*"], **{**ASKED, "runs": 1})


def test_influence_is_that_of_closed_forms(here):
    """A + 3 b: ends of straight lines, variance shares 1 to 9; a b: 3/7 each alone, 4/7 in all."""
    numbers = {
        "latch_time.sum": lambda a, b: a + 3.0 * b,
        "latch_time.product": lambda a, b: a * b,
        "same": lambda a, b: 2.0,
        "interface_force_peak.y": lambda a, b: 1e-9 * (a - b),
    }
    line = synthetic(here, "latin-hypercube", numbers).influence("latch_time.sum")
    assert line.ranked == ["b", "a"]
    assert line.explained == pytest.approx(1.0, abs=1e-12)
    # quantiles of 256 strata lie within a stratum of those of the distribution
    assert line.changes["b"] == pytest.approx((-1.35, 1.35), abs=3.0 / 128)
    single = synthetic(here, "one-at-a-time", numbers)
    assert single.influence("latch_time.sum").changes == {"a": (-0.5, 0.5), "b": (-1.5, 1.5)}
    assert influence(single, "same") is None
    assert influence(single, "interface_force_peak.y") is None  # round-off beside its like
    with pytest.raises(StudyError, match=r"latch_time\.some .*latch_time"):
        single.influence("latch_time.some")
    shares = synthetic(here, "sobol-indices", numbers, runs=1024)
    # errors of a quasi-random sum of this size, Saltelli et al. 2010, figure 2
    assert shares.influence("latch_time.sum").shares["b"] == pytest.approx((0.9, 0.9), abs=0.02)
    assert shares.influence("latch_time.product").shares["a"] == pytest.approx((3 / 7, 4 / 7), abs=0.02)


def test_all_variance_is_that_of_the_only_key(here):
    numbers = {"latch time": lambda a: a}
    assert synthetic(here, "sobol-indices", numbers, 16, ["a=uniform(0, 1)"]).influence(
        "latch time"
    ).shares == {"a": (1.0, 1.0)}


def test_the_share_that_does_not_latch_has_clopper_pearson_bounds(here):
    """Closed form for 1 of 256: 1 - 0.975^(1/256) below, and the root of P(X <= 1) = 0.025 above."""
    share = synthetic(here, "random", {"latch_time.L": lambda a, b: a}).not_opening()["L"]
    assert (share.samples, share.among) == (1, 256)
    assert share.low == pytest.approx(1.0 - 0.975 ** (1 / 256), rel=1e-9)
    p = share.high
    assert (1 - p) ** 256 + 256 * p * (1 - p) ** 255 == pytest.approx(0.025, rel=1e-6)
    assert (1 - share.below) ** 256 + 256 * share.below * (1 - share.below) ** 255 == pytest.approx(0.05)


def test_the_wing_fails_where_any_line_does(here):
    """Counts by hand: lines fail in samples 0 and 1 of four, another has not finished; 1 - 0.05^(1/n) for none of n."""
    lines = {"a": np.array([0.0, 1.0, 1.0, np.nan]), "b": np.array([1.0, 0.0, 1.0, np.nan])}
    wing = replace(here, opened=lines).wing_not_opening()
    assert (wing.samples, wing.among) == (2, 3)
    assert replace(here, opened={}).wing_not_opening() is None
    assert Share.of(0, 200).below == pytest.approx(1.0 - 0.05 ** (1 / 200), rel=1e-9)


@pytest.mark.parametrize("bound", [0.1, 1e-3, 1e-6])
def test_runs_for_a_bound_are_the_fewest_that_show_it(bound):
    """Definition, by the bound of Clopper and Pearson: so many runs without a failure are below it, less are not."""
    runs = runs_for(bound)
    assert Share.of(0, runs).below <= bound < Share.of(0, runs - 1).below


def test_command(tmp_path, monkeypatch):
    """From the terminal: file, table, figures, JSON; the same as from Python."""
    monkeypatch.chdir(tmp_path)
    arguments = ["study", str(WING), "--rigid", "all", "--until", "0.3", "--tolerance", "1e-2", "--runs", "4"]
    for key, text in VARY.items():
        arguments += ["--vary", f"{key}={text}"]
    found = CliRunner().invoke(main, [*arguments, "--plot", "pictures", "--json"])
    assert found.exit_code == 0, found.output
    told = json.loads(found.stdout)
    study = fanfold.Study.open(told["output"])
    assert told["quantiles"]["end_time"]["50%"] == 0.3
    assert study.plan.count == 4
    assert (tmp_path / "two_panels.rigid.study.csv").is_file()
    finer = [*arguments, "--seed", "1"]
    refused = CliRunner().invoke(main, finer)
    assert refused.exit_code == 1
    assert all(words in refused.stderr for words in ("two_panels.rigid.study.h5: ", "seed 0 instead of 1"))
    assert fanfold.Study.open(told["output"]).plan.seed == 0
    assert CliRunner().invoke(main, [*finer, "--replace"]).exit_code == 0
    assert fanfold.Study.open(told["output"]).plan.seed == 1
    assert CliRunner().invoke(main, finer).exit_code == 0
    shown = CliRunner().invoke(main, ["study", str(WING), "--vary", "friction.coefficient=uniform(1)"])
    assert shown.exit_code == 1
    assert "uniform(LOW, HIGH)" in shown.stderr
    again = CliRunner().invoke(main, ["study", told["output"]])
    assert again.exit_code == 0, again.stderr
    assert "sensitive" in again.stdout


def test_command_says_how_often_the_wing_opens(here, tmp_path, capsys):
    """Numbers: 1 of 256 fails, interval and bound of Clopper and Pearson; long keys keep their ends."""
    drawn = synthetic(here, "random", {"latch_time.L": lambda a, b: a})
    names = dict(
        zip(
            (f"table.{'long_' * 20}name.a", f"table.{'long_' * 20}name.b"),
            drawn.parameters.values(),
            strict=True,
        )
    )
    report(replace(drawn, parameters=names, path=tmp_path / "a.h5"), [])
    told = " ".join(capsys.readouterr().out.split())
    wing, line = drawn.wing_not_opening(), drawn.not_opening()["L"]
    assert "255 of 256" in told
    assert f"{100 * wing.below:.2g} % (95 %" in told
    assert f"{100 * line.low:.2g} % to {100 * line.high:.2g} %" in told
    assert re.search(r"…\S*name\.a", told)
    whole = replace(drawn, opened={"L": np.ones(256)}, path=tmp_path / "a.h5")
    report(whole, [])
    assert f"{runs_for(0.01):,} runs" in " ".join(capsys.readouterr().out.split())


def test_figures_are_drawn(here, tmp_path):
    drawn = synthetic(here, "latin-hypercube", {"latch_time.L": lambda a, b: a + b})
    drawn = replace(drawn, times=np.linspace(0, 1, 7), signals={"root.angle": np.ones((256, 7))})
    written = drawn.plot_all(tmp_path)
    assert [path.stem for path in written] == ["distributions", "tornado", "scatter", "signals"]
    assert all(path.stat().st_size > 10_000 for path in written)
