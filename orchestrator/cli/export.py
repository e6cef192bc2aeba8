"""`fanfold export`, `export-body`, `export-view`: a scene as FMUs, a body as finite elements, a result for viewers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

from .command import Asked, made_of

if TYPE_CHECKING:
    from ..scene.builder import Scene


@made_of("export", name="export", folder={"flags": "-o --output"})
def command(scene: Scene, asked: Asked) -> None:
    """Export the components of SCENE as FMUs, or the whole SCENE as one FMU.

    Options
    -------
    folder
        folder
    """
    from rich.console import Console

    options = asked["export"]
    if options["platforms"] == ("all",):
        options["platforms"] = "all"
    with Console(stderr=True).status("exporting") as status:
        paths = fanfold.export(
            scene,
            **options,
            watch=lambda name: status.update(f"library for {name}, which is compiled once"),
        )
    for path in paths:
        click.echo(path)
    if not options["platforms"] and options["backend"] != "python" and (needs := _needs()):
        click.echo(needs, err=True)
    if options["wrench_mode"] != "mean" and not options["as_one"]:
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


@made_of("export_body", name="export-body")
@click.argument("body")
def body_command(scene: Scene, body: str, asked: Asked) -> None:
    """Export BODY of SCENE as a Craig-Bampton model, and print the table that imports it into a scene file.

    Options
    -------
    path
        file: .npz, .op4 or .asm (Nastran superelement, with .op4 and .pch)
    """
    found = fanfold.export_body(scene, body, **asked["export_body"])
    click.echo(f"# {found.path}")
    click.echo(found.to_toml(), nl=False)


@made_of("export_view", name="export-view", path={"flags": "-o --out --output"})
def view_command(result: Path, asked: Asked, stress: bool = True, replace: bool = False) -> None:
    """Export RESULT for other programs: animated bodies (glb), fields (vtu), a table (csv), MATLAB (mat).

    Options
    -------
    stress
        vtu: von Mises stress, which takes time to compute
    """
    found = fanfold.export_view(
        result, **asked["export_view"], stress=None if stress else False, replace=replace
    )
    for path in found:
        click.echo(path)
