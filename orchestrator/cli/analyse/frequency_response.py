"""`fanfold analyse frequency-response`: the response to vibration of the base, its resonances and a picture."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from ...api.options import Picture
from ..command import Asked, made_of
from ._configuration import ANGLES

if TYPE_CHECKING:
    from ...analysis.frequency_response import FrequencyResponse
    from ...scene.builder import Scene


@made_of(
    "frequency_response",
    name="frequency-response",
    angles=ANGLES,
    low={"flags": "--from", "help": "Lowest frequency, in Hz."},
    high={"flags": "--to", "help": "Highest frequency, in Hz."},
    plot={"flags": "-o --plot"},
)
def command(scene: Scene, asked: Asked, plot: Picture | None = None, as_json: bool = False) -> None:
    """Frequency response of SCENE in a configuration to vibration of its base.

    Options
    -------
    plot
        picture to write
    """
    options = asked["frequency_response"]
    if options["high"] <= options["low"]:
        raise click.UsageError(f"--to {options['high']:g} Hz must be above --from {options['low']:g} Hz")
    found = fanfold.frequency_response(scene, **options)
    if plot is not None:
        from ...views.linear import plot_response  # matplotlib takes its time

        plot_response(found, plot)
    if as_json:
        click.echo(json.dumps(found.as_dict()))
        return
    _print(found)
    click.echo(plot if plot is not None else "--plot FILE draws the curves, --json lists them")


def _print(found: FrequencyResponse) -> None:
    from ...analysis.frequency_response import peaks
    from ..tables import table_of, terminal

    rows = []
    for response in found.responses:
        found_peaks = peaks(found.frequencies, response.values)
        if not found_peaks:
            rows.append((response.name, response.unit, "none", ""))
        for frequency, size in found_peaks:
            rows.append((response.name, response.unit, f"{frequency:.5g}", f"{size:.5g}"))
    headings = ("output", "unit", "frequency, Hz", "magnitude")
    title = f"largest resonances, base driven in {found.excitation}"
    table = table_of(title, headings, rows, ("output", "unit"))
    console = terminal()
    console.print(table)
    console.print(str(found.configuration))
    if found.base_is_free:
        console.print(
            "The base is free in this scene, but moves as prescribed here. So resonances are those of the wing on "
            "a held base, and rotations are about its centre of mass."
        )
