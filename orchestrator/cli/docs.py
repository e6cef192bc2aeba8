"""`fanfold docs`: the documents in a browser, and the keys of scenes for editors."""

from __future__ import annotations

import json
import webbrowser
from pathlib import Path

import click

import orchestrator as fanfold

from ..api.options import OutputFile
from .command import Asked, made_of
from .progress import working


@made_of("docs", name="docs", folder={"flags": "-o --out --output"}, schema={"flags": "--json-schema"})
def command(asked: Asked, schema: OutputFile | None = None, browser: bool = True) -> None:
    """Open the documents as HTML. They are built first if necessary, which needs the extra docs.

    Options
    -------
    schema
        write the JSON schema of scene files, for editors, and nothing else
    browser
        open the first page in a browser; its path is printed
    """
    if schema is not None:
        path = Path(schema)
        text = json.dumps(fanfold.json_schema(), indent=1, ensure_ascii=False)
        path.write_text(f"{text}\n", encoding="utf-8")
        click.echo(path)
        return
    with working("docs"):
        page = fanfold.docs(**asked["docs"])
    click.echo(page)
    if browser:
        webbrowser.open(page.resolve().as_uri())
