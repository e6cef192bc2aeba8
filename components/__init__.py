"""Mechanics of deployable structures: one file per component, NumPy and SciPy only."""

from importlib import import_module
from pkgutil import iter_modules

from ._component import (
    DISSIPATED_ENERGY,
    KINETIC_ENERGY,
    NUMERICAL_DISSIPATION,
    POTENTIAL_ENERGY,
    REGISTRY,
    SUPPLIED_ENERGY,
    Component,
    ComponentError,
    ContinuousStates,
    Layout,
    Port,
    Quantity,
    port_layout,
)
from ._frames import left_product, rotation_matrix

for _module in iter_modules(__path__):
    import_module(f".{_module.name}", __name__)

__all__ = [
    "DISSIPATED_ENERGY",
    "KINETIC_ENERGY",
    "NUMERICAL_DISSIPATION",
    "POTENTIAL_ENERGY",
    "REGISTRY",
    "SUPPLIED_ENERGY",
    "Component",
    "ComponentError",
    "ContinuousStates",
    "Layout",
    "Port",
    "Quantity",
    "left_product",
    "port_layout",
    "rotation_matrix",
]
