"""`fanfold study`: run a scene many times with parameters drawn from distributions."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import floor, log10
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ..api.options import Folder, OutputFile
from .command import Asked, SceneChoice, made_of, usual_file

if TYPE_CHECKING:
    from rich.table import Table

    from ..analysis.sampling.influence import Influence
    from ..api.study import Study

_LINES = 12
"""Failed samples that are listed one by one."""
_SENSITIVE = "most sensitive to"
_LEAST_ROOM = 20
"""Columns that the end of a key takes in any table."""


@made_of(
    "study",
    name="study",
    vary={"metavar": "KEY=DISTRIBUTION"},
    require={"metavar": "LIMIT"},
    points={"needs": "signals"},
    levels={"needs": "method"},
)
def command(
    choice: SceneChoice,
    asked: Asked,
    vary: Sequence[str] = (),
    save: OutputFile | None = None,
    replace: bool = False,
    plot: Folder | None = None,
    as_json: bool = False,
) -> None:
    """Run SCENE many times with parameters drawn from distributions: Monte Carlo, designs, grids, worst cases.

    Every sample is stored as soon as it is finished. SCENE may also be the file of an interrupted study to continue, or
    of a complete one to print again.

    Options
    -------
    vary
        distribution of a key, such as 'friction.coefficient=uniform(0.05, 0.2)'; 'KEY*=normal(1, 0.03)' is a factor,
        keys separated by commas get the same value; repeatable. A lognormal has its mean and coefficient of variation,
        as in 'lognormal(0.15 N.m, 40 %)'; `fanfold list distributions` lists all
    save
        file of the study (HDF5); by default SCENE.study.h5, or SCENE.rigid.study.h5, as for `fanfold run`
    replace
        replace an existing file, even if it was made with other settings
    plot
        folder for figures
    """
    options = asked["study"]
    if choice.scene.endswith(".h5"):
        if vary or choice.variant or choice.settings:
            raise click.UsageError(
                "a study continues with its own settings; leave out --vary, --variant and --set"
            )
        processes = {name: options[name] for name in ("workers", "cluster")}
        found = fanfold.resume_study(choice.scene, **processes, trust=choice.trust, progress=samples_bar)
    else:
        scene = choice.load()
        path = save or usual_file(scene, options, "study.h5")
        found = fanfold.study(scene, vary, **options, save=path, replace=replace, progress=samples_bar)
    pictures = found.plot_all(plot) if plot else []
    if as_json:
        click.echo(json.dumps({**_content(found), "pictures": [str(one) for one in pictures]}))
    else:
        _report(found, pictures)


@contextmanager
def samples_bar(name: str, count: int) -> Iterator[Callable[[int, int], None]]:
    """A progress bar on standard error: samples, failed ones, time that remains."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[failed]} failed"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), refresh_per_second=5) as bar:
        task = bar.add_task(name, total=count, failed=0)
        yield lambda done, failed: bar.update(task, completed=done, failed=failed)


def _content(study: Study) -> dict[str, object]:
    return {
        "scene": study.scene,
        "samples": len(study.messages),
        "failed": {str(k): message for k, message in study.failed.items()},
        "quantiles": {
            name: dict(zip(("5%", "50%", "95%"), study.quantiles(name).tolist(), strict=True))
            for name in study.numbers
        },
        "extremes": {name: _extremes(study, name) for name in study.numbers},
        "units": {name: study.units.get(name, "") for name in study.numbers},
        "influence": {
            name: _influence(moved) for name in study.numbers if (moved := study.influence(name)) is not None
        },
        "wing_not_opening": wing._asdict() if (wing := study.wing_not_opening()) is not None else None,
        "not_opening": {line: share._asdict() for line, share in study.not_opening().items()},
        "output": str(study.path),
    }


def _extremes(study: Study, name: str) -> dict[str, dict[str, float]]:
    """Lowest and highest value of a number, and the samples that have them."""
    pairs = zip(("lowest", "highest"), study.extremes(name), strict=True)
    return {which: {"value": float(study.numbers[name][k]), "sample": k} for which, k in pairs}


def _influence(moved: Influence) -> dict[str, object]:
    """Changes by parameter and, if available, shares of variance and R2 of the linear fit."""
    found: dict[str, object] = {"changes": moved.changes}
    if moved.shares is not None:
        found["variance_shares"] = {
            name: {"alone": alone, "with_interactions": total}
            for name, (alone, total) in moved.shares.items()
        }
    return found if moved.explained is None else found | {"explained_by_lines": moved.explained}


