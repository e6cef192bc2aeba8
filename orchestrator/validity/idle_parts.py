"""Parts of a scene without effect, or only after the end of the run."""

from __future__ import annotations

from collections.abc import Iterator

from components.hold_down import HoldDown

from ..messages import coded
from ..scene.component_connections import first_number
from ..scene.placed_scene import PlacedScene


def idle_part_warnings(scene: PlacedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-idle-load", _without_load(scene))
    yield from coded("W-idle-load", _released_too_late(scene))


def _without_load(scene: PlacedScene) -> Iterator[str]:
    """Loads without a law that nothing sets during the run."""
    outputs = [target for fmu in scene.fmus for name in fmu.outputs for target in fmu.targets(name)]
    driven = {target.partition(".")[0] for target in outputs}.union(*(event.set for event in scene.events))
    for one in scene.connections:
        is_empty = not any((one.structure.get("force"), one.structure.get("torque"), one.parameters))
        if one.kind == "load" and is_empty and one.name not in driven:
            yield (
                f"connection.{one.name}: this load has no force and no torque, and no event or FMU sets "
                "added_force or added_torque. Set one of them, or remove the load."
            )


def _released_too_late(scene: PlacedScene) -> Iterator[str]:
    """Hold-downs that are released after the end of the run."""
    for bolt in (one for one in scene.connections if one.kind == HoldDown.kind):
        release = first_number(bolt, "release_time")
        if release > scene.header.until:
            yield (
                f"connection.{bolt.name}: its release_time of {release:g} s is after the end of the run at "
                f"{scene.header.until:g} s. Release it earlier, or run longer."
            )
