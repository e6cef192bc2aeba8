"""Tables of beams: frames of straight beams through joints, [body.frame], and beams that stand alone, [body.beam]."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from typing import Annotated

from pydantic import Field

from ..table import Direction, Name
from ..units import Coordinate, Distance, Length, Mass, MomentOfInertia, Position
from .materials import (
    BeamSectionTable,
    CircleTable,
    FrameSectionTable,
    RectangleTable,
    ShapedTubeTable,
    TubeTable,
)
from .part import Count, Names, PartTable, Problem, at_least


class MemberTable(PartTable):
    """A beam of a frame."""

    name: Name
    """Name of the beam."""
    joints: Annotated[Names, at_least(2)]
    """Names of the joints that it leads through."""
    tube: TubeTable | None = None
    """Round tube."""
    section: FrameSectionTable | None = None
    """Section by stiffnesses and inertia."""
    elements: Count = 8
    """Finite elements from one joint to the next."""
    mass: Mass | None = None
    """Of the whole beam; what is not its section's is on its axis."""


class SpreadMassTable(PartTable):
    """Totals of the frame that mass without stiffness makes up for."""

    members: Annotated[Names, at_least(1)]
    """Beams along which it is spread."""
    mass: Mass
    """Of the whole frame."""
    center_of_mass: Coordinate
    """x of the whole frame."""
    inertia: MomentOfInertia
    """About y through the centre of mass."""


class FrameTable(PartTable):
    """Beams through joints; with a panel, arms and joints of one name are welded."""

    joints: dict[str, Position]
    """Positions by name."""
    tube: TubeTable | None = None
    """Round tube."""
    section: FrameSectionTable | None = None
    """Section by stiffnesses and inertia."""
    members: Annotated[tuple[MemberTable, ...], at_least(1)]
    """Beams."""
    spread_mass: SpreadMassTable | None = None
    """Totals of the frame that mass without stiffness makes up for."""
    attachment_points: Names = ()
    """Joints that connections use."""
    nodes: Names = ()
    """Joints to load and look at, without modes."""

    def contradictions(self) -> Iterator[Problem]:
        """Names of joints and members that are none, and members without a section."""
        for k, member in enumerate(self.members):
            if all(one is None for one in (member.tube, member.section, self.tube, self.section)):
                yield (
                    ("members", k, "tube"),
                    "is missing; give tube or section, of the member or of the whole frame",
                )
            yield from _unknown(("members", k, "joints"), member.joints, self.joints)
        beams = Counter(member.name for member in self.members)
        yield from (
            (("members", name), "stands twice; rename one") for name in sorted(beams) if beams[name] > 1
        )
        met = dict.fromkeys(name for member in self.members for name in member.joints)
        for name in sorted(self.joints.keys() - met):
            yield ("joints", name), "is where no member goes; leave it out"
        if self.spread_mass is not None:
            yield from _unknown(("spread_mass", "members"), self.spread_mass.members, beams)
        yield from _unknown(("attachment_points",), self.attachment_points, met)
        yield from _unknown(("nodes",), self.nodes, met)


def _unknown(place: tuple[str | int, ...], names: Names, known: Collection[str]) -> Iterator[Problem]:
    for name in names:
        if name not in known:
            yield place, f"there is no {name!r}; those are {', '.join(known) or 'none'}"


class BeamTable(PartTable):
    """A beam from its origin along x, straight or curved."""

    choices = (("length", "axis"), ("rectangle", "tube", "circle", "section"))

    length: Length | None = None
    """Length along the axis."""
    radius: Length | None = None
    """Radius of an arc towards z; without it the beam is straight."""
    axis: tuple[Position, ...] | None = None
    """Points of a smooth curve, in place of a length."""
    rectangle: RectangleTable | None = None
    """Solid rectangle."""
    tube: ShapedTubeTable | None = None
    """Round tube."""
    circle: CircleTable | None = None
    """Solid circle."""
    section: BeamSectionTable | None = None
    """Section by stiffnesses and inertia."""
    elements: Count = 20
    """Elements of the beam of large deformation, whose errors fall with their square."""
    attachment_points: dict[str, Distance] = Field(default_factory=dict)
    """Distances along the axis by name, that connections use."""
    nodes: dict[str, Distance] = Field(default_factory=dict)
    """Distances along the axis by name, to load and look at."""
    section_z: Direction = (0.0, 0.0, 1.0)
    """Direction of the section's z axis; by default that of z."""

    def contradictions(self) -> Iterator[Problem]:
        """A radius of a curve through points, and a beam that nothing can be connected to."""
        if self.radius is not None and self.axis is not None:
            yield ("radius",), "belongs to a length; an axis of points has its own curvature"
        if not self.attachment_points:
            yield ("attachment_points",), "is missing; give names with distances from the beam's start"