def _report(study: Study, pictures: list[Path]) -> None:
    from .tables import terminal

    console = terminal()
    console.print(_table(study, console.width))
    if (shares := _shares(study)) is not None:
        console.print(shares)
        console.print(
            f"estimated from {study.plan.runs} base samples; increase --runs for more accurate shares"
        )
    for sentence in _opening(study):
        console.print(sentence, highlight=False)
    failed = list(study.failed.items())
    for index, message in failed[:_LINES]:
        console.print(f"sample {index} failed: {message}")
    if len(failed) > _LINES:
        console.print(f"... and {len(failed) - _LINES} more; see the table of samples")
    assert study.path is not None
    console.print(f"study in {study.path}, table of samples in {study.path.with_suffix('.csv')}")
    if pictures:
        console.print(f"figures: {', '.join(str(one) for one in pictures)}")


def _opening(study: Study) -> Iterator[str]:
    """Sentences on requirements, runs that open, failure probabilities by line, and runs needed for lower bounds."""
    from ..analysis.sampling.study import runs_for

    for requirement, missed in study.requirements_met().items():
        yield f"{requirement}: met in {missed.among - missed.samples} of {missed.among} runs."
    wing = study.wing_not_opening()
    if wing is None:
        return
    confidence = f"; failure probability below {_percent(wing.below)} (95 % confidence)"
    whole = f"The wing opens fully in {wing.among - wing.samples} of {wing.among} runs"
    yield f"{whole}{confidence if study.plan.is_random else ''}."
    for line, share in study.not_opening().items():
        if share.samples:
            interval = (
                f"; failure probability {_percent(share.low)} to {_percent(share.high)} (95 % confidence)"
            )
            failures = f"{line} does not open in {share.samples} of {share.among} runs"
            yield f"{failures}{interval if study.plan.is_random else ''}."
    if study.plan.is_random and not wing.samples:
        decade = floor(log10(wing.below))
        wanted = ((10.0**power, runs_for(10.0**power)) for power in (decade, decade - 1))
        yield " ".join(
            f"A bound of {_percent(bound)} takes {runs:,} runs without a failure." for bound, runs in wanted
        )


def _percent(share: float) -> str:
    """In percent with two digits, such as 1.5 %."""
    return f"{float(f'{100.0 * share:.2g}'):g} %"


def _tail(name: str, room: int) -> str:
    """The end of a long name."""
    return name if len(name) <= room else f"…{name[len(name) - room + 1 :]}"


def _shares(study: Study) -> Table | None:
    """Table of shares of variance, if the samples determine them."""
    from .tables import table_of

    rows = []
    for number in study.main_numbers:
        moved = study.influence(number)
        if moved is not None and moved.shares is not None:
            pairs = (moved.shares[name] for name in study.parameters)
            rows.append((number, *(f"{100 * alone:.1f} / {100 * total:.1f}" for alone, total in pairs)))
    title = "share of variance by parameter, in %: alone / with interactions"
    return table_of(title, ("number", *study.parameters), rows, ("number",)) if rows else None


def _table(study: Study, width: int) -> Table:
    """Headline numbers in at most so many columns, each with the key that it is most sensitive to."""
    from .tables import table_of

    # designs of worst cases have no quantiles, but a worst case
    spread = ("5 %", "median", "95 %") if study.plan.is_random else ("lowest", "sample", "highest", "sample")
    headings = ("number", *spread, "unit", _SENSITIVE)
    rows = []
    for name in study.main_numbers:
        moved = study.influence(name)
        first = moved.ranked[0] if moved is not None and moved.changes else ""
        rows.append((name, *_spread(study, name), study.units[name], first))
    widths = [
        max(map(len, column)) for column in zip(headings[:-1], *(row[:-1] for row in rows), strict=True)
    ]
    room = max(_LEAST_ROOM, width - sum(widths) - 2 * len(headings))
    title = f"{study.scene}: {int(study.finished.sum())} runs, {', '.join(study.parameters)}"
    cells = ((*row[:-1], _tail(row[-1], room)) for row in rows)
    return table_of(title, headings, cells, ("number", "unit", _SENSITIVE))


def _spread(study: Study, name: str) -> list[str]:
    """Quantiles of a number, or its extremes with their samples."""
    if study.plan.is_random:
        return [f"{value:.5g}" for value in study.quantiles(name)]
    return [text for k in study.extremes(name) for text in (f"{study.numbers[name][k]:.5g}", f"{k}")]
