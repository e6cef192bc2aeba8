"""`fanfold list`: what comes with Fanfold."""

from __future__ import annotations

import click

import orchestrator as fanfold


@click.command("list")
def command() -> None:
    """Scenes that come with Fanfold, and the components they are made of."""
    from rich.table import Table

    from components import REGISTRY

    from .tables import terminal

    scenes = Table("scene", "description", "bodies", "variants")
    for name in fanfold.scenes():
        scene = fanfold.load(name)
        description = scene.tree["scene"].get("description", "")
        scenes.add_row(name, description, ", ".join(scene.bodies), ", ".join(scene.variants))
    kinds = Table("component", "what it is")
    for kind, component in sorted(REGISTRY.items()):
        kinds.add_row(kind, (component.__doc__ or "").strip().splitlines()[0])
    console = terminal()
    console.print(scenes)
    console.print(kinds)
