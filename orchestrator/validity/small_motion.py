"""What analyses of small motion leave out of a scene."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from ..assembly.statics.steady_spin import turning_at
from ..scene import CheckedScene


def left_out(scene: CheckedScene, rigid: Collection[str], spinning: bool) -> Iterator[str]:
    """Sentences on beams of large deformation, which are modal here, on what turns, and on what will.

    rigid: bodies that are taken as such, or "all". spinning: whether the analysis is about the steady spin of a base.
    """
    name = scene.header.name
    bodies = [body.name for body in scene.bodies if body.default_fidelity == "large_deformation"]
    if beams := [] if "all" in rigid else [body for body in bodies if body not in rigid]:
        yield (
            f"{name}: analyses take {', '.join(beams)} as modal, which bend linearly; what a beam of large deformation "
            "does under static loads, a run that starts with preload finds"
        )
    turning = turning_at(scene, 0.0)
    if still := [body for body in turning if not (spinning and body == scene.base.name)]:
        yield (
            f"{name}: analyses take {', '.join(still)} as at rest, though it turns where its law begins; what spin "
            "stiffens and what rates do is left out"
        )
    if later := [body for body in turning_at(scene, scene.header.until) if body not in turning]:
        yield (
            f"{name}: {', '.join(later)} begins at rest, as analyses take it, and turns at {scene.header.until:g} s; "
            "give it a law that begins with its rate for those of its spin"
        )
