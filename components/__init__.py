"""Mechanics of deployable structures: one file per component kind beside this one, NumPy and SciPy only.

What kinds share stands in folders, which are not looked through for kinds: `contract`, `numerics`, parts of one kind
under its name, `flexible` bodies and the `catalogue` of wings with its `data`.
"""

from importlib import import_module
from pkgutil import iter_modules

from .contract.component import (
    REGISTRY,
    Component,
    ComponentError,
    ContinuousStates,
    Layout,
    Port,
    Quantity,
    port_layout,
)
from .contract.errors import FanfoldError
from .contract.frames import left_product, rotation_matrix
from .contract.instance import Instance
from .contract.roles import (
    DISSIPATED_ENERGY,
    KINETIC_ENERGY,
    LAGGED,
    NUMERICAL_DISSIPATION,
    POTENTIAL_ENERGY,
    SUPPLIED_ENERGY,
)

for _module in iter_modules(__path__):
    if not _module.ispkg:
        import_module(f".{_module.name}", __name__)

__all__ = [
    "DISSIPATED_ENERGY",
    "KINETIC_ENERGY",
    "LAGGED",
    "NUMERICAL_DISSIPATION",
    "POTENTIAL_ENERGY",
    "REGISTRY",
    "SUPPLIED_ENERGY",
    "Component",
    "ComponentError",
    "ContinuousStates",
    "FanfoldError",
    "Instance",
    "Layout",
    "Port",
    "Quantity",
    "left_product",
    "port_layout",
    "rotation_matrix",
]
