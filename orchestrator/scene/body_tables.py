"""Tables of a scene file about bodies: the base, and what deploys from it."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from components.body import CouplingLevel

from .damping import StructuralDamping
from .table import ORIGIN, Inertia, Name, Place, Table
from .units import Frequency, Mass, Position, Ratio

Fidelity = Literal["rigid", "flexible"]


class Inertial(Table):
    """Mass properties; the inertia is about the centre of mass."""

    mass: Mass
    center_of_mass: Position = ORIGIN
    inertia: Inertia


class RigidBody(Inertial):
    """A rigid body written into the scene, with the points that connections use."""

    points: dict[Name, Position]


class Base(Table):
    """[base]: the spacecraft, fixed unless `free` gives its mass properties."""

    name: Name = "base"
    points: dict[Name, Position]
    free: Inertial | None = None


class AttachedMass(Table):
    """A mass fixed to a point of a body of the catalogue, such as a bracket."""

    point: str
    mass: Mass


class Body(Table):
    """[[body]]: panel, frame or both, an entry of the catalogue, or a rigid body; options of its flexible model.

    panel, frame, rigid_twin: tables that `components.catalogue.reader` reads, or changes to those of the catalogue
    entry. like: another body of the scene, whose keys are those of this one where it says nothing else.

    place: where the origin of a body that no hinge line carries starts, its offset in world axes, and how the body is
    turned; loops that its joints close are closed from there. damping_ratio: of all its modes; structural_damping: in
    proportion to their frequency, in place of the scene's. damping_scale multiplies what there is.
    """

    name: Name
    place: Place | None = None
    like: Name | None = None
    catalogue: str | None = None
    panel: dict[str, Any] | None = None
    frame: dict[str, Any] | None = None
    rigid_twin: dict[str, Any] | None = None
    rigid: RigidBody | None = None
    fidelity: Fidelity | None = None
    fixed_interface_modes: Annotated[int, Field(ge=0)] = 10
    inertia_coupling: CouplingLevel = "full"
    damping_ratio: Ratio | None = None
    structural_damping: StructuralDamping | None = None
    damping_scale: Ratio = 1.0
    modes_off: tuple[Annotated[int, Field(ge=0)], ...] = ()
    frequencies_off: tuple[tuple[Frequency, Frequency], ...] = ()
    attached_masses: tuple[AttachedMass, ...] = ()

    @property
    def can_bend(self) -> bool:
        """Whether the body has a flexible model."""
        return self.rigid is None

    @property
    def flexible(self) -> bool:
        """Whether the body is flexible unless the run says otherwise."""
        return self.can_bend and self.fidelity != "rigid"

    @property
    def definition_tables(self) -> dict[str, dict[str, Any]]:
        """The tables that say how the body is built, those that are given."""
        tables = {"panel": self.panel, "frame": self.frame, "rigid_twin": self.rigid_twin}
        return {key: table for key, table in tables.items() if table is not None}

    @property
    def masses(self) -> tuple[tuple[str, float], ...]:
        """Attached masses (kg) by point."""
        return tuple((attached.point, attached.mass) for attached in self.attached_masses)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        built = self.catalogue is not None or self.panel is not None or self.frame is not None
        if built == (self.rigid is not None) and self.like is None:
            raise ValueError("give either a catalogue entry, a table panel or frame, or a table rigid")
        if self.rigid is not None and self.fidelity == "flexible":
            raise ValueError("only a body of the catalogue, or with a panel or frame, can be flexible")
        if self.rigid is not None and self.attached_masses:
            raise ValueError("attached_masses belong to bodies that can bend; add them to the mass of rigid")
        return self

    @model_validator(mode="after")
    def _one_damping(self) -> Self:
        if self.structural_damping is not None and self.rigid is not None:
            raise ValueError("a rigid body has no modes that structural_damping could damp; leave it out")
        if self.structural_damping is not None and self.damping_ratio is not None:
            raise ValueError(
                "damping_ratio and structural_damping are two answers to one question; give one of them"
            )
        return self
