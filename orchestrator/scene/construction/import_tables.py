"""Tables of finite elements of another program, [body.import]."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field

from components.imported.files import NAMES

from ..table import Name
from ..units import Length, Mass, MomentsOfInertia, Position
from .part import Count, NodeNumbers, PartTable, Problem


class JoinedPointTable(PartTable):
    """A point that moves with nodes."""

    name: Name
    """Name of the point."""
    nodes: NodeNumbers
    """Numbers of the nodes."""
    position: Position | None = None
    """Of the point; by default the mean of its nodes."""


class ImportUnitsTable(PartTable):
    """Units of the model in SI units."""

    length: Length = 1.0
    """Of a length."""
    mass: Mass = 1.0
    """Of a mass."""


class StatedTable(PartTable):
    """Mass properties stated with the model, for comparison."""

    mass: Mass | None = None
    """Mass."""
    center_of_mass: Position | None = None
    """Centre of mass."""
    inertia: MomentsOfInertia | None = None
    """Moments about the axes of the model through the centre of mass (the diagonal)."""


class ImportTable(PartTable):
    """Finite elements of another program."""

    file: str = ""
    """External superelement (.asm), .op4 or .npz, from the scene's folder."""
    stiffness: str = ""
    """File of the stiffness matrix."""
    mass: str = ""
    """File of the mass matrix."""
    coordinates: str = ""
    """File of the nodes: number, x, y, z."""
    dofs: str = ""
    """File of node and component of every row, 0 for an amplitude."""
    sample_masses: str = ""
    """File of the masses by which inertia changes with the deformation."""
    sample_positions: str = ""
    """File of their positions."""
    sample_displacement: str = ""
    """File of their displacement by every row."""
    recovered_nodes: str = ""
    """File of the nodes whose motion is recovered."""
    recovered_motion: str = ""
    """File of their motion by every row."""
    stress: str = ""
    """File of the stresses by every row."""
    force: str = ""
    """File of the forces by every row."""
    moment: str = ""
    """File of the moments by every row."""
    force_per_length: str = ""
    """File of the forces per length by every row."""
    attachment_points: dict[Name, Count] = Field(default_factory=dict)
    """Numbers of nodes of six components by name, that connections use."""
    nodes: dict[Name, Count] = Field(default_factory=dict)
    """Numbers of nodes by name, to load and look at."""
    rigid_elements: tuple[JoinedPointTable, ...] = ()
    """Nodes that move as one rigid piece (RBE2), attachment points."""
    means: tuple[JoinedPointTable, ...] = ()
    """Points that follow the mean of nodes (RBE3), attachment points."""
    units: ImportUnitsTable = ImportUnitsTable()
    """Units of the model in SI units."""
    stated: StatedTable | None = None
    """Mass properties stated with the model, for comparison."""

    @property
    def files(self) -> dict[str, str]:
        """Paths of the files by what they hold."""
        return {name: path for name in NAMES if (path := getattr(self, name))}

    def contradictions(self) -> Iterator[Problem]:
        """No file, no point that can be connected to."""
        if not self.file and not self.stiffness:
            yield ("file",), "is missing; give a file, or stiffness, mass and coordinates, each in its own"
        if not self.attachment_points and not self.rigid_elements and not self.means:
            yield ("attachment_points",), "is missing; give names with numbers of nodes"
