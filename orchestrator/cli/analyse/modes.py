"""`fanfold analyse modes`: natural frequencies, damping and effective masses of a configuration."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...analysis.vibration import DIRECTIONS
from ...api.options import Folder, Positive
from ..command import Asked, made_of
from ._configuration import ANGLES

if TYPE_CHECKING:
    from ...analysis.modes import Modes
    from ...scene.builder import Scene

_ROUNDED_UP = (9.995, 99.95)
"""%: from here on two decimals, and one, take more than four characters"""

_BASES = {"fixed": "base fixed", "held": "free base held", "free": "base free"}

_LISTED = 4
"""Longest list in a sentence."""


@made_of("modes", name="modes", angles=ANGLES, shapes={"needs": "plot"}, plot={"flags": "-o --plot"})
def command(
    scene: Scene, asked: Asked, plot: Folder | None = None, shapes: Positive = 4, as_json: bool = False
) -> None:
    """Natural frequencies, damping and effective masses of SCENE in a configuration.

    Options
    -------
    plot
        folder for pictures of mode shapes
    shapes
        number of mode shapes to draw, with `plot`
    """
    found = fanfold.modes(scene, **asked["modes"])
    if as_json:
        click.echo(json.dumps(found.as_dict()))
    else:
        _print(found)
        _print_damping(found)
        _print_spacing(found)
    if plot is not None:
        from ...views.linear import plot_modes  # matplotlib takes its time

        for path in plot_modes(found, Path(plot), shapes):
            click.echo(path, err=as_json)


def _print(found: Modes) -> None:
    from ..tables import table_of, terminal

    with_masses = found.base != "free" and not found.turns
    words = "; effective masses in % of the rigid-body masses" if with_masses else ""
    body = "dominant body,\n% of kinetic energy"
    rows = []
    for mode in found.listed:
        masses = (_percent(fraction) for fraction in mode.effective_mass_fractions if with_masses)
        frequency = f"{mode.frequency:.5g}" if mode.frequency > 0.0 else f"unstable, {-mode.frequency:.3g}"
        damping = f"{100.0 * mode.damping_ratio:.3g}"
        rows.append((f"{mode.number}", frequency, damping, *masses, f"{mode.body} {100.0 * mode.share:.0f}"))
    headings = ("mode", "freq.,\nHz", "damp.,\n%", *(DIRECTIONS if with_masses else ()), body)
    table = table_of(f"normal modes, {_BASES[found.base]}{words}", headings, rows, (body,))
    console = terminal()
    console.print(table)
    console.print(str(found.configuration))
    if found.turns:
        console.print("Modes of a steady spin have no effective mass, because their axes rotate.")
    elif not with_masses:
        console.print("A free-free system has no effective mass; use --base held.")
    force, torque = found.unbalanced
    console.print(
        f"{found.free_motions} rigid-body modes (0 Hz). Residual of the static equilibrium: {force:.3g} N, "
        f"{torque:.3g} N.m."
    )


def _print_damping(found: Modes) -> None:
    """What damps the first mode, and the structural damping rule."""
    from ..tables import terminal

    console, modes, structural = terminal(), found.listed, found.structural_damping
    if modes and modes[0].damping_shares:
        words = list(modes[0].damping_shares.items())[:_LISTED]
        console.print(f"mode {modes[0].number} is damped by " + ", ".join(f"{n} {s:.0%}" for n, s in words))
    coupled = [f"{mode.number}" for mode in modes if mode.coupled_by_damping]
    if coupled:
        console.print(
            f"damping couples mode{'s' * (len(coupled) > 1)} {', '.join(coupled)} with others, so their damping "
            "ratios are approximate; `analyse frequency-response` and `appendage` include the coupling"
        )
    if structural is not None:
        ratio, reference = structural.ratio, structural.reference_frequency
        console.print(
            f"structural damping: {100.0 * ratio:.3g} % at {reference:.4g} Hz, proportional to frequency"
        )


def _print_spacing(found: Modes) -> None:
    """Pairs of modes whose responses a root sum square would underestimate."""
    from ..tables import terminal

    pairs = [
        f"{low.number} and {high.number} (beat period {1.0 / (high.frequency - low.frequency):.3g} s)"
        for low, high in found.closely_spaced[:_LISTED]
    ]
    if pairs:
        terminal().print(f"closely spaced modes, which beat: {', '.join(pairs)}")


def _percent(fraction: float) -> str:
    """Four characters at most, as a negative fraction there is none."""
    percent = 100.0 * fraction
    decimals = next((2 - k for k, limit in enumerate(_ROUNDED_UP) if percent < limit), 0)
    return f"{percent:.{decimals}f}"
