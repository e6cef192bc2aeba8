"""Tables of a scene file about bodies: the base, and what deploys from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from components import ComponentError
from components.body import CouplingLevel
from components.numerics.motion_law import NOTHING, MotionLaw

from .construction.frame_tables import BeamTable, FrameTable
from .construction.import_tables import ImportTable
from .construction.panel_tables import PanelTable
from .construction.part import Flag, PartTable
from .damping import StructuralDamping
from .table import ORIGIN, Direction, Inertia, Name, Place, Table
from .units import (
    AngularVelocity,
    Coordinate,
    Frequency,
    Mass,
    MomentOfInertia,
    Position,
    Ratio,
    Size,
    Velocity,
)

Fidelity = Literal["rigid", "flexible", "large_deformation"]


class Inertial(Table):
    """Mass properties; the inertia is about the centre of mass."""

    mass: Mass
    """Mass."""
    center_of_mass: Position = ORIGIN
    """Centre of mass, axes of the body."""
    inertia: Inertia
    """About the centre of mass: three principal moments, or xx, yy, zz, xy, xz, yz of the tensor."""


class FreeBase(Inertial):
    """Mass properties of a spacecraft that moves under the loads, and how it moves at the start."""

    velocity: Velocity = ORIGIN
    """Velocity of its centre of mass at the start."""
    angular_velocity: AngularVelocity = ORIGIN
    """Angular velocity at the start."""

    @property
    def is_moving(self) -> bool:
        """Whether it moves at the start."""
        return any((*self.velocity, *self.angular_velocity))


class RigidBody(Inertial):
    """A rigid body written into the scene, with the points that connections use."""

    points: dict[Name, Position]
    """Positions by name, axes of the body, that connections use."""


class Motion(Table):
    """Prescribed motion of a base or a placed body: translation along an axis, rotation about another, world axes.

    Terms are those of `components.numerics.motion_law`; the scene starts where they do.
    """

    translation: tuple[Mapping[str, Any], ...] = NOTHING
    """Terms of the motion law (m) of the shift, counted from where the body was written."""
    rotation: tuple[Mapping[str, Any], ...] = NOTHING
    """Terms of the motion law (rad) of the turn, counted likewise."""
    translation_axis: Direction = (1.0, 0.0, 0.0)
    """Direction of the shift, world axes."""
    rotation_axis: Direction = (0.0, 0.0, 1.0)
    """Axis of the turn, world axes."""
    pivot: Position = ORIGIN
    """The body's own point that stays on the shifted line."""

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
    """Name of the spacecraft."""
    points: dict[Name, Position]
    """Positions by name, axes of the base, that connections use."""
    free: FreeBase | None = None
    """Mass properties of a spacecraft that moves under the loads."""
    motion: Motion | None = None
    """Prescribed motion of the spacecraft."""
    size: Size | None = None
    """Sides of the box that pictures show for the spacecraft, along its axes; by default of its mass properties."""

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        if self.free is not None and self.motion is not None:
            raise ValueError("a base that is free moves by the loads on it; give either free or motion")
        return self


class AttachedMass(Table):
    """A mass fixed to a point of a body of the catalogue, such as a bracket."""

    point: str
    """One of the body's points."""
    mass: Mass
    """Mass at it, such as of a bracket."""


class RigidTwinTable(PartTable):
    """Mass properties of the rigid body, where they differ from those of the finite elements."""

    hardware: Flag = True
    """Whether masses at the ends of the hinge arms are part of it."""
    mass: Mass | None = None
    """Mass."""
    center_of_mass: Coordinate | None = None
    """x of the centre of mass."""
    inertia: MomentOfInertia | None = None
    """About y through the centre of mass."""


