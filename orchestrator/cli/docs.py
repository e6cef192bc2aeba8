"""`fanfold docs`: the documents in a browser, and the JSON schema of scene files."""

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
    "--browser/--no-browser", default=True, help="Open the first page in a browser, or only print its path."
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
    "--gallery/--no-gallery", default=True, help="Also run the examples, which takes one or two minutes."
)
@click.option("--rebuild", is_flag=True, help="Build in any case, for example to measure on this machine.")
@click.option(
    "--json-schema", "schema", type=OutputFile(),
    help="Only write the JSON schema of scene files, for editors, to this file.",
)  # fmt: skip
def command(browser: bool, out: Path | None, gallery: bool, rebuild: bool, schema: Path | None) -> None:
    """Build the documents if they are missing or out of date (needs the extra docs), and open them."""
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
