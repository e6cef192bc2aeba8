"""Components with some of their parameters changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from components.contract.component import Component


def prepared(component: Component, **start: Any) -> Any:
    """The constants of a component whose parameters have their start values except those given."""
    p = component.parameter_layout.start_values()
    for name, value in start.items():
        p[component.parameter_layout[name]] = value
    return component.prepare(p)


def made(
    kind: type[Component], mode: str = "mean", structure: Mapping[str, Any] | None = None, **start: Any
) -> tuple[Any, Any]:
    """A connection of a kind and wrench mode with its constants."""
    component = kind(**(structure or {}), wrench_mode=mode)
    return component, prepared(component, **start)
