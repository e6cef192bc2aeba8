"""Response of a scene to vibration of its base: accelerations of points and interface loads over frequency.

Direct complex solutions of (-w^2 M + i w C + K) q = 0 with the base prescribed, so damping need not be modal.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from components.contract.component import Vector

from ..cli.options import SceneChoice, ordered_names, scene_choice
from ..cli.types import Count, Number, Picture
from ..scene import SceneError
from ._configuration import ConfigurationChoice, as_posed_option, configuration_choice, scene_model
from ._linear import ZERO_FREQUENCY, LinearModel, modal_damping, normal_modes
from .modes import DIRECTIONS

Complex = NDArray[np.complex128]
INTERFACE = "interface"
_AROUND = np.concatenate((-np.geomspace(0.1, 30.0, 12)[::-1], [0.0], np.geomspace(0.1, 30.0, 12)))
"""Frequencies around a resonance, in half-widths of its peak."""
_LEAST_DAMPING = 1e-5
_FREQUENCY = Number(min=ZERO_FREQUENCY, max=1e6)
"""Below it the round-off of stiff joints would be stiffer than what moves."""


class Response(NamedTuple):
    """Complex amplitude (F,) of one output for a base acceleration of 1."""

    name: str
    unit: str
    values: Complex


def base_response(model: LinearModel, excitation: int, frequencies: Vector) -> tuple[Complex, Complex]:
    """Accelerations (F, n) of all coordinates and loads (F, 6) on the base for a base acceleration of 1.

    excitation: 0 to 5 for translations (m/s2) and rotations (rad/s2) of the base about its reference point, of
    which the loads (N, N.m) are counted too. frequencies: Hz, positive.
    """
    base = model.base_rows
    others = model.other_rows
    rigid = model.mechanism.rigid_motion(model.origin)
    carried = rigid[:, excitation]
    mass = model.mass.copy()
    mass[np.ix_(base, base)] = 0.0  # loads are those at the interface, on whatever base there is
    accelerations = np.zeros((len(frequencies), len(mass)), dtype=complex)
    loads = np.zeros((len(frequencies), 6), dtype=complex)
    for k, omega in enumerate(2.0 * np.pi * np.asarray(frequencies, dtype=float)):
        dynamic = -(omega**2) * mass + 1j * omega * model.damping + model.stiffness
        motion = carried.astype(complex) / -(omega**2)
        force = dynamic @ motion
        motion[others] -= np.linalg.solve(dynamic[np.ix_(others, others)], force[others])
        accelerations[k] = -(omega**2) * motion
        loads[k] = -(dynamic @ motion)[base]
    return accelerations, loads


def frequency_grid(model: LinearModel, low: float, high: float, points: int) -> Vector:
    """Frequencies (Hz) from low to high, evenly on a log scale and dense around resonances on a held base."""
    modes = normal_modes(model, model.base_constraints)
    damping = modal_damping(model, modes)
    grid = [np.geomspace(low, high, points)]
    for frequency, ratio in zip(modes.frequencies, damping, strict=True):
        if frequency > 0.0 and ratio < 1.0:
            grid.append(frequency * (1.0 + max(ratio, _LEAST_DAMPING) * _AROUND))
    found = np.unique(np.concatenate(grid))
    result: Vector = found[(found >= low) & (found <= high)]
    return result


def point_motion(model: LinearModel, name: str) -> Vector:
    """Motion (6, n) of a point named BODY.POINT; SceneError where there is none."""
    mechanism = model.mechanism
    known = []
    for body, placed in mechanism.bodies.items():
        for point in placed.body.data.point_names if placed.body is not None else ():
            known.append(point if "." in point else f"{body}.{point}")
            if known[-1] == name:
                return mechanism.point_jacobian(body, point)
    raise SceneError([f"there is no point {name!r}; points are {', '.join(known)}"])


def responses(
    model: LinearModel, excitation: str, along: str, points: Sequence[str], frequencies: Vector
) -> list[Response]:
    """Accelerations of points, or with `INTERFACE` the load on the base, along or about an axis."""
    row = DIRECTIONS.index(along)
    motions = {name: point_motion(model, name)[row] for name in points if name != INTERFACE}
    accelerations, loads = base_response(model, DIRECTIONS.index(excitation), frequencies)
    given = "(rad/s2)" if excitation.startswith("r") else "(m/s2)"
    found = []
    for name in points:
        if name == INTERFACE:
            unit = "N.m" if along.startswith("r") else "N"
            found.append(Response(f"{name} {along}", f"{unit}/{given}", loads[:, row]))
        else:
            unit = "(rad/s2)" if along.startswith("r") else "(m/s2)"
            found.append(Response(f"{name} {along}", f"{unit}/{given}", accelerations @ motions[name]))
    return found


@click.command("frequency-response")
@scene_choice
@configuration_choice
@as_posed_option
@click.option(
    "--excite", type=click.Choice(DIRECTIONS), default="z", show_default=True,
    help="Acceleration of the base along or (r) about an axis.",
)  # fmt: skip
@click.option("--along", type=click.Choice(DIRECTIONS), help="What is read; as excited by default.")
@click.option(
    "--points", default=INTERFACE, show_default=True, callback=ordered_names, metavar="NAMES",
    help="Points as BODY.POINT with commas between, whose acceleration is wanted; interface is the load on the base.",
)  # fmt: skip
@click.option(
    "--from", "low", type=_FREQUENCY, default=0.1, show_default=True, metavar="HZ", help="Lowest frequency, in Hz.",
)  # fmt: skip
@click.option(
    "--to", "high", type=_FREQUENCY, default=100, show_default=True, metavar="HZ", help="Highest frequency, in Hz.",
)  # fmt: skip
@click.option(
    "--steps", type=Count(min=2, max=100_000), default=400, show_default=True,
    help="Frequencies, beside those around resonances.",
)  # fmt: skip
@click.option("--plot", type=Picture(), metavar="FILE", help="Picture to write.")
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
    """Response of SCENE in a configuration to vibration of its base."""
    if high <= low:
        raise click.UsageError(f"--to {high:g} Hz must be above --from {low:g} Hz")
    if not points:
        raise click.UsageError("--points needs points such as panel1.center, or interface")
    scene = choice.load_one_run()
    target = wanted.of(scene)
    model = scene_model(scene, choice.rigid, choice.flexible, target, as_posed)
    frequencies = frequency_grid(model, low, high, steps)
    found = responses(model, excite, along or excite, points, frequencies)
    if plot is not None:
        from ..views.linear import draw_responses  # matplotlib takes its time

        title = f"{scene.header.name}: base acceleration {excite}"
        draw_responses(plot, title, frequencies, found)
    if as_json:
        click.echo(json.dumps(_as_dict(scene.header.name, excite, frequencies, found)))
        return
    _print(frequencies, found)
    if plot is not None:
        click.echo(plot)


def _as_dict(scene: str, excite: str, frequencies: Vector, found: Sequence[Response]) -> dict[str, object]:
    curves = [
        {
            "output": response.name,
            "unit": response.unit,
            "magnitude": np.abs(response.values).tolist(),
            "phase_deg": np.rad2deg(np.angle(response.values)).tolist(),
        }
        for response in found
    ]
    return {"scene": scene, "excitation": excite, "frequency_hz": frequencies.tolist(), "responses": curves}


def peaks(frequencies: Vector, values: Complex, count: int = 5) -> list[tuple[float, float]]:
    """Frequency and magnitude of the largest local maxima, falling."""
    size = np.abs(values)
    inner = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    order = inner[np.argsort(-size[inner])][:count]
    return [(float(frequencies[k]), float(size[k])) for k in order]


def _print(frequencies: Vector, found: Sequence[Response]) -> None:
    table = Table(title="largest resonances")
    for heading in ("output", "unit"):
        table.add_column(heading, no_wrap=True)
    for heading in ("frequency, Hz", "magnitude"):
        table.add_column(heading, justify="right")
    for response in found:
        found_peaks = peaks(frequencies, response.values)
        if not found_peaks:
            table.add_row(response.name, response.unit, "none", "")
        for frequency, size in found_peaks:
            table.add_row(response.name, response.unit, f"{frequency:.5g}", f"{size:.5g}")
    Console().print(table)
