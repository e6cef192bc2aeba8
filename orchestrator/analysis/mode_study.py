"""How many fixed-interface modes a body needs: latch-up against their number, and frequencies of the reduced body.

The study of Bagnoli (2007), section 3.2.2: the same scene with more and more modes, compared with the most; and
Tables 3-2 and 3-3, the free frequencies of the reduced body against those of the full finite-element model.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np
from numpy.typing import NDArray
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from components.catalogue import BODIES, finite_elements
from components.reduction import fixed_interface_frequencies, free_frequencies

from ..cli_options import Number, fidelity_options, scene_layers, scene_of_one_run
from ..master import Settings
from ..run import RunError
from ..scene import Scene, assemble, find_scene, load_scene
from ..scene_bodies import body_model
from ..scene_body_tables import Body
from ..scene_pieces import held_bodies
from ._studies import as_dict, draw_changes, draw_latch_torques, latch_table, refuse_unlatched, run_case

Vector = NDArray[np.float64]

_LISTED = 8


class Frequencies(NamedTuple):
    """Frequencies (Hz) of one body: clamped and free of the full model, free of the reduced body by modes kept."""

    fixed: Vector
    free: Vector
    reduced: dict[int, Vector]


def frequencies(body: Body, counts: Sequence[int], listed: int = _LISTED) -> Frequencies:
    """The first frequencies of a catalogue body in full and reduced to each number of fixed-interface modes."""
    entry = str(body.catalogue)
    masses = tuple((attached.point, attached.mass) for attached in body.attached_masses)
    model = finite_elements(entry, masses)
    reduced = {}
    for count in counts:
        data = body_model(body.model_copy(update={"fixed_interface_modes": count}), flexible=True)
        reduced[count] = data.frequency[:listed] / (2.0 * np.pi)
    fixed = fixed_interface_frequencies(model, BODIES[entry].attachment_points, listed)
    return Frequencies(fixed / (2.0 * np.pi), free_frequencies(model, listed) / (2.0 * np.pi), reduced)


def frequency_table(name: str, found: Frequencies) -> Table:
    """Fixed-interface and free frequencies of the full model, and errors of the free ones of every reduced body."""
    table = Table(
        title=f"{name}: full model, and errors of the free reduced body by modes kept",
        box=SIMPLE_HEAD,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    table.add_column("mode", justify="right")
    table.add_column("clamped, Hz", justify="right")
    table.add_column("free, Hz", justify="right")
    for count in found.reduced:
        table.add_column(f"{count} modes, %", justify="right", min_width=7)
    for k, (fixed, free) in enumerate(zip(found.fixed, found.free, strict=True)):
        reduced = [
            f"{100.0 * (values[k] / free - 1.0):+.3g}" if k < len(values) else ""
            for values in found.reduced.values()
        ]
        table.add_row(str(k + 1), f"{fixed:.4f}", f"{free:.4f}", *reduced)
    return table


def _body(scene: Scene, name: str | None) -> Body:
    """The named body of the catalogue, or the only one there is; held lines leave a body no modes."""
    held = held_bodies(scene)
    bodies = {
        body.name: body for body in scene.bodies if body.catalogue is not None and body.name not in held
    }
    if name is None and len(bodies) == 1:
        return next(iter(bodies.values()))
    if name not in bodies:
        known = ", ".join(bodies) or "none"
        raise RunError(
            f"{scene.file}: name the body to study with --body; bodies that can have modes are {known}"
        )
    return bodies[name]


def _counts(_: click.Context, param: click.Parameter, value: str) -> tuple[int, ...]:
    try:
        counts = tuple(sorted({int(text) for text in value.split(",")}))
    except ValueError:
        raise click.BadParameter("give whole numbers with commas between", param=param) from None
    if counts[0] < 0 or len(counts) < 2:
        raise click.BadParameter("give at least two numbers of modes, none negative", param=param)
    return counts


@click.command("mode-study")
@click.argument("scene")
@scene_layers
@fidelity_options
@click.option("--body", default=None, help="Body whose modes are counted; needed where there are several.")
@click.option("--modes", "counts", default="2,3,4,5,10,20,30", show_default=True, callback=_counts)
@click.option(
    "--tolerance", type=Number(min=1e-10, max=0.1), default=None, help="Relative accuracy of the runs."
)
@click.option("--output", type=click.Path(path_type=Path, file_okay=False), default=None, help="Folder.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    scene: str,
    variants: tuple[str, ...],
    settings: tuple[str, ...],
    rigid: frozenset[str],
    flexible: frozenset[str],
    body: str | None,
    counts: tuple[int, ...],
    tolerance: float | None,
    output: Path | None,
    as_json: bool,
) -> None:
    """Latch-up of SCENE against the number of a body's fixed-interface modes."""
    loaded = scene_of_one_run(scene, variants, settings)
    studied = _body(loaded, body)
    folder = output or Path(f"{loaded.header.name}.mode-study")
    folder.mkdir(parents=True, exist_ok=True)
    cases = []
    for count in counts:
        layers = (*settings, f"body.{studied.name}.fixed_interface_modes={count}")
        changed = load_scene(find_scene(scene), variants, layers)
        assembly = assemble(changed, rigid, flexible | {studied.name})
        numbers = Settings(tolerance or assembly.tolerance, assembly.largest_step)
        path = folder / f"{count}_modes.h5"
        cases.append(run_case(f"{count} modes", count, assembly, path, numbers, assembly.until))
    reference = cases[-1]
    refuse_unlatched(reference)
    found = frequencies(studied, counts)
    draw_latch_torques(folder / "latch_torques.png", f"Latch-up with modes of {studied.name}", cases, 0.5)
    draw_changes(
        folder / "changes.png", f"Against {reference.label} of {studied.name}", "fixed-interface modes",
        cases, reference, log=True,
    )  # fmt: skip
    if as_json:
        content = {
            "body": studied.name,
            "cases": as_dict(cases, reference),
            "fixed_interface_hz": found.fixed.tolist(),
            "free_hz": found.free.tolist(),
            "reduced_free_hz": {str(k): v.tolist() for k, v in found.reduced.items()},
        }
        click.echo(json.dumps(content))
        return
    console = Console()
    console.print(latch_table(f"{loaded.header.name}: against {reference.label}", cases, reference))
    console.print(frequency_table(studied.name, found))
    console.print(f"pictures and results in {folder}")
