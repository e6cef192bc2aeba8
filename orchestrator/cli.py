"""The `fanfold` command."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import Any

import click
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from components import REGISTRY
from fmus import Backend, FmiVersion, check_fmu, native_library

from .assembly import Assembly
from .master import Settings
from .result import Result, ResultError
from .run import MasterKind, Outcome, RunError, as_fmus, export, run
from .scene import SceneError, assemble, find_scene, list_scenes, load_scene
from .scene_connections import WrenchMode
from .summary import headline_table
from .verify import Verified, verify

_PROBLEMS = (SceneError, RunError, ResultError)


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
    scenes = Table("scene", "description", "bodies")
    for name in list_scenes():
        scene = load_scene(find_scene(name))
        bodies = ", ".join(body.name for body in scene.bodies)
        scenes.add_row(name, scene.header.description, bodies)
    kinds = Table("component", "what it is")
    for kind, component in sorted(REGISTRY.items()):
        kinds.add_row(kind, (component.__doc__ or "").strip().splitlines()[0])
    console = Console()
    console.print(scenes)
    console.print(kinds)


class _Number(click.FloatRange):
    """A number in a range; "nan" and "inf" are none."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:  # noqa: ANN401
        """The number, or click's own refusal."""
        number = super().convert(value, param, ctx)
        return number if isfinite(number) else self.fail(f"{value} is not a finite number.", param, ctx)


def _names(_: click.Context, __: click.Parameter, value: str) -> frozenset[str]:
    return frozenset(name.strip() for name in value.split(",") if name.strip())


def _fidelity(command: Callable[..., None]) -> Callable[..., None]:
    """The two fidelity options, for every command that assembles a scene."""
    for option, other in (("--flexible", "modal"), ("--rigid", "rigid")):
        text = f"Bodies to be {other}, by name with commas between, or all."
        command = click.option(option, default="", callback=_names, metavar="NAMES", help=text)(command)
    return command


def _backend(command: Callable[..., None]) -> Callable[..., None]:
    """The option that chooses the back end of the FMUs."""
    return click.option(
        "--backend",
        type=click.Choice(["native", "python"]),
        callback=_offered_backend,
        help="Native FMUs, or PythonFMUs; native by default where a C compiler built them at installation.",
    )(command)


def _offered_backend(_: click.Context, __: click.Parameter, value: Backend | None) -> Backend | None:
    if value == "native" and native_library() is None:
        raise click.BadParameter(
            "no native library was built; install Fanfold again where there is a C compiler"
        )
    return value


def _tell_of_python(backend: Backend | None) -> None:
    if backend is None and native_library() is None:
        _warn("no native library was built at installation; PythonFMUs are used, which are slower")


@main.command("run")
@click.argument("scene")
@_fidelity
@_backend
@click.option("--tolerance", type=_Number(min=1e-10, max=0.1), help="Relative accuracy asked for.")
@click.option("--until", type=_Number(min=0.0, min_open=True), help="End time in seconds.")
@click.option("--output", type=click.Path(path_type=Path, dir_okay=False), help="Result file (HDF5).")
@click.option("--step", type=_Number(min=1e-7), help="Fixed communication step size in seconds.")
@click.option(
    "--master",
    type=click.Choice(["implicit", "jacobi", "gauss-seidel"]),
    default="implicit",
    show_default=True,
)
@click.option("--verify", "with_verify", is_flag=True, help="Repeat with steps halved; report errors.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def run_command(
    scene: str,
    rigid: frozenset[str],
    flexible: frozenset[str],
    tolerance: float | None,
    until: float | None,
    output: Path | None,
    step: float | None,
    master: MasterKind,
    with_verify: bool,
    as_json: bool,
    backend: Backend | None,
) -> None:
    """Deploy SCENE, the name of a scene or a scene file, and write its result."""
    if with_verify and master != "implicit":
        raise click.UsageError("--verify extrapolates runs of the implicit master; leave --master out")
    _tell_of_python(backend)
    loaded = load_scene(find_scene(scene))
    assembly = assemble(loaded, rigid, flexible, "mean" if master == "implicit" else "endpoint")
    settings = Settings(
        tolerance=tolerance or assembly.tolerance, largest_step=assembly.largest_step, fixed_step=step
    )
    path = output or Path(f"{assembly.name}.h5")
    load = partial(as_fmus, backend=backend)
    end = until or assembly.until
    with _progress(assembly, end) as watch:
        outcome = run(assembly, path, settings, end, master, watch, _warn, load)
    verified = None
    if with_verify:
        with _progress(assembly, end) as watch:
            verified = verify(assembly, outcome, settings, end, watch, load)
    _report(outcome, verified, as_json)


def _warn(sentence: str) -> None:
    click.echo(f"fanfold: warning: {sentence}", err=True)


@contextmanager
def _interrupted_between_steps() -> Iterator[Callable[[], None]]:
    """Keep Ctrl-C until the function given is called: inside an FMU it would pass for a failure of the FMU.

    A second Ctrl-C acts at once. Nothing changes where Ctrl-C is ignored, as in a background job.
    """
    before = signal.getsignal(signal.SIGINT)
    pressed = False

    def note(*_: object) -> None:
        nonlocal pressed
        pressed = True
        signal.signal(signal.SIGINT, before)

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    if before is signal.default_int_handler:
        signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _progress(assembly: Assembly, end: float) -> Iterator[Callable[[float, float], None]]:
    """A progress bar on standard error: simulated time, step size, real-time factor."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(
            "t = {task.completed:7.3f} s  H = {task.fields[h]:.1e} s  real-time factor {task.fields[factor]:.2f}"
        ),
        TimeElapsedColumn(),
    )
    start = perf_counter()
    with (
        _interrupted_between_steps() as check,
        Progress(*columns, console=Console(stderr=True), refresh_per_second=5) as bar,
    ):
        task = bar.add_task(assembly.name, total=end, h=0.0, factor=0.0)

        def watch(time: float, h: float) -> None:
            check()
            bar.update(task, completed=time, h=h, factor=time / max(perf_counter() - start, 1e-9))

        yield watch


def _report(outcome: Outcome, verified: list[Verified] | None, as_json: bool) -> None:
    if as_json:
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
        click.echo(json.dumps(content))
        return
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
    from .plots import plot_all  # matplotlib takes its time, which no other command needs

    for path in plot_all(Result.open(result), output or result.with_suffix("")):
        click.echo(path)


@main.command("export")
@click.argument("scene")
@_fidelity
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
@_backend
def export_command(
    scene: str,
    rigid: frozenset[str],
    flexible: frozenset[str],
    output: Path,
    wrench_mode: WrenchMode,
    fmi: FmiVersion,
    sources: bool,
    backend: Backend | None,
) -> None:
    """Write every component of SCENE as an FMU."""
    if fmi == "2.0" and not sources:
        _tell_of_python(backend)
    assembly = assemble(load_scene(find_scene(scene)), rigid, flexible, wrench_mode)
    for path in export(assembly, output, backend, fmi, sources):
        click.echo(path)


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
