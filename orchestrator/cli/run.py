"""`fanfold run`: deploy a scene."""

from __future__ import annotations

import json
from functools import partial
from math import degrees
from pathlib import Path

import click
from rich.console import Console
from rich.table import Table

from fmus import Backend

from ..assembly import Assembly
from ..cosim.master import Settings
from ..cosim.network import Order
from ..run.companion import with_estimates
from ..run.run import MasterKind, Outcome, as_fmus, run
from ..run.verify import Verified, verify
from .messages import tell_of_python, warn
from .options import SceneChoice, backend_option, scene_choice
from .progress import progress
from .tables import headline_table
from .types import Number

_ORDERS: dict[str, Order | None] = {"auto": None, "2": 2, "4": 4}


@click.command("run")
@scene_choice
@backend_option
@click.option("--tolerance", type=Number(min=1e-10, max=0.1), help="Relative accuracy asked for.")
@click.option("--until", type=Number(min=0.0, min_open=True), help="End time in seconds.")
@click.option("--output", type=click.Path(path_type=Path, dir_okay=False), help="Result file (HDF5).")
@click.option("--step", type=Number(min=1e-7), help="Fixed communication step size in seconds.")
@click.option(
    "--order", type=click.Choice(["auto", "2", "4"]), default="auto", show_default=True,
    help="Order of the coupling: wrenches constant or linear in time over a step; auto: 4 with flexible bodies.",
)  # fmt: skip
@click.option(
    "--master",
    type=click.Choice(["implicit", "jacobi", "gauss-seidel"]),
    default="implicit",
    show_default=True,
)
@click.option("--verify", "with_verify", is_flag=True, help="Repeat with steps halved; report errors.")
@click.option(
    "--estimate/--no-estimate", "with_estimate", default=True, show_default=True,
    help="Estimate the errors of headline numbers, for half the cost of the run.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(
    choice: SceneChoice,
    tolerance: float | None,
    until: float | None,
    output: Path | None,
    step: float | None,
    order: str,
    master: MasterKind,
    with_verify: bool,
    with_estimate: bool,
    as_json: bool,
    backend: Backend | None,
) -> None:
    """Deploy SCENE, the name of a scene or a scene file, and write its result."""
    if with_verify and master != "implicit":
        raise click.UsageError("--verify extrapolates runs of the implicit master; leave --master out")
    if master != "implicit" and step is None:
        raise click.UsageError("an explicit master needs a --step that is stable; for rigid wings try 2e-5 s")
    tell_of_python(backend)
    load = partial(as_fmus, backend=backend)
    phases = _phases(choice)
    if until is not None and len(phases) > 1:
        chosen = ", ".join(phase for phase, _ in phases)
        raise click.UsageError(f"--until is the end of one run; choose a phase with --variant: {chosen}")
    contents: dict[str, dict[str, object]] = {}
    for phase, one in phases:
        assembly = one.assemble(one.load(), "mean" if master == "implicit" else "endpoint")
        _tell_of_held(choice.flexible, assembly)
        numbers = Settings(
            tolerance=tolerance or assembly.tolerance, largest_step=assembly.largest_step, fixed_step=step,
            order=_ORDERS[order],
        )  # fmt: skip
        path = _phase_path(output, phase) if output else Path(".".join((assembly.name, *one.variants, "h5")))
        end = until or assembly.until
        with progress(assembly.name, end) as watch:
            outcome = run(assembly, path, numbers, end, master, watch, warn, load)
        if with_estimate:
            with progress(f"{assembly.name}: errors", end) as watch:
                outcome = with_estimates(assembly, outcome, numbers, end, watch, load)
        verified = None
        if with_verify:
            with progress(assembly.name, end) as watch:
                verified = verify(assembly, outcome, numbers, end, watch, load)
        contents[phase] = _content(outcome, verified)
        _tell_of_open_ends(outcome)
        if not as_json:
            _report(outcome, verified)
    if as_json:
        click.echo(json.dumps({"phases": contents} if len(phases) > 1 else contents[phases[0][0]]))


def _tell_of_held(flexible: frozenset[str], assembly: Assembly) -> None:
    for name in sorted(flexible - {"all"} - set(assembly.flexible)):
        warn(f"{assembly.name}: {name} is part of a piece that held hinge lines join, which is rigid")


def _tell_of_open_ends(outcome: Outcome) -> None:
    """Lines that have not latched, and peaks that may lie beyond the end."""
    found = outcome.headline
    for line, angle in found.unlatched_angles.items():
        warn(f"{line} has not latched; at {found.end_time:g} s it stands at {degrees(angle):.2f} deg")
    for line in found.peaks_at_end:
        warn(
            f"the latch torque of {line} is largest at the very end, {found.end_time:g} s; run longer for its peak"
        )


def _phases(choice: SceneChoice) -> list[tuple[str, SceneChoice]]:
    """Name and choice of every phase to run; a scene without phases, or asked for one of them, has one."""
    phases = choice.load().header.phases
    if not phases or set(phases) & set(choice.variants):
        return [("", choice)]
    return [(phase, choice.with_variant(phase)) for phase in phases]


def _phase_path(path: Path, phase: str) -> Path:
    return path.with_suffix(f".{phase}{path.suffix}") if phase else path


def _content(outcome: Outcome, verified: list[Verified] | None) -> dict[str, object]:
    """What a run found, for JSON."""
    content = outcome.as_dict()
    if verified is not None:
        content["verification"] = [
            {
                "quantity": v.number.quantity,
                "of": v.number.of,
                "unit": v.number.unit,
                "value": v.number.value,
                "extrapolated": v.extrapolated,
                "estimated_error": v.error,
                "observed_order": v.order,
            }
            for v in verified
        ]
    return content


def _report(outcome: Outcome, verified: list[Verified] | None) -> None:
    """What a run found, for people."""
    console = Console()
    console.print(headline_table(outcome.headline))
    console.print(
        f"{outcome.costs.steps} steps ({outcome.costs.rejected} rejected), {outcome.costs.iterations} iterations, "
        f"{outcome.costs.wall_time:.1f} s wall time, {100 * outcome.costs.fmu_time_share:.0f} % of it in FMUs, "
        f"{outcome.headline.end_time / outcome.costs.wall_time:.2f} times real time; result in {outcome.path}"
    )
    if verified is not None:
        console.print(_verification_table(verified))


def _verification_table(verified: list[Verified]) -> Table:
    table = Table(title="verification: steps halved and quartered, errors estimated")
    table.add_column("quantity")
    for heading in ("value", "extrapolated", "error", "order"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit")
    for v in verified:
        name = " ".join(filter(None, (v.number.quantity, v.number.of)))
        order = "" if v.order is None else f"{v.order:.2f}"
        numbers = (f"{v.number.value:.7g}", f"{v.extrapolated:.7g}", f"{v.error:.2g}", order)
        table.add_row(name, *numbers, "" if v.number.unit == "1" else v.number.unit)
    return table
