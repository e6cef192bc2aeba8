"""`fanfold analyse mode-study`: how many fixed-interface modes a body needs, by latch-up and by frequencies."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from ...analysis.mode_study import Frequencies, Vector, frequencies
from ...cosim.master import Settings
from ...run.run import RunError
from ...scene import Scene
from ...scene.body_tables import Body
from ...scene.locked_groups import held_bodies
from ..options import SceneChoice, scene_choice
from ..tables import Column, tables_that_fit
from ._latch_study import LatchStudy, run_case, study_options


def frequency_tables(name: str, found: Frequencies, width: int) -> Iterator[Table]:
    """Fixed-interface and free frequencies of the full model, and errors of the free ones of every reduced body.

    width: of the terminal, in characters.
    """
    count = len(found.free)
    fixed = [
        Column("mode", [str(k + 1) for k in range(count)]),
        Column("clamped,\nHz", [f"{value:.4f}" for value in found.fixed]),
        Column("free,\nHz", [f"{value:.4f}" for value in found.free]),
    ]
    reduced = [
        Column(f"{_modes(kept)},\n%", [_error(values, found.free, k) for k in range(count)])
        for kept, values in found.reduced.items()
    ]
    return tables_that_fit(
        f"{name}: full model, and errors of the reduced body's\nfree frequencies by modes kept",
        fixed,
        reduced,
        width,
    )


def _modes(count: int) -> str:
    return f"{count} mode{'s' * (count != 1)}"


def _error(values: Vector, free: Vector, k: int) -> str:
    """Error (%) of a frequency of the reduced body, where it has that many."""
    return f"{100.0 * (values[k] / free[k] - 1.0):+.3g}" if k < len(values) else ""


def _body(scene: Scene, name: str | None, rigid: Collection[str]) -> Body:
    """The named body of the catalogue, or the only one that --rigid leaves; held lines leave a body no modes."""
    held = held_bodies(scene)
    bodies = {
        body.name: body for body in scene.bodies if body.catalogue is not None and body.name not in held
    }
    left = [body for body in bodies if not {body, "all"} & set(rigid)]
    if name is None and len(left) == 1:
        return bodies[left[0]]
    if not bodies or (name is None and left) or (name is not None and name not in bodies):
        known = ", ".join(left or bodies) or "none"
        raise RunError(
            f"{scene.file}: name the body to study with --body; bodies that can have modes are {known}"
        )
    studied = name or next(iter(bodies))
    if studied not in left:
        others = ",".join(body for body in bodies if body != studied)
        advice = (
            f"make only others rigid: --body {studied} --rigid {others}" if others else "leave --rigid out"
        )
        whose = f"{name} has no modes" if name else "no body has modes"
        raise RunError(f"{scene.file}: with this --rigid {whose} to count; {advice}")
    return bodies[studied]


def _counts(_: click.Context, param: click.Parameter, value: str) -> tuple[int, ...]:
    try:
        counts = tuple(sorted({int(text) for text in value.split(",")}))
    except ValueError:
        raise click.BadParameter("give whole numbers with commas between", param=param) from None
    if counts[0] < 0 or len(counts) < 2:
        raise click.BadParameter("give at least two different numbers of modes, none negative", param=param)
    return counts


@click.command("mode-study")
@scene_choice
@click.option("--body", metavar="BODY", help="Body whose modes are counted; needed where there are several.")
@click.option(
    "--modes", "counts", default="2,3,4,5,10,20,30", show_default=True, callback=_counts, metavar="N,N,...",
    help="Numbers of fixed-interface modes; the largest is the reference.",
)  # fmt: skip
@study_options("mode-study", "runs")
def command(
    choice: SceneChoice,
    body: str | None,
    counts: tuple[int, ...],
    tolerance: float | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Latch-up of SCENE against the number of a body's fixed-interface modes."""
    scene = choice.load_one_run()
    studied = _body(scene, body, choice.rigid)
    choice = replace(choice, flexible=choice.flexible | {studied.name})
    assemblies = {
        count: choice.assemble(choice.load(f"body.{studied.name}.fixed_interface_modes={count}"))
        for count in counts
    }
    folder = output or Path(f"{scene.header.name}.mode-study")
    folder.mkdir(parents=True, exist_ok=True)
    cases = []
    for count, assembly in assemblies.items():
        numbers = Settings(tolerance or assembly.tolerance, assembly.largest_step)
        path = folder / f"{count}_modes.h5"
        cases.append(run_case(_modes(count), count, assembly, path, numbers, assembly.until))
    study = LatchStudy(scene.header.name, folder, cases)
    found = frequencies(studied, counts)
    most = study.reference.label
    study.draw(
        f"Latch-up with modes of {studied.name}", f"{most} of {studied.name}", "fixed-interface modes", 0.5
    )
    if as_json:
        content = {
            "body": studied.name,
            "cases": study.as_dict(),
            "fixed_interface_hz": found.fixed.tolist(),
            "free_hz": found.free.tolist(),
            "reduced_free_hz": {str(k): v.tolist() for k, v in found.reduced.items()},
        }
        click.echo(json.dumps(content))
        return
    console = Console()
    study.print(console, most, frequency_tables(studied.name, found, console.width))
