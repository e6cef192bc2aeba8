"""`fanfold docs`: the documents in a browser, and the keys of scenes for editors."""

from __future__ import annotations

import json
import webbrowser
from pathlib import Path

import click

import orchestrator as fanfold

from .progress import working
from .types import OutputFile


@click.command("docs")
@click.option(
    "--browser/--no-browser",
    default=True,
    help="Whether a browser opens the first page; its path is printed.",
)
@click.option(
    "-o",
    "--out",
    "--output",
    "out",
    type=click.Path(path_type=Path, file_okay=False),
    help="Folder of the pages; by default next to the cache.",
)
@click.option(
    "--gallery/--no-gallery", default=True, help="Whether the examples run too, which takes a minute."
)
@click.option("--rebuild", is_flag=True, help="Build again, and measure on this machine again.")
@click.option(
    "--json-schema", "schema", type=OutputFile(),
    help="Write the JSON schema of scene files, for editors, and nothing else.",
)  # fmt: skip
def command(browser: bool, out: Path | None, gallery: bool, rebuild: bool, schema: Path | None) -> None:
    """Open the documents as HTML. They are built first if necessary, which needs the extra docs."""
    if schema is not None:
        text = json.dumps(fanfold.json_schema(), indent=1, ensure_ascii=False)
        schema.write_text(f"{text}\n", encoding="utf-8")
        click.echo(schema)
        return
    with working("docs"):
        page = fanfold.docs(out, gallery=gallery, rebuild=rebuild)
    click.echo(page)
    if browser:
        webbrowser.open(page.resolve().as_uri())
