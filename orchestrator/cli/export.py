"""`fanfold export`: the components of a scene as FMUs."""

from __future__ import annotations

from pathlib import Path

import click

from fmus import Backend, FmiVersion

from ..run.run import export
from ..scene.component_connections import WrenchMode
from .messages import tell_of_python
from .options import SceneChoice, backend_option, scene_choice


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
@click.option("--sources", is_flag=True, help="Add the C sources, to be compiled on other platforms.")
@backend_option
def command(
    choice: SceneChoice,
    output: Path,
    wrench_mode: WrenchMode,
    fmi: FmiVersion,
    sources: bool,
    backend: Backend | None,
) -> None:
    """Write every component of SCENE as an FMU."""
    if fmi == "2.0" and not sources:
        tell_of_python(backend)
    assembly = choice.assemble(choice.load_one_run(), wrench_mode)
    for path in export(assembly, output, backend, fmi, sources):
        click.echo(path)
