"""Carrying a study out: samples over workers, a journal while it goes, a file when it is whole."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager
from dataclasses import replace as with_values
from pathlib import Path
from typing import Any

from ...results.differences import leaves
from ...results.earlier import unlike
from ...run.simulation import Options
from ...scene.builder import Scene
from ...scene.digests import digests
from ...scene.layers import Tree, data_files
from ...scene.plugins.trust import trust_data
from .distributions import StudyError
from .journal import Asked, Journal
from .plan import Plan
from .same_files import refuse_changed
from .sample import Sample, Task, run_sample
from .study import Study, plan_of
from .varied import Settings
from .workers import Job, Pool, carried_out, dask, local

Watch = Callable[[int, int], None]
"""Takes how many samples are done, and how many of them failed."""
StudyProgress = Callable[[str, int], AbstractContextManager[Watch]]
"""Opens a display for a study, given what it is called and how many samples it has."""


def begin(
    task: Task,
    plan: Plan,
    output: Path | None,
    workers: int,
    cluster: str | None,
    progress: StudyProgress,
    *,
    replace: bool = True,
) -> Study:
    """Carry a study out; StudyError, SceneError or RunError before the first run where it cannot be.

    output: its HDF5 file, beside which stand a table of the samples (.csv) and, until it is whole, its journal; None
    for memory alone. workers: processes. cluster: address of a Dask scheduler, whose workers take the place of those.
    replace: a study of other settings in that file.
    """
    _refuse_overruled(task, plan)
    asked = asked_of(task, plan)
    nominal = [one.distribution.nominal for one in plan.varied]
    task.scene.with_settings(_settings(task.scene.tree, plan, nominal)).check_one_run()
    if output is None:
        return _carried_out(task, asked, [], None, workers, cluster, progress)
    if output.exists():
        before = Study.open(output).asked  # replaces a study, and nothing else
        now = json.loads(json.dumps(asked))
        if not replace and (sentence := unlike(output, dict(leaves("", before)), dict(leaves("", now)))):
            raise StudyError(sentence)
    with Journal.begin(output, asked) as journal:
        return _saved(output, journal, _carried_out(task, asked, [], journal, workers, cluster, progress))


def _refuse_overruled(task: Task, plan: Plan) -> None:
    """StudyError where something is varied that every run is given besides, and would do nothing."""
    given = {"scene.until": task.options.until, "scene.tolerance": task.options.tolerance}
    for key in (key for one in plan.varied for key in one.keys):
        if given.get(key) is not None:
            option = key.rpartition(".")[2]
            raise StudyError(
                f"{key} is varied, and {option} = {given[key]:g} is given for every run; leave one out"
            )


def go_on(
    output: Path, workers: int, cluster: str | None, progress: StudyProgress, trust: bool = False
) -> Study:
    """Go on with the interrupted study of a file, with the samples that it lacks; StudyError where there is none.

    trust: the files of data that it names may be opened.
    """
    journal, asked, samples = Journal.resume(output)
    with journal:
        if trust:
            trust_data(data_files(asked["tree"]))
        task = _task_of(asked)
        refuse_changed(output, task.scene, asked.get("files", {}))
        found = _carried_out(task, asked, samples, journal, workers, cluster, progress)
        return _saved(output, journal, found)


def _carried_out(
    task: Task,
    asked: Asked,
    samples: list[Sample],
    journal: Journal | None,
    workers: int,
    cluster: str | None,
    progress: StudyProgress,
) -> Study:
    done = {one.index for one in samples}
    jobs = [job for job in _jobs(task, plan_of(asked)) if job[0] not in done]
    pool: Pool = dask(cluster) if cluster else local
    if workers < 1:
        raise StudyError(f"{workers} workers do no work; give one at least")
    name = f"{asked['tree']['scene']['name']}: {len(done) + len(jobs)} runs"
    with progress(name, len(done) + len(jobs)) as show:
        failed = sum(bool(one.message) for one in samples)
        show(len(samples), failed)
        here = workers == 1 and cluster is None
        found = (
            map(lambda job: run_sample(task, *job), jobs) if here else carried_out(task, jobs, workers, pool)
        )
        try:
            for sample in found:
                samples.append(sample)
                if journal is not None:
                    journal.append(sample)
                failed += bool(sample.message)
                show(len(samples), failed)
        except (CancelledError, OSError) as error:
            if cluster is None:
                raise
            raise StudyError(_lost_scheduler(cluster, journal)) from error
    return Study.of(asked, samples)


def _lost_scheduler(address: str, journal: Journal | None) -> str:
    """What has happened to a cluster, and how its study goes on."""
    on = "begin it again" if journal is None else f"go on with `fanfold study {journal.study}`"
    return f"{address}: the Dask scheduler no longer answers; {on}, with --cluster once it runs again"


def _saved(output: Path, journal: Journal, study: Study) -> Study:
    study.save_csv(output.with_suffix(".csv"))
    path = study.save(output)
    journal.remove()
    return with_values(study, path=path)


def _jobs(task: Task, plan: Plan) -> list[Job]:
    """Every sample with its settings; StudyError where the scene has nothing to multiply."""
    tree = task.scene.tree
    return [(index, _settings(tree, plan, row)) for index, row in enumerate(plan.samples().tolist())]


def _settings(tree: Tree, plan: Plan, values: Sequence[float]) -> Settings:
    """What drawn values mean in a scene's tree; keys that vary together are one."""
    settings: Settings = {}
    for one, value in zip(plan.varied, values, strict=True):
        settings |= one.settings(tree, value)
    return settings


def asked_of(task: Task, plan: Plan) -> dict[str, Any]:
    """What a study is asked for, as JSON holds it."""
    scene = task.scene.check()
    return {
        **task.options.asked(scene, task.estimate),
        "tolerance": task.options.tolerance or scene.header.tolerance,
        "signals": list(task.signals),
        "points": task.points,
        "until": task.until,
        "varied": [one.text for one in plan.varied],
        "method": plan.method,
        "runs": plan.runs,
        "levels": plan.levels,
        "seed": plan.seed,
        "files": digests(scene),
    }


def _task_of(asked: Asked) -> Task:
    scene = Scene.of_tree(asked["file"], asked["tree"], of_result=True)
    options = Options(**asked["options"])
    return Task(scene, options, asked["estimate"], tuple(asked["signals"]), asked["points"])
