"""Components of plugins, tried where they start: what a scene's run would find of them only on its way."""

from __future__ import annotations

from collections.abc import Iterator
from inspect import getfile
from pathlib import Path

import numpy as np

from components import REGISTRY, Component, ComponentError
from components.contract.plugins import line_in

from ..placed_scene import PlacedScene

_STEP = 1e-3
"""Size of the step that is tried, s."""


def plugin_problems(scene: PlacedScene) -> Iterator[str]:
    """A sentence for each connection of a plugin whose component has an unknown unit or fails in a step at rest."""
    for connection in scene.connections:
        kind = REGISTRY.get(connection.kind)
        if kind is None or not kind.comes_from_outside():
            continue
        place = Path(getfile(kind))
        try:
            instance = scene.seated(connection)
            _check_units(instance.component)
            instance.initialize()
            instance.step(_STEP)
            _check_numbers(instance.component, instance.outputs(), instance.observe())
        except Exception as error:  # of whoever wrote it
            said = str(error) if isinstance(error, ComponentError) else f"{type(error).__name__}: {error}"
            yield f"connection.{connection.name}: {connection.kind} of {place}{line_in(place, error)}: {said}"


def _check_units(component: Component) -> None:
    """ComponentError where a unit is not one that FMUs may state."""
    from fmus.description.units import check_unit  # takes its time, which scenes without plugins need not

    for layout in (*component.layouts, component.state_layout):
        for quantity in layout.quantities:
            for unit in filter(None, (quantity.unit, quantity.rate_unit)):
                try:
                    check_unit(unit)
                except ComponentError as error:
                    raise ComponentError(f"{quantity.name}: {error}") from None


def _check_numbers(component: Component, outputs: np.ndarray, observations: np.ndarray) -> None:
    """ComponentError where numbers are not as many as declared, or not finite."""
    for values, layout in ((outputs, component.output_layout), (observations, component.observation_layout)):
        if values.shape != (layout.size,):
            raise ComponentError(f"gives {values.size} numbers where {layout.size} are declared")
        if not np.isfinite(values).all():
            name = layout.scalar_names()[int(np.argmin(np.isfinite(values)))]
            raise ComponentError(
                f"{name} is {values[~np.isfinite(values)][0]} after a step of {_STEP:g} s at rest"
            )
