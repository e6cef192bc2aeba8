"""`fanfold analyse frequency-response`: the response to vibration of the base, its resonances and a picture."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...analysis.vibration import DIRECTIONS, INTERFACE, ZERO_FREQUENCY
from ..options import SceneChoice, ordered_names, scene_choice
from ..types import Count, Number, Picture
from ._configuration import ConfigurationChoice, as_posed_option, configuration_choice

if TYPE_CHECKING:
    from ...analysis.frequency_response import FrequencyResponse

_FREQUENCY = Number(min=ZERO_FREQUENCY, max=1e6)
"""Below it the round-off of stiff joints would be stiffer than what moves."""


@click.command("frequency-response")
@scene_choice
@configuration_choice
@as_posed_option
@click.option(
    "--excite", type=click.Choice(DIRECTIONS), default="z", show_default=True,
    help="Acceleration of the base along (x, y, z) or about (rx, ry, rz) an axis.",
)  # fmt: skip
@click.option(
    "--along",
    type=click.Choice(DIRECTIONS),
    help="Direction of the response; by default that of the excitation.",
)
@click.option(
    "--points", multiple=True, default=(INTERFACE,), show_default=True, callback=ordered_names, metavar="NAMES",
    help=(
        "Points BODY.POINT whose acceleration is computed, separated by commas; interface is the load on the base."
    ),
)  # fmt: skip
@click.option(
    "--from", "low", type=_FREQUENCY, default=0.1, show_default=True, metavar="HZ", help="Lowest frequency, in Hz.",
)  # fmt: skip
@click.option(
    "--to", "high", type=_FREQUENCY, default=100, show_default=True, metavar="HZ", help="Highest frequency, in Hz.",
)  # fmt: skip
@click.option(
    "--steps", type=Count(min=2, max=100_000), default=400, show_default=True,
    help="Number of frequencies, in addition to those near resonances.",
)  # fmt: skip
@click.option("-o", "--plot", type=Picture(), metavar="FILE", help="Picture to write.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    wanted: ConfigurationChoice,
    as_posed: bool,
    excite: str,
    along: str | None,
    points: tuple[str, ...],
    low: float,
    high: float,
    steps: int,
    plot: Path | None,
    as_json: bool,
) -> None:
    """Frequency response of SCENE in a configuration to vibration of its base."""
    if high <= low:
        raise click.UsageError(f"--to {high:g} Hz must be above --from {low:g} Hz")
    if not points:
        raise click.UsageError("--points needs points such as panel1.center, or interface")
    found = fanfold.frequency_response(
        choice.load(),
        **wanted.posed,
        **choice.fidelities,
        as_posed=as_posed,
        excite=excite,
        along=along,
        points=points,
        low=low,
        high=high,
        steps=steps,
    )
    if plot is not None:
        from ...views.linear import plot_response  # matplotlib takes its time

        plot_response(found, plot)
    if as_json:
        click.echo(json.dumps(found.as_dict()))
        return
    _print(found)
    click.echo(plot if plot is not None else "--plot FILE draws the curves, --json lists them")


def _print(found: FrequencyResponse) -> None:
    from rich.table import Table

    from ...analysis.frequency_response import peaks
    from ..tables import terminal

    table = Table(title=f"largest resonances, base driven in {found.excitation}")
    for heading in ("output", "unit"):
        table.add_column(heading, no_wrap=True)
    for heading in ("frequency, Hz", "magnitude"):
        table.add_column(heading, justify="right")
    for response in found.responses:
        found_peaks = peaks(found.frequencies, response.values)
        if not found_peaks:
            table.add_row(response.name, response.unit, "none", "")
        for frequency, size in found_peaks:
            table.add_row(response.name, response.unit, f"{frequency:.5g}", f"{size:.5g}")
    console = terminal()
    console.print(table)
    console.print(str(found.configuration))
    if found.base_is_free:
        console.print(
            "The base is free in this scene, but moves as prescribed here. So resonances are those of the wing on "
            "a held base, and rotations are about its centre of mass."
        )
