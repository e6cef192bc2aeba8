"""Pictures of analyses that commands write in addition to numbers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

import orchestrator as fanfold

if TYPE_CHECKING:
    from ..api.options import Folder
    from ..api.pictures import Found


def pictures(found: Found, asked: Folder | None, usual: Path) -> list[Path]:
    """Pictures in the requested folder, or else in the usual folder.

    If the usual folder is not writable, there are none, with a warning.
    """
    try:
        return fanfold.plot(found, asked or usual)
    except OSError as error:
        if asked is not None:
            raise
        why = error.strerror or error
        click.echo(f"fanfold: warning: no pictures: {usual} cannot be written to ({why})", err=True)
        return []
