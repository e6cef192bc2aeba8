"""The `fanfold` command."""

from __future__ import annotations

import json
import sys
from functools import partial
from importlib import import_module
from math import degrees
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from components import REGISTRY
from fmus import Backend, FmiVersion, check_fmu, native_library

from .. import analysis
from ..assembly import Assembly
from ..cosim.master import Settings
from ..cosim.network import Order
from ..results import compare
from ..results.key_figures import headline_table
from ..results.result import Result, ResultError
from ..run.companion import with_estimates
from ..run.run import MasterKind, Outcome, RunError, as_fmus, export, run
from ..run.verify import Verified, verify
from ..scene import SceneError, find_scene, list_scenes, load_scene, scene_variants
from ..scene.component_connections import WrenchMode
from ..views.report import report
from .options import SceneChoice, backend_option, scene_choice
from .progress import progress
from .types import Number

_PROBLEMS = (SceneError, RunError, ResultError)
_INTERRUPTED = "interrupted; what it wrote up to there stays"


class _Group(click.Group):
    """Shows every foreseen problem as sentences on standard error, with exit code 1."""

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401 - click's own signature
        """Run a command."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:  # nobody reads on; click ends quietly
            raise
        except OSError as error:
            problem = str(error) if error.filename is None else f"{error.filename}: {error.strerror}"
        except _PROBLEMS as error:
            problem = str(error)
        except KeyboardInterrupt:  # outside of a run, which says itself how far it came
            problem = f"{ctx.invoked_subcommand}: {_INTERRUPTED}"
        for line in problem.splitlines():
            click.echo(f"fanfold: {line}", err=True)
        ctx.exit(1)


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="fanfold")
def main() -> None:
    """Deployable space structures as co-simulations of FMI components."""


@main.command("list")
def list_command() -> None:
    """Scenes that come with Fanfold, and the components they are made of."""
    scenes = Table("scene", "description", "bodies", "variants")
    for name in list_scenes():
        scene = load_scene(find_scene(name))
        bodies = ", ".join(body.name for body in scene.bodies)
        scenes.add_row(name, scene.header.description, bodies, ", ".join(scene_variants(find_scene(name))))
    kinds = Table("component", "what it is")
    for kind, component in sorted(REGISTRY.items()):
        kinds.add_row(kind, (component.__doc__ or "").strip().splitlines()[0])
    console = Console()
    console.print(scenes)
    console.print(kinds)


def _tell_of_python(backend: Backend | None) -> None:
    if backend is None and native_library() is None:
        _warn("no native library was built at installation; PythonFMUs are used, which are slower")


_ORDERS: dict[str, Order | None] = {"auto": None, "2": 2, "4": 4}


@main.command("run")
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
def run_command(
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
    _tell_of_python(backend)
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
            outcome = run(assembly, path, numbers, end, master, watch, _warn, load)
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
        _warn(f"{assembly.name}: {name} is part of a piece that held hinge lines join, which is rigid")


def _tell_of_open_ends(outcome: Outcome) -> None:
    """Lines that have not latched, and peaks that may lie beyond the end."""
    found = outcome.headline
    for line, angle in found.unlatched_angles.items():
        _warn(f"{line} has not latched; at {found.end_time:g} s it stands at {degrees(angle):.2f} deg")
    for line in found.peaks_at_end:
        _warn(
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


def _warn(sentence: str) -> None:
    click.echo(f"fanfold: warning: {sentence}", err=True)


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


@main.command("plot")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--output", type=click.Path(path_type=Path, file_okay=False), help="Folder for the pictures.")
def plot_command(result: Path, output: Path | None) -> None:
    """Draw the pictures of RESULT."""
    from ..views.plots import plot_all  # matplotlib takes its time, which no other command needs

    for path in plot_all(Result.open(result), output or result.with_suffix("")):
        click.echo(path)


@main.command("export")
@scene_choice
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, file_okay=False), required=True, help="Folder."
)
@click.option(
    "--wrench-mode", type=click.Choice(["endpoint", "mean"]), default="endpoint", show_default=True,
    help="endpoint for other tools, mean for the implicit master.",
)  # fmt: skip
@click.option(
    "--fmi", type=click.Choice(["2.0", "3.0"]), default="2.0", show_default=True,
    help="Version of FMI; 3.0 needs the native back end.",
)  # fmt: skip
@click.option("--sources", is_flag=True, help="Add the C sources, to be compiled on other platforms.")
@backend_option
def export_command(
    choice: SceneChoice,
    output: Path,
    wrench_mode: WrenchMode,
    fmi: FmiVersion,
    sources: bool,
    backend: Backend | None,
) -> None:
    """Write every component of SCENE as an FMU."""
    if fmi == "2.0" and not sources:
        _tell_of_python(backend)
    assembly = choice.assemble(choice.load_one_run(), wrench_mode)
    for path in export(assembly, output, backend, fmi, sources):
        click.echo(path)


class _Analyses(click.Group):
    """Every module of `orchestrator.analysis` is one analysis; only the one asked for is imported."""

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401 - click's own signature
        """Run an analysis; a RunError says which one was interrupted."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise RunError(f"analyse {ctx.invoked_subcommand}: {_INTERRUPTED}") from None

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the analyses."""
        found = (module.name for module in iter_modules(analysis.__path__))
        return sorted(name.replace("_", "-") for name in found if not name.startswith("_"))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of an analysis."""
        if cmd_name not in self.list_commands(ctx):
            return None
        module = import_module(f"{analysis.__name__}.{cmd_name.replace('-', '_')}")
        command: click.Command = module.command
        return command


@main.group("analyse", cls=_Analyses)
def analyse_group() -> None:
    """Analyses of a scene or of a result."""


main.add_command(compare.command)
main.add_command(report.command)


@main.command("check")
@click.argument("fmu", type=click.Path(path_type=Path, exists=True, dir_okay=False), nargs=-1, required=True)
def check_command(fmu: tuple[Path, ...]) -> None:
    """Print every problem of each FMU as a sentence; exit code 1 if there is any."""
    found = False
    for path in fmu:
        problems = check_fmu(path)
        found = found or bool(problems)
        for problem in problems or ["no problem found"]:
            click.echo(f"{path.name}: {problem}")
    sys.exit(1 if found else 0)
