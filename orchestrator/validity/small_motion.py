"""Parts of a scene that analyses of small motion omit."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..assembly.statics.steady_spin import turning_at
from ..scene import PlacedScene


def left_out(scene: PlacedScene, rigid: Collection[str], spinning: bool) -> Iterator[str]:
    """Sentences on large-deformation beams, which are modal in analyses, and on present and later spin.

    rigid: names of rigid bodies, or "all". spinning: the analysis linearises about the steady spin of a base.
    """
    name = scene.header.name
    bodies = [body.name for body in scene.bodies if body.default_fidelity == "large_deformation"]
    if beams := [] if "all" in rigid else [body for body in bodies if body not in rigid]:
        yield (
            f"{name}: the analysis uses linear modes for the large-deformation beams {', '.join(beams)}. Simulate "
            "with preload to find their static deflection."
        )
    turning = turning_at(scene, 0.0)
    if still := [body for body in turning if not (spinning and body == scene.base.name)]:
        yield (
            f"{name}: the analysis neglects the initial spin of {', '.join(still)}, and so its stiffening and "
            "gyroscopic terms."
        )
    if later := [body for body in turning_at(scene, scene.header.until) if body not in turning]:
        yield (
            f"{name}: the analysis is about rest, but {', '.join(later)} spins at {scene.header.until:g} s. For "
            "modes in spin, give it a motion law that starts with this rate."
        )
