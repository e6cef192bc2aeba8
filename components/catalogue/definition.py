"""A body as it was written down, and what follows from it: finite elements, modes, the rigid twin.

Frames: x outboard, y along the hinge lines, z normal; the origin is where the body's writer put it, for the bodies
of the catalogue in the middle of the inboard hinge line.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, reduce
from importlib.metadata import version
from importlib.resources import files
from math import isfinite
from typing import Any, TypeAlias

import numpy as np
import scipy
from threadpoolctl import threadpool_limits

from ..cache.disk import kept
from ..contract.component import ComponentError, Vector
from ..contract.frames import skew
from ..flexible.finite_elements import FiniteElementModel
from ..flexible.joined import joined
from ..flexible.modal import ModalData
from ..flexible.plate import Geometry, Panel
from ..flexible.reduction import craig_bampton
from ..flexible.stress import FaceSheets
from ..imported.body import ImportedBody
from .beam import BeamBody
from .frame import Frame

PointMasses: TypeAlias = tuple[tuple[str, float], ...]
"""Point masses in kg at named points of a body."""

_SOURCES = ("contract", "flexible", "beam_parts", "imported", "catalogue")
"""Folders of all that turns definitions into bodies."""
_LIBRARIES = ("numpy", "scipy", "scikit-fem")
_SYMMETRIC = 1e-11
"""Of the body's size or inertia: the round-off of a sum over 1e5 samples, which symmetry would cancel."""


@dataclass(frozen=True)
class RigidTwin:
    """What a data sheet says of the rigid twin, where it differs from the flexible body."""

    hardware: bool = True
    """whether the masses at the ends of the hinge arms are part of it"""
    mass: float | None = None
    """kg"""
    center_of_mass: float | None = None
    """x, m; the body is symmetric in y and z then"""
    inertia: float | None = None
    """about y through the centre of mass, kg m2"""


@dataclass(frozen=True)
class BodyDefinition:
    """A panel, a frame, both welded where an arm of the panel and a joint of the frame have one name, a beam, or files.

    What the tables panel, frame, beam and import of a body say.
    """

    panel: Panel | None
    frame: Frame | None
    attachment_points: tuple[str, ...]
    nodes: tuple[str, ...]
    twin: RigidTwin = RigidTwin()
    face_sheets: FaceSheets | None = None
    beam: BeamBody | None = None
    imported: ImportedBody | None = None

    @property
    def points(self) -> tuple[str, ...]:
        """Attachment points, then nodes."""
        return (*self.attachment_points, *self.nodes)

    def finite_elements(self, masses: PointMasses = ()) -> FiniteElementModel:
        """Finite elements with point masses fixed to its points."""
        from ..flexible.panel import (
            panel_model,  # scikit-fem takes its time, which bodies from the cache do not need
        )

        self._check(masses)
        if self.beam is not None:
            return with_masses(self.beam.model(self.points), masses)
        if self.imported is not None:
            return with_masses(self.imported.model(), masses)
        arms = () if self.panel is None else self.panel.arms
        models = [] if self.panel is None else [panel_model(self.panel)]
        if self.frame is not None:
            met = {*self.points, *(arm.name for arm in arms)}
            models.append(self.frame.model([name for name, _ in self.frame.joints if name in met]))
        return with_masses(reduce(joined, models), masses)

    def flexible(
        self, fixed_interface_modes: int = 10, masses: PointMasses = (), second_order_modes: int = 0
    ) -> ModalData:
        """Craig-Bampton body: so many fixed-interface modes and six a attachment point, less the rigid motions.

        second_order_modes: so many of the lowest displace it to second order too; those of plates of von Karman's
        geometry stretch them besides, and 0 are then all that bend them.
        """
        self._check(masses)

        def reduced() -> ModalData:
            model, count = self.finite_elements(masses), self.fixed_interface_modes(fixed_interface_modes)
            if self.imported is not None and second_order_modes:
                raise ComponentError(
                    "second_order_modes: matrices tell nothing of strains to second order; leave it out"
                )
            geometry: Geometry = "linear" if self.panel is None else self.panel.plate.geometry
            return craig_bampton(
                model, self.attachment_points, count, self.nodes, second_order_modes, geometry
            )

        return _cached(reduced, self, fixed_interface_modes, masses, second_order_modes)

    def fixed_interface_modes(self, asked: int) -> int:
        """How many there will be: as many as asked for, but of reduced matrices no more than they have."""
        return asked if self.imported is None else self.imported.modes(asked)

    def rigid(self, masses: PointMasses = ()) -> ModalData:
        """Rigid twin: the points of the flexible body, and its mass properties or those of its data sheet."""
        self._check(masses)
        return rigid_with_masses(_cached(self._twin, self), masses)

    def _twin(self) -> ModalData:
        bare = self
        if self.panel is not None and not self.twin.hardware:
            arms = tuple(replace(arm, point_mass=0.0) for arm in self.panel.arms)
            bare = replace(self, panel=replace(self.panel, arms=arms))
        return _on_sheet(rigid_body(bare.finite_elements(), self.points), self.twin)

    def _check(self, masses: PointMasses) -> None:
        for name, mass in masses:
            if name not in self.points:
                known = ", ".join(self.points)
                raise ComponentError(f"a mass is attached to {name!r}; the body's points are {known}")
            if not (isfinite(mass) and mass > 0.0):
                raise ComponentError(f"the mass attached to {name!r} is {mass} kg; it must be positive")


