"""What the mass properties of a body must be."""

from __future__ import annotations

import numpy as np

from ..contract.component import ComponentError
from ..flexible.modal import ModalData

_ROUNDED = 1e-3
"""Of the largest principal moment: flat bodies have it equal to the sum of the others, in data of four digits."""


def check_mass(data: ModalData) -> None:
    """Refuse mass, inertia and frequencies that no body has, or that leave rigid motion among the modes."""
    if not data.mass > 0.0:
        raise ComponentError(f"mass is {data.mass:g} kg; it must be positive")
    principal = np.linalg.eigvalsh(data.inertia)
    if not principal[0] > 0.0:
        raise ComponentError(f"a principal moment of inertia is {principal[0]:g} kg.m2; it must be positive")
    if principal[2] > principal[0] + principal[1] + _ROUNDED * principal[2]:
        a, b, c = (f"{v:g}" for v in principal)
        raise ComponentError(
            f"principal moments of inertia {a}, {b}, {c} kg.m2 violate the triangle inequality {a} + {b} >= {c}"
        )
    if not np.all(data.frequency > 0.0):
        raise ComponentError("every mode must have a positive frequency; remove the rigid modes first")
