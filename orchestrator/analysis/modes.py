"""Normal modes of a scene in a configuration: frequencies, damping, effective masses, the bodies that move.

About static equilibrium (lines that are not latched are held for it, then free), with preload and geometric
stiffness of the connections; without friction. Modal damping is the diagonal of the modal damping matrix.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import isnan
from pathlib import Path
from typing import Any, NamedTuple

import click
from rich.console import Console

from ..cli.options import SceneChoice, refuse_idle, scene_choice
from ..cli.types import Count
from ..scene import Scene
from ._configuration import ConfigurationChoice, as_posed_option, configuration_choice, scene_model
from ._linear import (
    LinearModel,
    NormalModes,
    damping_shares,
    effective_masses,
    kinetic_shares,
    modal_damping,
    normal_modes,
)
from ._tables import plain_table

_ROUNDED_UP = (9.995, 99.95)
"""%: from here on two decimals, and one, take more than four characters"""

_SMALLEST_SHARE = 1e-3
_TOLD = 4
"""What damps a mode, in a sentence."""

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
"""Translations along, then rotations about the world axes."""


class Mode(NamedTuple):
    """One mode that is no free motion."""

    number: int
    """from 1, free motions counted before"""
    frequency: float
    """Hz; negative: the growth rate of an unstable motion over 2 pi"""
    damping_ratio: float
    effective_mass_fractions: tuple[float, ...]
    """in `DIRECTIONS` of the base, rotations about its reference point"""
    body: str
    """with the largest share in the kinetic energy"""
    share: float
    damping_shares: Mapping[str, float]
    """of what damps it, by body and connection, the largest first"""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "mode": self.number,
            "frequency_hz": self.frequency,
            "damping_ratio": None if isnan(self.damping_ratio) else self.damping_ratio,
            "damping_share": dict(self.damping_shares),
            "effective_mass_fraction": dict(zip(DIRECTIONS, self.effective_mass_fractions, strict=True)),
            "body": self.body,
            "kinetic_energy_share": self.share,
        }


def mode_table(model: LinearModel, modes: NormalModes, count: int) -> list[Mode]:
    """The first modes beyond the free motions; an unstable one comes first."""
    damping = modal_damping(model, modes)
    effective, total = effective_masses(model, modes)
    shares, losses = kinetic_shares(model, modes), damping_shares(model, modes)
    found: list[Mode] = []
    for k, frequency in enumerate(modes.frequencies.tolist()):
        if modes.is_free[k] or len(found) == count:
            continue
        body = max(shares, key=lambda name: float(shares[name][k]))
        fractions = tuple((effective[:, k] / total).tolist())
        share, damped_by = float(shares[body][k]), _largest({name: float(s[k]) for name, s in losses.items()})
        found.append(Mode(k + 1, frequency, float(damping[k]), fractions, body, share, damped_by))
    return found


def _largest(shares: Mapping[str, float]) -> dict[str, float]:
    """Shares of a thousandth and more, in their order."""
    ordered = sorted(shares.items(), key=lambda item: -item[1])
    return {name: share for name, share in ordered if share >= _SMALLEST_SHARE}


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
        from ..views.linear import draw_shapes  # matplotlib takes its time

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
