"""Pictures of what commands found, beside the numbers that they print."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

if TYPE_CHECKING:
    from ..api.pictures import Found


def pictures(found: Found, asked: Path | None, usual: Path) -> list[Path]:
    """Those written into the folder asked for, else into the usual one.

    None, and a sentence, where the usual one cannot be written to: the numbers need no folder.
    """
    try:
        return fanfold.plot(found, asked or usual)
    except OSError as error:
        if asked is not None:
            raise
        why = error.strerror or error
        click.echo(f"fanfold: warning: no pictures: {usual} cannot be written to ({why})", err=True)
        return []
