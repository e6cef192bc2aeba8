"""`fanfold cache`: location and size of the cache on disk."""

from __future__ import annotations

import click

import orchestrator as fanfold

from .command import Asked, made_of


@made_of("cache", name="cache")
def command(asked: Asked) -> None:
    """Print the location and size of the cache of reduced bodies and compressed FMU code."""
    found = fanfold.cache(**asked["cache"])
    if found.sentence:
        click.echo(f"fanfold: warning: {found.sentence}", err=True)
    click.echo(f"{found.folder or 'no folder'}: {found.files} files, {found.size / 1e6:.1f} MB", nl=False)
    click.echo(" removed" if asked["cache"]["clear"] else f" of {found.limit / 1e6:.0f} MB at most")
