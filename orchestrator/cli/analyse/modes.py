"""`fanfold analyse modes`: natural frequencies, damping and effective masses of a configuration."""

from __future__ import annotations

import json
from pathlib import Path

import click
from rich.console import Console

from ...analysis.modes import DIRECTIONS, Mode, mode_table
from ...analysis.statics.configuration import scene_model
from ...analysis.statics.linear_model import normal_modes
from ...scene import Scene
from ..options import SceneChoice, refuse_idle, scene_choice
from ..tables import plain_table
from ..types import Count
from ._configuration import ConfigurationChoice, as_posed_option, configuration_choice

_ROUNDED_UP = (9.995, 99.95)
"""%: from here on two decimals, and one, take more than four characters"""

_TOLD = 4
"""What damps a mode, in a sentence."""


@click.command("modes")
@scene_choice
@configuration_choice
@as_posed_option
@click.option("--count", type=Count(min=1), default=15, show_default=True, help="Modes to list.")
@click.option(
    "--plot", type=click.Path(path_type=Path, file_okay=False), help="Folder for pictures of mode shapes."
)
@click.option(
    "--shapes", type=Count(min=1), default=4, show_default=True, help="Mode shapes to draw, with --plot."
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    wanted: ConfigurationChoice,
    as_posed: bool,
    count: int,
    plot: Path | None,
    shapes: int,
    as_json: bool,
) -> None:
    """Natural frequencies, damping and effective masses of SCENE in a configuration."""
    refuse_idle("--shapes", "--plot")
    scene = choice.load_one_run()
    target = wanted.of(scene)
    model = scene_model(scene, choice.rigid, choice.flexible, target, as_posed)
    modes = normal_modes(model)
    listed = mode_table(model, modes, count)
    free = int(modes.is_free.sum())
    force, torque = model.unbalanced
    if as_json:
        content = {
            "scene": scene.header.name,
            "angles_rad": dict(target.angles),
            "latched": list(target.latched),
            "unbalanced_force_n": force,
            "unbalanced_torque_nm": torque,
            "free_motions": free,
            "structural_damping": _structural(scene),
            "modes": [mode.as_dict() for mode in listed],
        }
        click.echo(json.dumps(content))
    else:
        _print(listed, free, force, torque)
        _print_damping(listed, scene)
    if plot is not None:
        from ...views.linear import draw_shapes  # matplotlib takes its time

        for path in draw_shapes(plot, model, modes, [mode.number - 1 for mode in listed[:shapes]]):
            click.echo(path, err=as_json)


def _print(modes: list[Mode], free: int, force: float, torque: float) -> None:
    table = plain_table("normal modes; effective masses in % of the rigid ones")
    table.add_column("mode", justify="right", no_wrap=True)
    table.add_column("freq.,\nHz", justify="right", min_width=7)
    table.add_column("damp.,\n%", justify="right", min_width=6, no_wrap=True)
    for heading in DIRECTIONS:
        table.add_column(heading, justify="right", min_width=4, no_wrap=True)
    table.add_column("moves most")
    for mode in modes:
        masses = (_percent(fraction) for fraction in mode.effective_mass_fractions)
        frequency = f"{mode.frequency:.5g}" if mode.frequency > 0.0 else f"unstable, {-mode.frequency:.3g}"
        damping = f"{100.0 * mode.damping_ratio:.3g}"
        table.add_row(f"{mode.number}", frequency, damping, *masses, f"{mode.body} {mode.share:.0%}")
    console = Console()
    console.print(table)
    console.print(
        f"{free} free motions (0 Hz); nothing balances {force:.3g} N and {torque:.3g} N.m in this configuration"
    )


def _structural(scene: Scene) -> dict[str, float] | None:
    """The scene's structural damping for JSON."""
    if scene.structural_damping is None:
        return None
    structural = scene.structural_damping
    return {"ratio": structural.ratio, "reference_frequency_hz": structural.reference_frequency}


def _print_damping(modes: list[Mode], scene: Scene) -> None:
    """What damps the first mode, and by which rule."""
    console = Console()
    if modes and modes[0].damping_shares:
        told = list(modes[0].damping_shares.items())[:_TOLD]
        console.print(f"mode {modes[0].number} is damped by " + ", ".join(f"{n} {s:.0%}" for n, s in told))
    if scene.structural_damping is not None:
        ratio, reference = scene.structural_damping.ratio, scene.structural_damping.reference_frequency
        console.print(
            f"structural damping: {100.0 * ratio:.3g} % at {reference:.4g} Hz, in proportion to frequency"
        )


def _percent(fraction: float) -> str:
    """Four characters at most, as a negative fraction there is none."""
    percent = 100.0 * fraction
    decimals = next((2 - k for k, limit in enumerate(_ROUNDED_UP) if percent < limit), 0)
    return f"{percent:.{decimals}f}"
