"""Scene texts with one component of every kind, and how tests load them."""

from __future__ import annotations

from pathlib import Path

import pytest

from orchestrator.assembly import Assembly, Part
from orchestrator.scene import PlacedScene, SceneError, find_scene, load_scene
from tests.references.edits import edited

SCENES = Path(__file__).parents[2] / "scenes"
TWO_PANELS = (SCENES / "two_panels.toml").read_text(encoding="utf-8")
DAMPER = '[[damper]]\nname = "damper"\nhinge = "root"\ndamping_coefficient = 2.0\n'
CCL = (
    '[[ccl]]\nname = "loop"\npreload = "40 N"\nstrand_stiffness = "5 N/mm"\n'
    'pulley_1 = { body = "base", point = "root", offset = [0.0, 0.6, 0.0], radius = "30 mm" }\n'
    'pulley_2 = { body = "outer", point = "left", offset = [0.0, 0.1, 0.0], radius = "30 mm" }\n'
)
LATCH = "latch = { stiffness = 2000, outboard_stiffness = 2500, effective_inertia = 5 }\n"
HINGES = 'hinges = [{ name = "root", inboard = "root", outboard = "root" }]'
STOP = (
    '[[connection]]\nname = "stop"\nkind = "contact"\nstructure = { normal = [1.0, 0.0, 0.0] }\n'
    'ports = { inboard = { body = "base", point = "root" }, outboard = { body = "inner", point = "tip_left" } }\n'
    'parameters = { gap = "0 m", reference_penetration = "1 mm" }\n'
)
AMOS3_BODIES = ("yoke", "panel1", "panel2")
COMPLETE = edited(TWO_PANELS, (HINGES, LATCH + HINGES)) + DAMPER + CCL + STOP


def load_text(folder: Path, text: str) -> PlacedScene:
    """The scene of a text, as the file wing.toml."""
    path = folder / "wing.toml"
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def problems_of(folder: Path, text: str) -> list[str]:
    """Every problem of a text that has some."""
    with pytest.raises(SceneError) as caught:
        load_text(folder, text)
    return caught.value.problems


def amos3() -> PlacedScene:
    """The AMOS-3 wing in orbit."""
    return load_scene(find_scene("amos3"))


def amos3_text() -> str:
    """The same as a text to change."""
    return find_scene("amos3").read_text(encoding="utf-8")


def parts_of(assembly: Assembly) -> dict[str, Part]:
    """Parts by name."""
    return {part.name: part for part in assembly.parts}
