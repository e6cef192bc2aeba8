"""`fanfold list`: what comes with Fanfold."""

from __future__ import annotations

import click
from rich.console import Console
from rich.table import Table

from components import REGISTRY

from ..scene import find_scene, list_scenes, load_scene, scene_variants


@click.command("list")
def command() -> None:
    """Scenes that come with Fanfold, and the components they are made of."""
    scenes = Table("scene", "description", "bodies", "variants")
    for name in list_scenes():
        scene = load_scene(find_scene(name))
        bodies = ", ".join(body.name for body in scene.bodies)
        scenes.add_row(name, scene.header.description, bodies, ", ".join(scene_variants(find_scene(name))))
    kinds = Table("component", "what it is")
    for kind, component in sorted(REGISTRY.items()):
        kinds.add_row(kind, (component.__doc__ or "").strip().splitlines()[0])
    console = Console()
    console.print(scenes)
    console.print(kinds)
