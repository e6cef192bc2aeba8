"""`fanfold export`, `export-body`, `export-view`: a scene as FMUs, a body as finite elements, a result for viewers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import orchestrator as fanfold

from .options import (
    SceneChoice,
    backend_option,
    large_deformation_option,
    layered_scene,
    ordered_names,
    result_options,
    scene_choice,
)
from .types import Count, Number, OutputFile, Seconds

if TYPE_CHECKING:
    from fmus import Backend, FmiVersion

    from ..scene.component_connections import WrenchMode


def _times(_: click.Context, __: click.Parameter, value: str | None) -> tuple[float, ...] | None:
    """Times (s) with commas between."""
    if value is None:
        return None
    try:
        return tuple(float(one) for one in value.split(","))
    except ValueError:
        raise click.BadParameter(f"{value!r} is no list of times in seconds, such as 0,1.5,3") from None


@click.command("export")
@scene_choice
@large_deformation_option
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, file_okay=False), required=True, help="Folder."
)
@click.option(
    "--wrench-mode", type=click.Choice(["endpoint", "mean"]),
    help="endpoint for other tools, mean for the implicit master.",
)  # fmt: skip
@click.option(
    "--fmi", type=click.Choice(["2.0", "3.0"]), default="2.0", show_default=True,
    help="Version of FMI; 3.0 needs the native back end.",
)  # fmt: skip
@click.option(
    "--ssp", type=click.Path(path_type=Path, dir_okay=False),
    help="One file with all FMUs and their connections (SSP 1.0).",
)  # fmt: skip
@click.option("--sources", is_flag=True, help="Add the C sources, to be compiled on other platforms.")
@click.option(
    "--platforms", multiple=True, callback=ordered_names, metavar="NAMES",
    help="Libraries for linux64, aarch64-linux, win64, darwin64, aarch64-darwin, wasm32, or all; by default for here.",
)  # fmt: skip
@click.option(
    "--as-one", is_flag=True, help="One FMU of the whole scene, with the master that couples its components."
)
@click.option(
    "--driven-base",
    is_flag=True,
    help="With --as-one: the base moves by inputs, its rates and accelerations.",
)
@backend_option
def command(
    choice: SceneChoice,
    large_deformation: frozenset[str],
    output: Path,
    wrench_mode: WrenchMode | None,
    fmi: FmiVersion,
    ssp: Path | None,
    sources: bool,
    platforms: tuple[str, ...],
    as_one: bool,
    driven_base: bool,
    backend: Backend | None,
) -> None:
    """Write every component of SCENE as an FMU, or SCENE as one."""
    from rich.console import Console

    with Console(stderr=True).status("exporting") as status:
        paths = fanfold.export(
            choice.load(),
            output,
            **choice.fidelities,
            large_deformation=large_deformation,
            wrench_mode=wrench_mode,
            fmi=fmi,
            sources=sources,
            backend=backend,
            ssp=ssp,
            platforms="all" if platforms == ("all",) else platforms,
            as_one=as_one,
            driven_base=driven_base,
            watch=lambda name: status.update(f"library for {name}, which is compiled once"),
        )
    for path in paths:
        click.echo(path)
    if not platforms and backend != "python" and (needs := _needs()):
        click.echo(needs, err=True)
    if wrench_mode != "mean" and not as_one:
        from fmpy import read_model_description

        if step := read_model_description(str(paths[0])).defaultExperiment.stepSize:
            click.echo(
                f"advised communication step: {float(step):g} s, for tools that do not iterate", err=True
            )


def _needs() -> str:
    """A line on the C library that native FMUs from here need; empty where they need none of GNU, or there are none."""
    from fmus import PLATFORMS, native_library
    from fmus.binary import glibc_of
    from fmus.description.binaries import folder_here

    library = native_library()
    version = None if library is None else glibc_of(library.read_bytes())
    if version is None:
        return ""
    here = [name for name, platform in PLATFORMS.items() if platform.folder3 == folder_here("3.0")]
    older = "".join(f"; --platforms {name} for 2.17" for name in here)
    return f"binary of this machine: glibc {version[0]}.{version[1]} or newer{older}"


@click.command("export-body")
@layered_scene
@click.argument("body")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, dir_okay=False), required=True,
    help="File that ends with .npz, .op4 or .asm (a superelement of Nastran, with .op4 and .pch).",
)  # fmt: skip
@click.option("--modes", type=Count(min=0), help="Fixed-interface modes; by default those of the scene.")
def body_command(choice: SceneChoice, body: str, output: Path, modes: int | None) -> None:
    """Write BODY of SCENE as a Craig-Bampton model, and print the entry of a scene file that has it from there."""
    found = fanfold.export_body(choice.load(), body, output, modes=modes)
    click.echo(f"# {found.path}")
    click.echo(found.to_toml(), nl=False)


@click.command("export-view")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "-o", "--out", "--output", "output", type=OutputFile(), required=True,
    help="File that ends with .glb, .pvd, .csv or .mat.",
)  # fmt: skip
@click.option("--format", metavar="glb|vtu|csv|mat", help="By default what the ending of the file says.")
@click.option(
    "--tolerance", type=Number(min=0.0, min_open=True), metavar="METRES",
    help="glb: no node is off by more between the keys of the animation; by default 1e-4 of the structure's size.",
)  # fmt: skip
@click.option("--frames", type=Count(min=1), help="vtu: files at equal steps in time; by default 60.")
@click.option(
    "--times", callback=_times, metavar="SECONDS",
    help="vtu: with commas between; the recorded rows nearest to them.",
)  # fmt: skip
@click.option(
    "--no-stress", is_flag=True, help="vtu: leave out von Mises stress, whose recovery takes its time."
)
@click.option(
    "--signals", multiple=True, callback=ordered_names, metavar="PATTERNS",
    help="csv, mat: signals, with commas between, such as 'hl1_*,panel1.frame_*'; by default all.",
)  # fmt: skip
@click.option(
    "--every", type=Seconds(min=0.0, min_open=True), metavar="SECONDS",
    help="csv, mat: rows at equal spacing, linear between recorded ones; by default these.",
)  # fmt: skip
@click.option("--replace", is_flag=True, help="Replace what is there already.")
@result_options
def view_command(result: Path, output: Path, no_stress: bool, **options: Any) -> None:  # noqa: ANN401
    """Write RESULT for other programs: animated bodies (glb), fields (vtu), a table (csv), MATLAB (mat)."""
    for path in fanfold.export_view(result, output, stress=False if no_stress else None, **options):
        click.echo(path)
