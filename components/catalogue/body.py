"""What makes a body of the catalogue: its finite elements, attachment points and nodes; added point masses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isfinite
from typing import NamedTuple, TypeAlias

import numpy as np
from scipy import sparse

from ..contract.component import ComponentError, Vector
from ..contract.frames import skew
from ..flexible.finite_elements import FiniteElementModel
from ..flexible.modal import ModalData

PointMasses: TypeAlias = tuple[tuple[str, float], ...]
"""Point masses in kg at named points of a body."""


class CatalogueBody(NamedTuple):
    """How a body is built and what a scene can connect to."""

    build: Callable[[], FiniteElementModel]
    attachment_points: tuple[str, ...]
    nodes: tuple[str, ...]

    @property
    def points(self) -> tuple[str, ...]:
        """Attachment points, then nodes."""
        return (*self.attachment_points, *self.nodes)


def with_masses(model: FiniteElementModel, masses: PointMasses) -> FiniteElementModel:
    """The finite elements with point masses fixed to attachment points or nodes."""
    if not masses:
        return model
    _check(masses, tuple(model.point_positions))
    return replace(
        model,
        masses=np.append(model.masses, [mass for _, mass in masses]),
        positions=np.vstack([model.positions, *(model.point_positions[name] for name, _ in masses)]),
        displacement=sparse.csr_array(
            sparse.vstack([model.displacement, *(model.point_motions[name][:3] for name, _ in masses)])
        ),
    )


def rigid_with_masses(body: ModalData, masses: PointMasses) -> ModalData:
    """A rigid body with point masses fixed to its points: sums and parallel axes, exact."""
    if not masses:
        return body
    _check(masses, body.point_names)
    places = [body.point_positions[body.point_names.index(name)] for name, _ in masses]
    parts = [(body.mass, body.center_of_mass), *zip((mass for _, mass in masses), places, strict=True)]
    total = sum(mass for mass, _ in parts)
    center = sum((mass * place for mass, place in parts), np.zeros(3)) / total
    inertia = sum((mass * _square(place - center) for mass, place in parts), body.inertia)
    return replace(body, mass=total, center_of_mass=center, inertia=inertia)


def symmetric_rigid_body(model: FiniteElementModel, points: Sequence[str]) -> ModalData:
    """Rigid body with the mass properties of finite elements that are symmetric in y and z.

    What symmetry forbids is zero and not round-off.
    """
    return ModalData.rigid(
        model.mass,
        (model.center_of_mass[0], 0.0, 0.0),
        np.diag(np.diag(model.inertia)),
        {name: model.point_positions[name] for name in points},
        model.display_positions,
        model.display_faces,
    )


def _square(arm: Vector) -> Vector:
    """Inertia (3, 3) of a unit mass at an arm (3,)."""
    cross = skew(arm)
    result: Vector = cross.T @ cross
    return result


def _check(masses: PointMasses, points: tuple[str, ...]) -> None:
    for name, mass in masses:
        if name not in points:
            raise ComponentError(f"a mass is attached to {name!r}; the body's points are {', '.join(points)}")
        if not (isfinite(mass) and mass > 0.0):
            raise ComponentError(f"the mass attached to {name!r} is {mass} kg; it must be positive")
