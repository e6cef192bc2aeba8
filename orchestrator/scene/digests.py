"""Digests of the files that a scene is made of besides its own: whether they still are what they were."""

from __future__ import annotations

from pathlib import Path

from components.contract.regular import content_digest

from .bodies import body_files
from .layers import files_besides
from .placed_scene import PlacedScene


def digests(scene: PlacedScene) -> dict[str, str]:
    """SHA-256 of the content of every such file by its path, empty where one cannot be read."""
    named = [Path(path) for path in files_besides(dict(scene.tree))]
    read = [path for body in scene.bodies for path in body_files(body)]
    return {str(path): _digest(path) for path in dict.fromkeys((*named, *read))}


def _digest(path: Path) -> str:
    try:
        return content_digest(path)
    except OSError:
        return ""
