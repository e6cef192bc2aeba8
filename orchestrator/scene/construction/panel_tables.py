"""Tables of a plate with hinge arms, [body.panel]."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from ..table import Name, identifier
from ..units import (
    Angle,
    AnyRatio,
    ArealMass,
    Coordinate,
    Distance,
    Interval,
    Length,
    MembraneStiffnesses,
    Modulus,
    PlanePosition,
    PlateStiffnesses,
    PlateTension,
    PointMass,
    PoissonRatio,
)
from .materials import StiffnessTable
from .part import Flag, PartTable, Problem, at_least

Edge = Literal["inboard", "outboard"]


def _line(name: str) -> str:
    return identifier(name) if name else name


LineName = Annotated[str, AfterValidator(_line)]
"""Of a hinge line, empty for none."""


class PlateStiffnessTable(PartTable):
    """Stiffness of the plate as it was measured or computed."""

    bending: PlateStiffnesses
    """D11, D22, D12, D66."""
    membrane: MembraneStiffnesses
    """A11, A22, A12, A66."""


class SandwichTable(PartTable):
    """Two equal isotropic skins on a core."""

    skin: Length
    """Thickness of one skin."""
    core: Length
    """Thickness of the core."""
    youngs_modulus: Modulus
    """Young's modulus of the skins."""
    poisson_ratio: PoissonRatio
    """Poisson's ratio of the skins."""
    shear_modulus: Modulus | None = None
    """Of the skins; by default that of an isotropic material."""


class LayerTable(PartTable):
    """Layer of a laminate."""

    thickness: Length
    """Thickness of the layer."""
    youngs_modulus: Modulus
    """Along the fibres."""
    transverse_modulus: Modulus | None = None
    """Across the fibres; by default that along them."""
    poisson_ratio: AnyRatio
    """Of a load along the fibres."""
    shear_modulus: Modulus
    """In the plane of the layer."""
    angle: Angle = 0.0
    """Of the fibres from x, positive towards y."""


class FaceSheetsTable(PartTable):
    """Face sheets or solid section that carry the stress, for `analyse stress`."""

    choices = (("thickness", "skin"),)

    thickness: Length | None = None
    """Of a solid plate."""
    skin: Length | None = None
    """Thickness of one skin."""
    distance: Length | None = None
    """Of the middles of both skins."""

    def contradictions(self) -> Iterator[Problem]:
        """Skins at no distance, a solid plate with one."""
        if self.skin is not None and self.distance is None:
            yield ("distance",), "is missing"
        if self.thickness is not None and self.distance is not None:
            yield ("distance",), "belongs to skins; a solid plate has none"


class CommonArmTable(PartTable):
    """Keys common to all hinge arms."""

    y: Coordinate | None = None
    """Place along the hinge line."""
    length: Distance = 0.0
    """From the edge of the plate to the hinge line."""
    stiffness: StiffnessTable | None = None
    """Stiffness of an arm that bends."""
    rigid: Flag | None = None
    """Whether the arm is rigid; by default where it has no stiffness."""
    point_mass: PointMass = 0.0
    """Mass at the attachment point, such as of a hinge."""
    patch: Length = 0.03
    """Side of the square of the plate that is rigid with it."""
    z: Coordinate = 0.0
    """Offset of the end from the mid-plane."""

    def contradictions(self) -> Iterator[Problem]:
        """An arm that bends and has no stiffness."""
        if self.rigid is False and self.stiffness is None:
            yield ("rigid",), "is false, so the arm needs a table stiffness"


class ArmTable(PartTable):
    """Hinge arm; keys that it omits are those of `arm`."""

    name: Name
    """Name of the attachment point at the end of the arm."""
    edge: Edge = "inboard"
    """Edge of the plate from which the arm leads outward."""
    y: Coordinate | None = None
    """Place along the hinge line."""
    length: Distance | None = None
    """From the edge of the plate to the hinge line."""
    stiffness: StiffnessTable | None = None
    """Stiffness of an arm that bends."""
    rigid: Flag | None = None
    """Whether the arm is rigid; by default as `arm` is."""
    point_mass: PointMass | None = None
    """Mass at the attachment point, such as of a hinge."""
    patch: Length | None = None
    """Side of the square of the plate that is rigid with it."""
    z: Coordinate | None = None
    """Offset of the end from the mid-plane."""


class HingeLinesTable(PartTable):
    """Names of the hinge lines at both edges, with points NAME_left at +y and NAME_right at -y."""

    inboard: LineName = ""
    """Of the edge on the side of the spacecraft."""
    outboard: LineName = ""
    """Of the other edge."""


class HingeLineOffsetsTable(PartTable):
    """Offsets of the hinge lines from the mid-plane, along z; by default `z` of `arm`."""

    inboard: Coordinate | None = None
    """Of the inboard hinge line."""
    outboard: Coordinate | None = None
    """Of the outboard hinge line."""