def with_masses(model: FiniteElementModel, masses: PointMasses) -> FiniteElementModel:
    """The finite elements with point masses fixed to attachment points or nodes."""
    if not masses:
        return model
    return replace(
        model,
        masses=np.append(model.masses, [mass for _, mass in masses]),
        positions=np.vstack([model.positions, *(model.point_positions[name] for name, _ in masses)]),
        displacement=scipy.sparse.csr_array(
            scipy.sparse.vstack([model.displacement, *(model.point_motions[name][:3] for name, _ in masses)])
        ),
    )


def rigid_with_masses(body: ModalData, masses: PointMasses) -> ModalData:
    """A rigid body with point masses fixed to its points: sums and parallel axes, exact."""
    if not masses:
        return body
    places = [body.point_positions[body.point_names.index(name)] for name, _ in masses]
    parts = [(body.mass, body.center_of_mass), *zip((mass for _, mass in masses), places, strict=True)]
    total = sum(mass for mass, _ in parts)
    center = sum((mass * place for mass, place in parts), np.zeros(3)) / total
    inertia = sum((mass * _square(place - center) for mass, place in parts), body.inertia)
    return replace(body, mass=total, center_of_mass=center, inertia=inertia)


def _square(arm: Vector) -> Vector:
    """Inertia (3, 3) of a unit mass at an arm (3,)."""
    cross = skew(arm)
    result: Vector = cross.T @ cross
    return result


def rigid_body(model: FiniteElementModel, points: Sequence[str]) -> ModalData:
    """Rigid body with the mass properties of finite elements; what symmetry forbids is zero and not round-off."""
    places = model.positions if len(model.positions) else np.array(list(model.point_positions.values()))
    size = np.ptp(places, axis=0).max()
    center, inertia = model.center_of_mass, model.inertia
    return ModalData.rigid(
        model.mass,
        np.where(np.abs(center) > _SYMMETRIC * size, center, 0.0),
        np.where(np.abs(inertia) > _SYMMETRIC * np.trace(inertia), inertia, 0.0),
        {name: model.point_positions[name] for name in points},
        model.display_positions,
        model.display_faces,
    )


def _on_sheet(body: ModalData, sheet: RigidTwin) -> ModalData:
    """Mass, centre of mass and inertia about y of a data sheet where it has them, the rest of the body.

    The inertia about z changes as much as that about y, as the perpendicular-axis theorem wants it.
    """
    mass = body.mass if sheet.mass is None else sheet.mass
    if sheet.center_of_mass is not None:
        body = replace(body, center_of_mass=np.array((sheet.center_of_mass, 0.0, 0.0)))
    if sheet.inertia is None:
        return replace(body, mass=mass)
    change = sheet.inertia - body.inertia[1, 1]
    inertia = body.inertia + np.diag((0.0, change, change))
    small, middle, large = np.linalg.eigvalsh(inertia)
    if small < 0.0 or small + middle < (1.0 - _SYMMETRIC) * large:
        raise ComponentError(
            f"rigid_twin.inertia is {sheet.inertia} kg.m2; with it the principal moments {small:g}, {middle:g}, "
            f"{large:g} kg.m2 violate the triangle inequality"
        )
    return replace(body, mass=mass, inertia=inertia)


def _cached(build: Callable[[], ModalData], definition: BodyDefinition, *further: object) -> ModalData:
    """What `build` returns, kept under the content of the definition and of all that turns it into a body."""
    key = json.dumps([_content(definition), further, _sources()], sort_keys=True)

    def content() -> bytes:
        buffer = io.BytesIO()
        with threadpool_limits(1):  # with more, sums differ in their last bits from machine to machine
            np.savez(buffer, allow_pickle=False, **build().to_arrays())
        return buffer.getvalue()

    with np.load(io.BytesIO(kept("modal", hashlib.sha256(key.encode()).hexdigest(), content))) as stored:
        return ModalData.from_arrays(stored)


def _content(definition: BodyDefinition) -> dict[str, Any]:
    """All of a definition that bodies follow from."""
    content = asdict(definition)
    del content["face_sheets"]
    return content


@cache
def _sources() -> str:
    """Digest of the sources and versions of the libraries that turn definitions into bodies."""
    content = hashlib.sha256(json.dumps([version(name) for name in _LIBRARIES]).encode())
    for folder in _SOURCES:
        found = [file for file in (files("components") / folder).iterdir() if file.name.endswith(".py")]
        for file in sorted(found, key=lambda file: file.name):
            content.update(file.read_bytes())
    return content.hexdigest()
