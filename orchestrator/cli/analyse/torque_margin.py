"""`fanfold analyse torque-margin`: margins of every hinge line by case, and restarts from where it was stopped."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

import click
from rich.console import Console

from ...analysis.torque_margin.margins import find_margins
from ...analysis.torque_margin.restart import CaseRestart, restart, restart_share
from ...analysis.torque_margin.rules import DEMANDS, FACTORS, LIMIT, FactorKind, Found
from ...analysis.torque_margin.sweep import FrictionKind, driven_lines
from ...analysis.torque_margin.undriven import without_margin
from ...scene import Scene, SceneError, scene_variants
from ..options import SceneChoice, layered_scene, ordered_names, refuse_idle
from ..progress import progress
from ..types import Count, Number, given_quantity
from ._torque_margin_tables import margin_table, restart_table, sentences_without_margin

_BASE, _COLD = "base", "cold"
_SYMBOLS = (*FACTORS["theoretical"], *DEMANDS)


def load_cases(choice: SceneChoice, names: tuple[str, ...]) -> dict[str, Scene]:
    """Scenes by case: the variants named, "base" for none; by default the scene, and its variant "cold" if any."""
    known = scene_variants(choice.file)
    if not names:
        has_cold = _COLD in known and _COLD not in choice.variants
        names = (_BASE, _COLD) if has_cold else (_BASE,)
    own = _BASE in known
    return {
        name: (choice if name == _BASE and not own else choice.with_variant(name)).load() for name in names
    }


def _extra_torques(
    _: click.Context, __: click.Parameter, given: tuple[str, ...]
) -> dict[str, dict[str, float]]:
    """Further torques (N.m) by line and symbol; every torque has its unit."""
    found: dict[str, dict[str, float]] = {}
    for text in given:
        key, equals, value = text.partition("=")
        line, dot, symbol = key.partition(".")
        if not (equals and dot and symbol in _SYMBOLS):
            raise click.BadParameter(
                f"{text!r} is not of the form LINE.SYMBOL=TORQUE with a symbol of {', '.join(_SYMBOLS)}"
            )
        if symbol in found.get(line, {}):
            raise click.BadParameter(f"{key} is given twice; add the torques up")
        found.setdefault(line, {})[symbol] = given_quantity(value, "N.m", key, "zero or positive")
    return found


@click.command("torque-margin")
@layered_scene
@click.option(
    "--case", "names", default="", callback=ordered_names, metavar="NAMES",
    help="Variants to analyse beside each other, base for none; by default base and cold, if there is a cold one.",
)  # fmt: skip
@click.option(
    "--factors", type=click.Choice(list(FACTORS)), default="theoretical", show_default=True,
    help="Uncertainty factors of ECSS table 4-2; measured ones need an approved test.",
)  # fmt: skip
@click.option(
    "--friction", type=click.Choice(["constant", "sliding", "static"]), default="sliding", show_default=True,
    help="The preload torque alone, or with friction of the reactions, sliding or static.",
)  # fmt: skip
@click.option(
    "--torque", "extra", multiple=True, callback=_extra_torques, metavar="LINE.SYMBOL=TORQUE",
    help=f"Further torque of a line with its unit, such as HL2.HY=0.02N.m; symbols of ECSS {', '.join(_SYMBOLS)}; "
    "repeatable.",
)  # fmt: skip
@click.option(
    "--positions", type=Count(min=2, max=10_000), default=19, show_default=True,
    help="Positions of the travel, its ends included.",
)  # fmt: skip
@click.option(
    "--restart", "restarts", default="", callback=ordered_names, metavar="POSITIONS",
    help="Run from rest at these, such as 25%,50% of the travel, or 45deg of the first line with a motor.",
)  # fmt: skip
@click.option(
    "--until", type=Number(min=0.0, min_open=True), metavar="SECONDS",
    help="End time of restarts; by default that of the scene.",
)  # fmt: skip
@click.option(
    "--output", type=click.Path(path_type=Path, file_okay=False),
    help="Folder for pictures and runs; by default named after the scene.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    names: tuple[str, ...],
    factors: FactorKind,
    friction: FrictionKind,
    extra: dict[str, dict[str, float]],
    positions: int,
    restarts: tuple[str, ...],
    until: float | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Torque margin of every hinge line of SCENE over its travel, limit 2; bodies are rigid."""
    refuse_idle("--until", "--restart")
    choice.load_one_run()  # refuses a scene whose phases differ
    cases = load_cases(choice, names)
    _refuse_unknown_lines(cases, extra)
    shares = {case: _restart_shares(one, restarts) for case, one in cases.items()}
    found = find_margins(cases, positions, factors, friction, extra)
    folder = output or Path(".".join((next(iter(cases.values())).header.name, *choice.variants)))
    folder.mkdir(parents=True, exist_ok=True)
    pictures = _draw(folder, found)
    without = {case: without_margin(one) for case, one in cases.items()}
    if not as_json:
        console = Console()
        console.print(margin_table(found, factors, friction))
        for sentence in sentences_without_margin(without):
            console.print(sentence, highlight=False)
        for path in pictures:
            click.echo(path)
    runs = [
        _run(folder, case, cases[case], text, share, until)
        for case, positions_ in shares.items()
        for text, share in positions_.items()
    ]
    if as_json:
        click.echo(json.dumps(_as_dict(found, factors, friction, without, runs)))
    elif runs:
        console.print(restart_table(runs))
        for run in runs:
            click.echo(run.path)