class InsertRectangleTable(PartTable):
    """Part of an insert that is no square."""

    x: Interval
    """From and to along x."""
    y: Interval
    """From and to along y."""

    def contradictions(self) -> Iterator[Problem]:
        """Ends in the wrong order."""
        for axis, (low, high) in (("x", self.x), ("y", self.y)):
            if low >= high:
                yield (axis,), f"is {[low, high]}; give the lower end first"


class InsertTable(PartTable):
    """Rigid insert inside the plate, an attachment point."""

    name: Name
    """Name of the attachment point."""
    x: Coordinate
    """Place along x."""
    y: Coordinate
    """Place along the hinge line."""
    point_mass: PointMass = 0.0
    """Mass at the attachment point, such as of a hinge."""
    patch: Length = 0.03
    """Side of the square of the plate that is rigid with it."""
    rectangles: tuple[InsertRectangleTable, ...] = ()
    """Parts of an insert that is no square."""

    def contradictions(self) -> Iterator[Problem]:
        """A square and rectangles."""
        if self.rectangles and "patch" in self.model_fields_set:
            yield ("patch",), "is the side of a square; leave it or rectangles out"


class PanelTable(PartTable):
    """A plate in the plane of x and y with hinge arms, from finite elements."""

    choices = (("stiffness", "sandwich", "layers"),)

    length: Length
    """Length of the plate, along x."""
    width: Length
    """Width of the plate, along y."""
    areal_mass: ArealMass
    """Mass of the plate by area."""
    stiffness: PlateStiffnessTable | None = None
    """Stiffness of the plate as it was measured or computed."""
    sandwich: SandwichTable | None = None
    """Two equal isotropic skins on a core."""
    layers: Annotated[tuple[LayerTable, ...], at_least(1)] | None = None
    """Layers of a laminate from the lower to the upper side."""
    prestress: PlateTension = 0.0
    """Tension of the plate in all directions: makes it stiff against bending, pulls at no joint."""
    geometry: Literal["linear", "von_karman"] = "linear"
    """`von_karman` has the tension that bending makes."""
    face_sheets: FaceSheetsTable | None = None
    """Face sheets or solid section that carry the stress, for `analyse stress`."""
    arm: CommonArmTable | None = None
    """Keys common to all hinge arms."""
    arms: tuple[ArmTable, ...] = ()
    """Hinge arms in addition to those of the hinge lines; keys that they omit are those of `arm`."""
    hinge_lines: HingeLinesTable | None = None
    """Names of the hinge lines at both edges, with points NAME_left at +y and NAME_right at -y."""
    hinge_line_offsets: HingeLineOffsetsTable | None = None
    """Of the hinge lines from the mid-plane, along z; by default `z` of `arm`."""
    start: Coordinate | None = None
    """x of the inboard edge of the plate; by default the length of the longest inboard arm."""
    nodes: dict[str, PlanePosition] = Field(default_factory=dict)
    """Points (x, y) to load and look at, without modes, by name; `center` is there always."""
    inserts: tuple[InsertTable, ...] = ()
    """Rigid inserts inside the plate, attachment points."""
    element_size: Length = 0.05
    """Largest side of a finite element."""

    def contradictions(self) -> Iterator[Problem]:
        """What the plate and its arms say against each other."""
        side = min(self.length, self.width)
        if "element_size" in self.model_fields_set and self.element_size > 0.5 * side:
            yield (
                ("element_size",),
                f"is {self.element_size:g} m; it must be at most {0.5 * side:g} m, so that two elements fit each way",
            )
        yield from self._thick(side)
        yield from self._unplaced_arms()

    def _thick(self, side: float) -> Iterator[Problem]:
        """Parts of the plate that are thicker than its shorter side (m)."""
        places: dict[tuple[str | int, ...], float] = {
            ("layers", k, "thickness"): layer.thickness for k, layer in enumerate(self.layers or ())
        }
        if self.sandwich is not None:
            places |= {("sandwich", "skin"): self.sandwich.skin, ("sandwich", "core"): self.sandwich.core}
        for place, thickness in places.items():
            if thickness >= side:
                meant = f"; did you mean {thickness:g} mm" if 1e-3 * thickness < side else ""
                yield place, f"{thickness:g} m is thicker than the panel is wide ({side:g} m){meant}"

    def _unplaced_arms(self) -> Iterator[Problem]:
        """Arms without a place along the hinge line, and those that bend without a stiffness."""
        common = self.arm or CommonArmTable()
        if self.hinge_lines is not None and common.y is None:
            yield ("arm", "y"), "is missing; hinge_lines have their arms at + and - y"
        elif self.hinge_lines is not None and common.y is not None and common.y <= 0.0:
            yield (
                ("arm", "y"),
                f"is {common.y:g}; hinge_lines have left arms at + y and right ones at - y",
            )
        for k, arm in enumerate(self.arms):
            if arm.y is None and common.y is None:
                yield ("arms", k, "y"), "is missing"
            if arm.rigid is False and arm.stiffness is None and (common.rigid or common.stiffness is None):
                yield ("arms", k, "rigid"), "is false, so the arm needs a table stiffness"
