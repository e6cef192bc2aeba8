"""A scene: a file with its layers, checked, as records; knows no co-simulation."""

from .placed_scene import PlacedScene
from .reader import find_scene, list_scenes, load_scene, read_scene, scene_variants
from .table import SceneError

__all__ = [
    "PlacedScene",
    "SceneError",
    "find_scene",
    "list_scenes",
    "load_scene",
    "read_scene",
    "scene_variants",
]
