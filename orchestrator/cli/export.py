"""`fanfold export` and `export-body`: the components of a scene as FMUs, a body of it as finite elements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .options import SceneChoice, backend_option, large_deformation_option, layered_scene, scene_choice
from .types import Count

if TYPE_CHECKING:
    from fmus import Backend, FmiVersion

    from ..scene.component_connections import WrenchMode


@click.command("export")
@scene_choice
@large_deformation_option
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
@click.option(
    "--ssp", type=click.Path(path_type=Path, dir_okay=False),
    help="One file with all FMUs and their connections (SSP 1.0).",
)  # fmt: skip
@click.option("--sources", is_flag=True, help="Add the C sources, to be compiled on other platforms.")
@backend_option
def command(
    choice: SceneChoice,
    large_deformation: frozenset[str],
    output: Path,
    wrench_mode: WrenchMode,
    fmi: FmiVersion,
    ssp: Path | None,
    sources: bool,
    backend: Backend | None,
) -> None:
    """Write every component of SCENE as an FMU."""
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
    )
    for path in paths:
        click.echo(path)
    if wrench_mode == "endpoint":
        from fmpy import read_model_description

        if step := read_model_description(str(paths[0])).defaultExperiment.stepSize:
            click.echo(
                f"advised communication step: {float(step):g} s, for tools that do not iterate", err=True
            )


@click.command("export-body")
@layered_scene
@click.argument("body")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path, dir_okay=False), required=True,
    help="File that ends with .npz or .op4.",
)  # fmt: skip
@click.option("--modes", type=Count(min=0), help="Fixed-interface modes; by default those of the scene.")
def body_command(choice: SceneChoice, body: str, output: Path, modes: int | None) -> None:
    """Write BODY of SCENE as a Craig-Bampton model, and print the entry of a scene file that has it from there."""
    found = fanfold.export_body(choice.load(), body, output, modes=modes)
    click.echo(f"# {found.path}")
    click.echo(found.to_toml(), nl=False)
