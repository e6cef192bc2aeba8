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
    help="endpoint (default) for other tools, mean for the implicit master.",
)  # fmt: skip
@click.option(
    "--fmi", type=click.Choice(["2.0", "3.0"]), default="2.0", show_default=True,
    help="Version of FMI; 3.0 needs the native back end.",
)  # fmt: skip
@click.option(
    "--ssp", type=click.Path(path_type=Path, dir_okay=False),
    help="Also write one SSP 1.0 file with all FMUs and their connections.",
)  # fmt: skip
@click.option("--sources", is_flag=True, help="Add the C sources, for compilation on other platforms.")
@click.option(
    "--platforms", multiple=True, callback=ordered_names, metavar="NAMES",
    help=(
        "Platforms of the libraries: linux64, aarch64-linux, win64, darwin64, aarch64-darwin, wasm32, or all; by "
        "default this machine."
    ),
)  # fmt: skip
@click.option(
    "--as-one",
    is_flag=True,
    help="One FMU of the whole scene, including the master that couples its components.",
)
@click.option(
    "--driven-base",
    is_flag=True,
    help="With --as-one: the base moves by inputs, its pose, rates and accelerations.",
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
    """Export the components of SCENE as FMUs, or the whole SCENE as one FMU."""
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
    """Message about the C library that native FMUs of this machine need; empty if they need none of GNU."""
    from fmus import PLATFORMS, native_library
    from fmus.binary import glibc_of
    from fmus.description.binaries import folder_here

    library = native_library()
    version = None if library is None else glibc_of(library.read_bytes())
    if version is None:
        return ""
    here = [name for name, platform in PLATFORMS.items() if platform.folder3 == folder_here("3.0")]
    older = "".join(f"; --platforms {name} for 2.17" for name in here)
    return f"this library needs glibc {version[0]}.{version[1]} or newer{older}"


@click.command("export-body")
@layered_scene
@click.argument("body")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, dir_okay=False), required=True,
    help="File: .npz, .op4 or .asm (Nastran superelement, with .op4 and .pch).",
)  # fmt: skip
@click.option(
    "--modes", type=Count(min=0), help="Number of fixed-interface modes; by default that of the scene."
)
def body_command(choice: SceneChoice, body: str, output: Path, modes: int | None) -> None:
    """Export BODY of SCENE as a Craig-Bampton model, and print the table that imports it into a scene file."""
    found = fanfold.export_body(choice.load(), body, output, modes=modes)
    click.echo(f"# {found.path}")
    click.echo(found.to_toml(), nl=False)


@click.command("export-view")
@click.argument("result", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option(
    "-o", "--out", "--output", "output", type=OutputFile(), required=True,
    help="File: .glb, .pvd, .csv or .mat.",
)  # fmt: skip
@click.option("--format", metavar="glb|vtu|csv|mat", help="Format; by default from the suffix of the file.")
@click.option(
    "--tolerance", type=Number(min=0.0, min_open=True), metavar="METRES",
    help="glb: largest position error between the keys of the animation; by default 1e-4 of the structure's size.",
)  # fmt: skip
@click.option("--frames", type=Count(min=1), help="vtu: number of equally spaced times; by default 60.")
@click.option(
    "--times", callback=_times, metavar="SECONDS",
    help="vtu: times, separated by commas; the nearest recorded rows are used.",
)  # fmt: skip
@click.option("--no-stress", is_flag=True, help="vtu: omit von Mises stress, which takes time to compute.")
@click.option(
    "--signals", multiple=True, callback=ordered_names, metavar="PATTERNS",
    help="csv, mat: patterns of signals, separated by commas, such as 'hl1_*,panel1.frame_*'; by default all.",
)  # fmt: skip
@click.option(
    "--every", type=Seconds(min=0.0, min_open=True), metavar="SECONDS",
    help="csv, mat: time between rows, interpolated linearly; by default the recorded rows.",
)  # fmt: skip
@click.option("--replace", is_flag=True, help="Replace existing files.")
@result_options
def view_command(result: Path, output: Path, no_stress: bool, **options: Any) -> None:  # noqa: ANN401
    """Export RESULT for other programs: animated bodies (glb), fields (vtu), a table (csv), MATLAB (mat)."""
    for path in fanfold.export_view(result, output, stress=False if no_stress else None, **options):
        click.echo(path)
