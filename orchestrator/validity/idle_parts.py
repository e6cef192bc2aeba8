"""Parts of a scene without effect, or only after the end of the run."""

from __future__ import annotations

from collections.abc import Iterator

from components.hold_down import HoldDown

from ..messages import coded
from ..scene.component_connections import first_number
from ..scene.placed_scene import PlacedScene

_EFFECTS = {
    "load": ("force", "torque", "added_force", "added_torque"),
    "spring": ("stiffness", "preload", "damping", "tension"),
}
"""What gives a component a force, by its kind."""


def idle_part_warnings(scene: PlacedScene, until: float) -> Iterator[str]:
    """Sentences with their keys, for a run to `until` (s)."""
    yield from coded("W-idle-load", _without_load(scene))
    yield from coded("W-idle-load", _released_too_late(scene, until))
    yield from coded("W-event", _events_too_late(scene, until))


def _without_load(scene: PlacedScene) -> Iterator[str]:
    """Loads and springs without a force that nothing sets during the run."""
    outputs = [target for fmu in scene.fmus for name in fmu.outputs for target in fmu.targets(name)]
    driven = {target.partition(".")[0] for target in outputs}.union(*(event.set for event in scene.events))
    for one in scene.connections:
        effects, values = _EFFECTS.get(one.kind, ()), {**one.structure, **one.parameters}
        if effects and one.name not in driven and not any(values.get(effect) for effect in effects):
            yield (
                f"connection.{one.name}: this {one.kind} has no force, and no event or FMU gives it one. Set one of "
                f"{', '.join(effects)}, or remove the {one.kind}."
            )


def _released_too_late(scene: PlacedScene, until: float) -> Iterator[str]:
    """Hold-downs that are released after the end of the run."""
    for bolt in (one for one in scene.connections if one.kind == HoldDown.kind):
        release = first_number(bolt, "release_time")
        if release > until:
            yield (
                f"connection.{bolt.name}: its release_time of {release:g} s is after the end of the run at "
                f"{until:g} s. Release it earlier, or run longer."
            )


def _events_too_late(scene: PlacedScene, until: float) -> Iterator[str]:
    """Events whose time is after the end of the run."""
    for event in scene.events:
        if event.time is not None and event.time > until:
            yield (
                f"event.{event.name}.time: {event.time:g} s is after the end of the run at {until:g} s, so it does not "
                "happen. Move the event, or run longer."
            )