def _run(
    folder: Path, case: str, scene: Scene, position: str, share: float, until: float | None
) -> CaseRestart:
    path = folder / f"restart_{case}_{_percent(share)}.h5"
    with progress(f"{case} from {position}", until or scene.header.until) as watch:
        return CaseRestart(case, position, path, restart(scene, share, path, until, watch))


def _percent(share: float) -> str:
    """How a position is called in the name of a file."""
    return f"{100.0 * share:.4g}"


def _restart_shares(scene: Scene, positions: Sequence[str]) -> dict[str, float]:
    """Share of the travel by position; SceneError where two of them are the same, whose files would be one."""
    shares: dict[str, float] = {}
    for text in positions:
        share = restart_share(scene, text)
        same = next((other for other, known in shares.items() if _percent(known) == _percent(share)), None)
        if same is not None:
            raise SceneError([f"{scene.file}: the restarts from {same} and {text} are the same; give one"])
        shares[text] = share
    return shares


def _refuse_unknown_lines(cases: Mapping[str, Scene], extra: Mapping[str, object]) -> None:
    for case in cases.values():
        known = [line.name for line in driven_lines(case)]
        problems = [
            f"{case.file}: there is no hinge line {name!r} with a motor; lines are {', '.join(known)}"
            for name in extra
            if name not in known
        ]
        if problems:
            raise SceneError(problems)


def _as_dict(
    found: Sequence[Found],
    factors: FactorKind,
    friction: FrictionKind,
    without: Mapping[str, Mapping[str, str]],
    runs: Sequence[CaseRestart],
) -> dict[str, object]:
    return {
        "factors": factors,
        "friction": friction,
        "limit": LIMIT,
        "margins": [row for one in found for row in one.as_dicts()],
        "without_margin": [
            {"case": case, "line": line, "reason": reason}
            for case, reasons in without.items()
            for line, reason in reasons.items()
        ],
        "restarts": [
            {
                "case": run.case,
                "position": run.position,
                "output": str(run.path),
                **asdict(line),
                "opens": line.opens,
            }
            for run in runs
            for line in run.lines
        ],
    }


def _draw(folder: Path, found: Sequence[Found]) -> list[Path]:
    from ...views.torque_margin import draw_line  # matplotlib takes its time, which --help need not

    paths = []
    for line in dict.fromkeys(one.line for one in found):
        paths.append(folder / f"torque_margin_{line}.png")
        cases = [(one.case, one.torques, one.margins) for one in found if one.line == line]
        draw_line(paths[-1], f"{line}: torque margin over the travel", cases)
    return paths
