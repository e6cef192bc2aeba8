"""Tables of materials and sections of beams, of frames and of beams that stand alone."""

from __future__ import annotations

from collections.abc import Iterator

from ..units import (
    AxialStiffness,
    BendingStiffness,
    Density,
    Length,
    LineInertia,
    LineMass,
    Modulus,
    PoissonRatio,
    PositiveRatio,
)
from .part import PartTable, Problem


class MaterialTable(PartTable):
    """An isotropic material."""

    choices = (("shear_modulus", "poisson_ratio"),)

    youngs_modulus: Modulus
    """Young's modulus."""
    shear_modulus: Modulus | None = None
    """Shear modulus."""
    poisson_ratio: PoissonRatio | None = None
    """Poisson's ratio."""
    density: Density
    """Density."""


class TubeTable(MaterialTable):
    """Round tube."""

    diameter: Length
    """Outer diameter."""
    wall: Length
    """Thickness of the wall."""

    def contradictions(self) -> Iterator[Problem]:
        """A wall that fills the tube."""
        if self.wall > 0.5 * self.diameter:
            yield (
                ("wall",),
                f"is {self.wall:g} m; a tube of {self.diameter:g} m has a wall of half of that at most",
            )


class StiffnessTable(PartTable):
    """Stiffnesses of a beam without mass."""

    axial: AxialStiffness
    """Stiffness against extension, EA."""
    bending_y: BendingStiffness
    """Stiffness against bending about y, EI."""
    bending_z: BendingStiffness
    """Stiffness against bending about z, EI."""
    torsion: BendingStiffness
    """Stiffness against torsion, GJ."""


class FrameSectionTable(StiffnessTable):
    """Section of the beams of a frame by stiffnesses and inertia."""

    line_mass: LineMass
    """Mass by length."""
    gyration_radius: Length
    """Radius of gyration about the axis."""


class ShapeTable(MaterialTable):
    """A section of one material, with shear."""

    shear_factor: PositiveRatio | None = None
    """Timoshenko's shear factor; by default that of the shape."""


class ShapedTubeTable(TubeTable, ShapeTable):
    """Round tube of a beam with shear."""


class RectangleTable(ShapeTable):
    """Solid rectangle."""

    width: Length
    """Along the section's y."""
    height: Length
    """Along the section's z."""


class CircleTable(ShapeTable):
    """Solid circle."""

    diameter: Length
    """Outer diameter."""


class BeamSectionTable(StiffnessTable):
    """Section of a beam with shear by stiffnesses and inertia."""

    line_mass: LineMass
    """Mass by length."""
    shear_y: AxialStiffness
    """Stiffness against shear along y."""
    shear_z: AxialStiffness
    """Stiffness against shear along z."""
    inertia_y: LineInertia
    """Rotary inertia about y by length."""
    inertia_z: LineInertia
    """Rotary inertia about z by length."""
