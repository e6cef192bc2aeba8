"""Mechanics of deployable structures: one file per component, NumPy and SciPy only."""

from importlib import import_module
from pkgutil import iter_modules

from ._component import (
    REGISTRY,
    Component,
    ComponentError,
    Layout,
    Port,
    Quantity,
    port_layout,
)

for _module in iter_modules(__path__):
    import_module(f".{_module.name}", __name__)

__all__ = ["REGISTRY", "Component", "ComponentError", "Layout", "Port", "Quantity", "port_layout"]