class Body(Table):
    """[[body]]: panel, frame or both, beam, an entry of the catalogue, or a rigid body; options of its flexible model.

    panel, frame, beam, import, rigid_twin: with a catalogue entry, changes to its tables.
    """

    name: Name
    """Name of the body."""
    place: Place | None = None
    """Where the origin of a body that no hinge line carries starts, offset in world axes; loops close from there."""
    motion: Motion | None = None
    """Prescribed motion of a placed body, which is rigid."""
    velocity: Velocity | None = None
    """Velocity of the centre of mass of a placed body at the start, world axes; by default what joints require."""
    angular_velocity: AngularVelocity | None = None
    """Angular velocity of a placed body at the start, world axes; by default what joints require."""
    like: Name | None = None
    """Another body of the scene, whose keys apply unless set here."""
    catalogue: str | None = None
    """Entry of the catalogue, which the tables below change."""
    panel: PanelTable | None = None
    """A plate in the plane of x and y with hinge arms, from finite elements."""
    frame: FrameTable | None = None
    """Beams through joints; with a panel, arms and joints of one name are welded."""
    beam: BeamTable | None = None
    """A beam from its origin along x, straight or curved."""
    imported: ImportTable | None = Field(None, alias="import")
    """Finite elements of another program."""
    rigid_twin: RigidTwinTable | None = None
    """Mass properties of the rigid body, where they differ from those of the finite elements."""
    rigid: RigidBody | None = None
    """A rigid body with points."""
    fidelity: Fidelity | None = None
    """Model of the body unless chosen for the run; by default flexible if it can bend, else rigid."""
    fixed_interface_modes: Annotated[int, Field(ge=0)] = 10
    """Fixed-interface vibration modes, in addition to six shapes per attachment point."""
    second_order_modes: Annotated[int, Field(ge=0)] | None = None
    """Number of lowest modes with second-order shortening; by default those that spin or axial loads change."""
    inertia_coupling: CouplingLevel = "full"
    """How much of the change of inertia by deformation is kept."""
    damping_ratio: Annotated[Ratio, Field(le=1.0)] | None = None
    """Of all its modes; by default 1 %, 10 % above 100 Hz and critical above 1 kHz."""
    structural_damping: StructuralDamping | None = None
    """Damping in proportion to the frequency of a mode, in place of the scene's."""
    damping_scale: Ratio = 1.0
    """Factor on the damping of the body."""
    modes_off: tuple[Annotated[int, Field(ge=0)], ...] = ()
    """Numbers of modes, from 0, that are left out."""
    frequencies_off: tuple[tuple[Frequency, Frequency], ...] = ()
    """Bands of frequency, from and to, whose modes are left out."""
    attached_masses: tuple[AttachedMass, ...] = ()
    """Masses fixed to points."""

    @property
    def can_bend(self) -> bool:
        """Whether the body has a flexible model."""
        return self.rigid is None and self.motion is None

    @property
    def default_fidelity(self) -> Fidelity:
        """Its fidelity unless the run says otherwise."""
        return (self.fidelity or "flexible") if self.can_bend else "rigid"

    @property
    def parts(self) -> tuple[Table, ...]:
        """Panel, frame, beam and import, those that are given."""
        parts = (self.panel, self.frame, self.beam, self.imported)
        return tuple(part for part in parts if part is not None)

    @property
    def masses(self) -> tuple[tuple[str, float], ...]:
        """Attached masses (kg) by point."""
        return tuple((attached.point, attached.mass) for attached in self.attached_masses)

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        built = self.catalogue is not None or bool(self.parts)
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
    def _stands_alone(self) -> Self:
        for kind, part in (("a beam", self.beam), ("an imported body", self.imported)):
            if part is not None and len(self.parts) > 1:
                raise ValueError(f"{kind} stands alone; join it to other bodies by fixed connections")
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
    def _bands_from_below(self) -> Self:
        for low, high in self.frequencies_off:
            if low >= high:
                raise ValueError(
                    f"the band of frequencies_off from {low:g} to {high:g} Hz holds none; give the lower first"
                )
        return self

    @model_validator(mode="after")
    def _moved_from_a_place(self) -> Self:
        if self.motion is not None and self.place is None and self.like is None:
            raise ValueError("a motion starts from where the body is placed; give its place")
        return self

    @model_validator(mode="after")
    def _starts_one_way(self) -> Self:
        if (self.velocity, self.angular_velocity) == (None, None) or self.like is not None:
            return self
        if self.motion is not None:
            raise ValueError(
                "its motion says how it moves at the start; leave out velocity and angular_velocity"
            )
        if self.place is None:
            raise ValueError(
                "hinge lines carry this body, so its velocity follows from theirs; give their start_rate instead"
            )
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
