"""Components with some of their parameters changed."""

from __future__ import annotations

from typing import Any

from components.contract.component import Component


def prepared(component: Component, **start: Any) -> Any:
    """The constants of a component whose parameters have their start values except those given."""
    p = component.parameter_layout.start_values()
    for name, value in start.items():
        p[component.parameter_layout[name]] = value
    return component.prepare(p)
