"""Torque margin of every hinge line over its travel, and proof that the array restarts when stopped midway.

Quasi-static: driving over resisting torques at rest, resistances with uncertainty factors; two rules, limit 2
(`_torque_margin_rules`). What other connections do about a line is not counted: cable loops pass torque from line
to line, dampers give none at rest.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from ..cli_options import Number, ordered_names, scene_layers, scene_of_one_run
from ..cli_progress import progress
from ..scene import Scene, SceneError, find_scene, load_scene, scene_variants
from ..units import to_si
from ._torque_margin_restart import Restart, restart, restart_share
from ._torque_margin_rules import DEMANDS, FACTORS, LIMIT, RULES, FactorKind, LineTorques, Margins, margins
from ._torque_margin_sweep import FrictionKind, driven_lines, sweep

_BASE, _COLD = "base", "cold"
_SYMBOLS = (*FACTORS["theoretical"], *DEMANDS)


@dataclass(frozen=True)
class Found:
    """The margins of one line in one case, by rule."""

    case: str
    torques: LineTorques
    margins: tuple[Margins, ...]

    @property
    def line(self) -> str:
        """Name of the line."""
        return self.torques.line

    def as_dicts(self) -> Iterator[dict[str, object]]:
        """One plain record per rule, at the worst angle; None for a margin without bound."""
        for found in self.margins:
            k = found.worst
            margin = float(found.margin[k])
            yield {
                "line": self.line,
                "case": self.case,
                "rule": found.rule,
                "margin": margin if np.isfinite(margin) else None,
                "angle": float(self.torques.angle[k]),
                "motor_torque": float(self.torques.motor[k]),
                "harness_torque": float(self.torques.harness[k]),
                "friction_torque": float(self.torques.friction[k]),
                "available": float(found.available[k]),
                "resisting": float(found.resisting[k]),
                "required": float(found.required[k]),
                "passes": found.passes,
            }


def find_margins(
    cases: Mapping[str, Scene],
    positions: int,
    factors: FactorKind = "theoretical",
    friction: FrictionKind = "sliding",
    extra: Mapping[str, Mapping[str, float]] | None = None,
) -> list[Found]:
    """Margins of every line of every case at equally spaced positions of the travel, its ends included."""
    shares = np.linspace(0.0, 1.0, positions).tolist()
    return [
        Found(case, torques, tuple(margins(torques, rule, FACTORS[factors]) for rule in RULES))
        for case, scene in cases.items()
        for torques in sweep(scene, shares, friction, extra or {})
    ]


def load_cases(
    file: Path, variants: tuple[str, ...], settings: Sequence[str], names: tuple[str, ...]
) -> dict[str, Scene]:
    """Scenes by case: the variants named, "base" for none; by default the scene, and its variant "cold" if any."""
    if not names:
        has_cold = _COLD in scene_variants(file) and _COLD not in variants
        names = (_BASE, _COLD) if has_cold else (_BASE,)
    own = _BASE in scene_variants(file)
    return {
        name: load_scene(file, variants if name == _BASE and not own else (*variants, name), settings)
        for name in names
    }


def _extra_torques(
    _: click.Context, __: click.Parameter, given: tuple[str, ...]
) -> dict[str, dict[str, float]]:
    """Further torques by line and symbol."""
    found: dict[str, dict[str, float]] = {}
    for text in given:
        key, equals, value = text.partition("=")
        line, dot, symbol = key.partition(".")
        if not (equals and dot and symbol in _SYMBOLS):
            raise click.BadParameter(
                f"{text!r} is not of the form LINE.SYMBOL=TORQUE with a symbol of {', '.join(_SYMBOLS)}"
            )
        try:
            found.setdefault(line, {})[symbol] = to_si(_number_or_text(value), "N.m", "zero or positive")
        except ValueError as error:
            raise click.BadParameter(f"{key} {error}") from None
    return found


def _number_or_text(value: str) -> float | str:
    """A plain number is in SI units; a text has its unit."""
    try:
        return float(value)
    except ValueError:
        return value


@click.command("torque-margin")
@click.argument("scene")
@scene_layers
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
    help=f"Further torque of a line, such as HL2.HY=0.02; {', '.join(_SYMBOLS)}; repeatable.",
)  # fmt: skip
@click.option(
    "--positions", type=click.IntRange(min=2), default=19, show_default=True,
    help="Positions of the travel, its ends included.",
)  # fmt: skip
@click.option(
    "--restart", "restarts", default="", callback=ordered_names, metavar="POSITIONS",
    help="Run from rest at these, such as 25%,50% of the travel, or 45deg of the first line.",
)  # fmt: skip
@click.option("--until", type=Number(min=0.0, min_open=True), help="End time of restarts in seconds.")
@click.option(
    "--output", type=click.Path(path_type=Path, file_okay=False), help="Folder for pictures and runs."
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    scene: str,
    variants: tuple[str, ...],
    settings: tuple[str, ...],
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
    scene_of_one_run(scene, variants, settings)  # refuses a scene whose phases differ
    cases = load_cases(find_scene(scene), variants, settings, names)
    _refuse_unknown_lines(cases, extra)
    shares = {case: [restart_share(one, text) for text in restarts] for case, one in cases.items()}
    found = find_margins(cases, positions, factors, friction, extra)
    folder = output or Path(".".join((next(iter(cases.values())).header.name, *variants)))
    folder.mkdir(parents=True, exist_ok=True)
    pictures = _draw(folder, found)
    runs = []
    for case, one in cases.items():
        for text, share in zip(restarts, shares[case], strict=True):
            path = folder / f"restart_{case}_{100.0 * share:.4g}.h5"
            with progress(f"{case} from {text}", until or one.header.until) as watch:
                runs.append((case, text, path, restart(one, share, path, until, watch)))
    if as_json:
        click.echo(json.dumps(_as_dict(found, factors, friction, runs)))
        return
    console = Console()
    console.print(_margin_table(found, factors, friction))
    if runs:
        console.print(_restart_table(runs))
    for path in (*pictures, *(path for _, _, path, _ in runs)):
        click.echo(path)


_Run = tuple[str, str, Path, list[Restart]]


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
    found: Sequence[Found], factors: FactorKind, friction: FrictionKind, runs: Sequence[_Run]
) -> dict[str, object]:
    return {
        "factors": factors,
        "friction": friction,
        "limit": LIMIT,
        "margins": [row for one in found for row in one.as_dicts()],
        "restarts": [
            {"case": case, "position": text, "output": str(path), **asdict(line), "opens": line.opens}
            for case, text, path, lines in runs
            for line in lines
        ],
    }


def _margin_table(found: Sequence[Found], factors: FactorKind, friction: FrictionKind) -> Table:
    table = Table(
        title=f"Torque margin at the worst angle, limit {LIMIT:g}; {factors} factors, {friction} friction"
    )
    for name in ("line", "case", "rule"):
        table.add_column(name)
    for name in ("margin", "at, deg", "driving, N.m", "resisting, N.m"):
        table.add_column(name, justify="right")
    table.add_column("verdict")
    for one in sorted(found, key=lambda one: one.line):
        for margins_ in one.margins:
            k = margins_.worst
            table.add_row(
                one.line, one.case, margins_.rule,
                f"{margins_.margin[k]:.3f}", f"{np.rad2deg(one.torques.angle[k]):.1f}",
                f"{margins_.available[k]:.4f}", f"{margins_.resisting[k]:.4f}",
                "passes" if margins_.passes else "FAILS",
            )  # fmt: skip
    return table


def _restart_table(runs: Sequence[_Run]) -> Table:
    table = Table(title="Restart from rest")
    for name in ("case", "position", "line"):
        table.add_column(name)
    for name in ("from, deg", "to, deg", "fastest, deg/s", "open at, s"):
        table.add_column(name, justify="right")
    table.add_column("verdict")
    for case, text, _, lines in runs:
        for line in lines:
            at = "" if line.opened_at is None else f"{line.opened_at:.4f}"
            verdict = "opens" if line.opens else "moves, DOES NOT OPEN" if line.moves else "DOES NOT MOVE"
            start, end, fastest = np.rad2deg((line.start, line.end, line.fastest))
            table.add_row(case, text, line.line, f"{start:.2f}", f"{end:.2f}", f"{fastest:.3g}", at, verdict)
    return table


def _draw(folder: Path, found: Sequence[Found]) -> list[Path]:
    from ._torque_margin_figures import draw_line  # matplotlib takes its time, which --help need not

    paths = []
    for line in dict.fromkeys(one.line for one in found):
        paths.append(folder / f"torque_margin_{line}.png")
        cases = [(one.case, one.torques, one.margins) for one in found if one.line == line]
        draw_line(paths[-1], f"{line}: torque margin over the travel", cases)
    return paths
