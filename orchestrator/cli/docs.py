"""`fanfold docs`: the documents in a browser, and the keys of scenes for editors."""

from __future__ import annotations

import json
from pathlib import Path

import click

import orchestrator as fanfold

from .types import OutputFile


@click.command("docs")
@click.option(
    "--json-schema", "schema", type=OutputFile(),
    help="Write the JSON schema of scene files, for editors, and nothing else.",
)  # fmt: skip
def command(schema: Path | None) -> None:
    """Open the documents."""
    if schema is not None:
        schema.write_text(
            json.dumps(fanfold.json_schema(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8"
        )
        click.echo(schema)
