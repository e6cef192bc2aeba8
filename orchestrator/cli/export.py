"""`fanfold export`: the components of a scene as FMUs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .options import SceneChoice, backend_option, scene_choice

if TYPE_CHECKING:
    from fmus import Backend, FmiVersion

    from ..scene.component_connections import WrenchMode


@click.command("export")
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
@click.option(
    "--ssp", type=click.Path(path_type=Path, dir_okay=False),
    help="One file with all FMUs and their connections (SSP 1.0).",
)  # fmt: skip
@click.option("--sources", is_flag=True, help="Add the C sources, to be compiled on other platforms.")
@backend_option
def command(
    choice: SceneChoice,
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
