"""Tables of a scene file about bodies: the base, and what deploys from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from components import ComponentError
from components.body import CouplingLevel
from components.numerics.motion_law import NOTHING, MotionLaw

from .damping import StructuralDamping
from .table import ORIGIN, Direction, Inertia, Name, Place, Table
from .units import Frequency, Mass, Position, Ratio

Fidelity = Literal["rigid", "flexible", "large_deformation"]


class Inertial(Table):
    """Mass properties; the inertia is about the centre of mass."""

    mass: Mass
    center_of_mass: Position = ORIGIN
    inertia: Inertia


class RigidBody(Inertial):
    """A rigid body written into the scene, with the points that connections use."""

    points: dict[Name, Position]


class Motion(Table):
    """What moves a base or a placed body whatever it takes: a shift along an axis and a turn about another, world axes.

    translation, rotation: terms of motion laws (m, rad), see `components.numerics.motion_law`, counted from where the
    body was written; the scene starts where they do. pivot: the body's own point that stays on the shifted line.
    """

    translation: tuple[Mapping[str, Any], ...] = NOTHING
    rotation: tuple[Mapping[str, Any], ...] = NOTHING
    translation_axis: Direction = (1.0, 0.0, 0.0)
    rotation_axis: Direction = (0.0, 0.0, 1.0)
    pivot: Position = ORIGIN

    @property
    def laws(self) -> tuple[MotionLaw, MotionLaw]:
        """Of the shift (m) and of the turn (rad)."""
        return MotionLaw(self.translation), MotionLaw(self.rotation)

    @model_validator(mode="after")
    def _moves(self) -> Self:
        try:
            self.laws  # noqa: B018 - says what is wrong with the terms
        except ComponentError as error:
            raise ValueError(str(error)) from None
        if (self.translation, self.rotation) == (NOTHING, NOTHING):
            raise ValueError("there is neither a translation nor a rotation; give the terms of a motion law")
        return self


class Base(Table):
    """[base]: the spacecraft, fixed unless `free` gives its mass properties or `motion` moves it."""

    name: Name = "base"
    points: dict[Name, Position]
    free: Inertial | None = None
    motion: Motion | None = None

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.free is not None and self.motion is not None:
            raise ValueError("a base that is free moves by the loads on it; give either free or motion")
        return self


class AttachedMass(Table):
    """A mass fixed to a point of a body of the catalogue, such as a bracket."""

    point: str
    mass: Mass


class Body(Table):
    """[[body]]: panel, frame or both, beam, an entry of the catalogue, or a rigid body; options of its flexible model.

    panel, frame, beam, import, rigid_twin: tables that `components.catalogue.reader` reads, or changes to those of the
    catalogue entry. like: another body of the scene, whose keys are those of this one where it says nothing else.

    place: where the origin of a body that no hinge line carries starts, its offset in world axes, and how the body is
    turned; loops that its joints close are closed from there. motion: what a placed body follows, rigid, whatever it
    takes. second_order_modes: so many of the lowest modes shorten what they bend, so that spin stiffens it.
    damping_ratio: of all its modes; structural_damping: in proportion to their frequency, in place of the scene's.
    damping_scale multiplies what there is.
    """

    name: Name
    place: Place | None = None
    motion: Motion | None = None
    like: Name | None = None
    catalogue: str | None = None
    panel: dict[str, Any] | None = None
    frame: dict[str, Any] | None = None
    beam: dict[str, Any] | None = None
    imported: dict[str, Any] | None = Field(None, alias="import")
    rigid_twin: dict[str, Any] | None = None
    rigid: RigidBody | None = None
    fidelity: Fidelity | None = None
    fixed_interface_modes: Annotated[int, Field(ge=0)] = 10
    second_order_modes: Annotated[int, Field(ge=0)] = 0
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
        return self.rigid is None and self.motion is None

    @property
    def default_fidelity(self) -> Fidelity:
        """Its fidelity unless the run says otherwise."""
        return (self.fidelity or "flexible") if self.can_bend else "rigid"

    @property
    def definition_tables(self) -> dict[str, dict[str, Any]]:
        """The tables that say how the body is built, those that are given."""
        tables = {
            "panel": self.panel,
            "frame": self.frame,
            "beam": self.beam,
            "import": self.imported,
            "rigid_twin": self.rigid_twin,
        }
        return {key: table for key, table in tables.items() if table is not None}

    @property
    def masses(self) -> tuple[tuple[str, float], ...]:
        """Attached masses (kg) by point."""
        return tuple((attached.point, attached.mass) for attached in self.attached_masses)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        sources = (self.catalogue, self.panel, self.frame, self.beam, self.imported)
        built = any(one is not None for one in sources)
        if built == (self.rigid is not None) and self.like is None:
            raise ValueError(
                "give either a catalogue entry, a table panel, frame, beam or import, or a table rigid"
            )
        if self.rigid is not None and self.fidelity == "flexible":
            raise ValueError(
                "only a body of the catalogue, or with a panel, frame, beam or import, can be flexible"
            )
        if self.rigid is not None and self.fidelity == "large_deformation":
            raise ValueError("only a body with a beam can deform largely; give it a table beam")
        if self.rigid is not None and self.attached_masses:
            raise ValueError("attached_masses belong to bodies that can bend; add them to the mass of rigid")
        return self

    @model_validator(mode="after")
    def _second_order_of_modes(self) -> Self:
        if self.second_order_modes and self.rigid is not None:
            raise ValueError("a rigid body has no modes that second_order_modes could count; leave it out")
        if self.second_order_modes and self.inertia_coupling != "full":
            raise ValueError(
                "second_order_modes stiffen by inertia that deforms; inertia_coupling must be full"
            )
        return self

    @model_validator(mode="after")
    def _moved_from_a_place(self) -> Self:
        if self.motion is not None and self.place is None and self.like is None:
            raise ValueError("a motion starts from where the body is placed; give its place")
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
