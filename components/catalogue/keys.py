"""Every key of the tables that say how a body is built, with unit, default and meaning, as a JSON schema.

Keys, units and defaults are what the reader asks for: it reads a table that has everything and writes down every
question. Meanings stand here, by key or by the end of a key that several tables share.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from math import isfinite, nan

from .reader import read_parts
from .tables import Sign, Table, Tree

_CHOICES, _TURNS = 4, 32
"""Keys of a choice at most, and turns after which choices were made in all ways, those within others too."""

MEANINGS = {
    "panel": "A plate in the plane of x and y with hinge arms, from finite elements",
    "panel.length": "Length of the plate, along x",
    "panel.width": "Width of the plate, along y",
    "panel.areal_mass": "Mass of the plate by area",
    "panel.stiffness": "Stiffness of the plate as it was measured or computed",
    "panel.stiffness.bending": "D11, D22, D12, D66",
    "panel.stiffness.membrane": "A11, A22, A12, A66",
    "panel.sandwich": "Two equal isotropic skins on a core",
    "panel.sandwich.skin": "Thickness of one skin",
    "panel.sandwich.core": "Thickness of the core",
    "panel.sandwich.shear_modulus": "Of the skins; by default that of an isotropic material",
    "panel.layers": "Layers of a laminate from the lower to the upper side",
    "layers.thickness": "Thickness of the layer",
    "layers.youngs_modulus": "Along the fibres",
    "layers.transverse_modulus": "Across the fibres; by default that along them",
    "layers.poisson_ratio": "Of a load along the fibres",
    "layers.shear_modulus": "In the plane of the layer",
    "layers.angle": "Of the fibres from x, positive towards y",
    "panel.face_sheets": "Face sheets or solid section that carry the stress, for `analyse stress`",
    "face_sheets.thickness": "Of a solid plate",
    "face_sheets.skin": "Thickness of one skin",
    "face_sheets.distance": "Of the middles of both skins",
    "panel.prestress": "Tension of the plate in all directions: makes it stiff against bending, pulls at no joint",
    "panel.geometry": "`von_karman` has the tension that bending makes",
    "panel.arm": "Keys common to all hinge arms",
    "panel.arms": "Hinge arms in addition to those of the hinge lines; keys that they omit are those of `arm`",
    "arms.name": "Name of the attachment point at the end of the arm",
    "arms.edge": "Edge of the plate from which the arm leads outward",
    "y": "Place along the hinge line",
    "z": "Offset of the end from the mid-plane",
    "arm.length": "From the edge of the plate to the hinge line",
    "arms.length": "From the edge of the plate to the hinge line",
    "arm.stiffness": "Stiffness of an arm that bends",
    "arms.stiffness": "Stiffness of an arm that bends",
    "arm.rigid": "Whether the arm is rigid; by default where it has no stiffness",
    "arms.rigid": "Whether the arm is rigid; by default as `arm` is",
    "point_mass": "Mass at the attachment point, such as of a hinge",
    "patch": "Side of the square of the plate that is rigid with it",
    "axial": "Stiffness against extension, EA",
    "bending_y": "Stiffness against bending about y, EI",
    "bending_z": "Stiffness against bending about z, EI",
    "torsion": "Stiffness against torsion, GJ",
    "panel.hinge_lines": "Names of the hinge lines at both edges, with points NAME_left at +y and NAME_right at -y",
    "hinge_lines.inboard": "Of the edge on the side of the spacecraft",
    "hinge_lines.outboard": "Of the other edge",
    "panel.hinge_line_offsets": "Of the hinge lines from the mid-plane, along z; by default `z` of `arm`",
    "hinge_line_offsets.inboard": "Of the inboard hinge line",
    "hinge_line_offsets.outboard": "Of the outboard hinge line",
    "panel.start": "x of the inboard edge of the plate; by default the length of the longest inboard arm",
    "panel.nodes": "Points (x, y) to load and look at, without modes, by name; `center` is there always",
    "panel.inserts": "Rigid inserts inside the plate, attachment points",
    "inserts.name": "Name of the attachment point",
    "inserts.x": "Place along x",
    "inserts.rectangles": "Parts of an insert that is no square",
    "rectangles.x": "From and to along x",
    "rectangles.y": "From and to along y",
    "panel.element_size": "Largest side of a finite element",
    "frame": "Beams through joints; with a panel, arms and joints of one name are welded",
    "frame.joints": "Positions by name",
    "frame.members": "Beams",
    "members.name": "Name of the beam",
    "members.joints": "Names of the joints that it leads through",
    "members.elements": "Finite elements from one joint to the next",
    "members.mass": "Of the whole beam; what is not its section's is on its axis",
    "tube": "Round tube",
    "diameter": "Outer diameter",
    "wall": "Thickness of the wall",
    "section": "Section by stiffnesses and inertia",
    "line_mass": "Mass by length",
    "gyration_radius": "Radius of gyration about the axis",
    "youngs_modulus": "Young's modulus",
    "shear_modulus": "Shear modulus",
    "poisson_ratio": "Poisson's ratio",
    "density": "Density",
    "frame.spread_mass": "Totals of the frame that mass without stiffness makes up for",
    "spread_mass.members": "Beams along which it is spread",
    "spread_mass.mass": "Of the whole frame",
    "spread_mass.center_of_mass": "x of the whole frame",
    "spread_mass.inertia": "About y through the centre of mass",
    "frame.attachment_points": "Joints that connections use",
    "frame.nodes": "Joints to load and look at, without modes",
    "beam": "A beam from its origin along x, straight or curved",
    "beam.length": "Length along the axis",
    "beam.radius": "Radius of an arc towards z; without it the beam is straight",
    "beam.axis": "Points of a smooth curve, in place of a length",
    "beam.elements": "Elements of the beam of large deformation, whose errors fall with their square",
    "beam.attachment_points": "Distances along the axis by name, that connections use",
    "beam.nodes": "Distances along the axis by name, to load and look at",
    "beam.section_z": "Direction of the section's z axis; by default that of z",
    "rectangle": "Solid rectangle",
    "rectangle.width": "Along the section's y",
    "rectangle.height": "Along the section's z",
    "circle": "Solid circle",
    "shear_factor": "Timoshenko's shear factor; by default that of the shape",
    "shear_y": "Stiffness against shear along y",
    "shear_z": "Stiffness against shear along z",
    "inertia_y": "Rotary inertia about y by length",
    "inertia_z": "Rotary inertia about z by length",
    "import": "Finite elements of another program",
    "import.file": "External superelement (.asm), .op4 or .npz, from the scene's folder",
    "import.stiffness": "File of the stiffness matrix",
    "import.mass": "File of the mass matrix",
    "import.coordinates": "File of the nodes: number, x, y, z",
    "import.dofs": "File of node and component of every row, 0 for an amplitude",
    "import.sample_masses": "File of the masses by which inertia changes with the deformation",
    "import.sample_positions": "File of their positions",
    "import.sample_displacement": "File of their displacement by every row",
    "import.recovered_nodes": "File of the nodes whose motion is recovered",
    "import.recovered_motion": "File of their motion by every row",
    "import.stress": "File of the stresses by every row",
    "import.force": "File of the forces by every row",
    "import.moment": "File of the moments by every row",
    "import.force_per_length": "File of the forces per length by every row",
    "import.attachment_points": "Numbers of nodes of six components by name, that connections use",
    "import.nodes": "Numbers of nodes by name, to load and look at",
    "import.rigid_elements": "Nodes that move as one rigid piece (RBE2), attachment points",
    "import.means": "Points that follow the mean of nodes (RBE3), attachment points",
    "rigid_elements.name": "Name of the point",
    "means.name": "Name of the point",
    "rigid_elements.nodes": "Numbers of the nodes",
    "means.nodes": "Numbers of the nodes",
    "position": "Of the point; by default the mean of its nodes",
    "import.units": "Units of the model in SI units",
    "units.length": "Of a length",
    "units.mass": "Of a mass",
    "import.stated": "Mass properties stated with the model, for comparison",
    "stated.mass": "Mass",
    "stated.center_of_mass": "Centre of mass",
    "stated.inertia": "Moments about the axes of the model through the centre of mass (the diagonal)",
    "rigid_twin": "Mass properties of the rigid body, where they differ from those of the finite elements",
    "rigid_twin.hardware": "Whether masses at the ends of the hinge arms are part of it",
    "rigid_twin.mass": "Mass",
    "rigid_twin.center_of_mass": "x of the centre of mass",
    "rigid_twin.inertia": "About y through the centre of mass",
}


def meaning(path: str) -> str:
    """What a key is, by its longest ending that is told; empty where none is."""
    return MEANINGS.get(_told(path), "")


def _told(path: str) -> str:
    parts = path.split(".")
    return next((end for i in range(len(parts)) if (end := ".".join(parts[i:])) in MEANINGS), "")


def unused_meanings() -> set[str]:
    """Meanings of keys that the reader does not ask for."""
    return set(MEANINGS) - {_told(path) for path in _asked()}


def tables_schema() -> Tree:
    """JSON schemas of the tables of a body by name.

    Beside the words of JSON Schema: `unit` and `sign` of quantities, `needed` keys of a table that stands alone, and
    `instead` keys that take the place of one.
    """
    root: Tree = {"type": "object", "properties": {}}
    for path, one in _asked().items():
        *parents, name = path.split(".")
        table = root
        for parent in parents:
            table = table["properties"][parent]
            table = table.get("items", table)
        table["properties"][name] = one | {"description": f"{meaning(path)}."}
        if one.pop("needed", False):
            table.setdefault("needed", []).append(name)
        table["properties"][name].pop("needed", None)
    found: Tree = root["properties"]
    return found


def _asked() -> dict[str, Tree]:
    """Schema of every key that the reader asks for, by its path, tables before what is in them."""
    found: dict[str, Tree] = {}
    log = _Log()
    for turn in range(_TURNS):
        log.turn = turn
        read_parts(_Asking(log, ""))
    for path in tuple(log.optional):
        log.absent = path
        read_parts(_Asking(log, ""))
    for path, one in log.found.items():
        found[path] = {key: value for key, value in one.items() if value is not _DERIVED}
        if path in log.optional or path in log.looked_for:
            found[path].pop("needed", None)
        if path in log.instead:
            found[path]["instead"] = list(log.instead[path])
    return found


_DERIVED = object()
"""Stands for a default that follows from other keys."""


@dataclass
class _Log:
    """Questions that were asked, with the answers of the present reading."""

    turn: int = 0
    absent: str = ""
    found: dict[str, Tree] = field(default_factory=dict)
    optional: dict[str, None] = field(default_factory=dict)
    looked_for: set[str] = field(default_factory=set)
    instead: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def note(self, path: str, schema: Tree) -> None:
        """Write a key down; a default that is not always the same follows from others."""
        before = self.found.setdefault(path, dict(schema))
        if "default" in schema and before.get("default", schema["default"]) != schema["default"]:
            before["default"] = _DERIVED


class _Asking(Table):
    """A table that has whatever it is asked for, but for one optional table, and values that are no numbers."""

    def __init__(self, log: _Log, key: str) -> None:
        super().__init__({}, key, lambda value, unit, sign: nan, [])
        self._log = log

    def __contains__(self, key: str) -> bool:
        self._log.looked_for.add(self._key + key)
        return True

    def note(self, key: str, sentence: str) -> None:
        """Nothing is wrong with it."""

    def close(self) -> None:
        """It has no keys of its own."""

    def _ask(self, key: str, schema: Tree, default: object = None, *, needed: bool = False) -> None:
        if default is not None and default == default and default not in ("", float("inf")):
            schema = schema | {"default": default}
        self._log.note(self._key + key, schema | ({"needed": True} if needed else {}))

    def number(self, key: str, unit: str, sign: Sign = "positive", default: float | None = None) -> float:
        """A value."""
        told = default if default is not None and isfinite(default) else None
        self._ask(key, _value(unit, sign), told, needed=default is None)
        return nan

    def numbers(self, key: str, unit: str, count: int, sign: Sign = "any") -> tuple[float, ...]:
        """As many values."""
        self._ask(key, _list(_value(unit, sign), count), needed=True)
        return (nan,) * count

    def count(self, key: str, default: int) -> int:
        """A whole number."""
        self._ask(key, {"type": "integer", "minimum": 1}, default)
        return default

    def flag(self, key: str, default: bool) -> bool:
        """True or false."""
        self._ask(key, {"type": "boolean"}, default)
        return default

    def text(self, key: str, choices: Collection[str] = (), default: str | None = None) -> str:
        """A name."""
        self._ask(key, {"type": "string"} | ({"enum": list(choices)} if choices else {}), default,
                  needed=default is None)  # fmt: skip
        return default or ""

    def texts(self, key: str, fewest: int, known: Collection[str]) -> tuple[str, ...]:
        """Names."""
        self._ask(key, {"type": "array", "items": {"type": "string"}}, needed=fewest > 0)
        return ()

    def table(self, key: str, required: bool = True) -> Table | None:
        """A table within, unless it is the one that is left out."""
        path = self._key + key
        if not required:
            self._log.optional[path] = None
        self._ask(key, {"type": "object", "properties": {}, "additionalProperties": False}, needed=required)
        return None if path == self._log.absent else _Asking(self._log, f"{path}.")

    def entries(self, key: str) -> Iterator[Table]:
        """One entry."""
        entry = {"type": "object", "properties": {}, "additionalProperties": False}
        self._ask(key, {"type": "array", "items": entry})
        yield _Asking(self._log, f"{self._key}{key}.")

    def places(self, key: str, count: int) -> dict[str, tuple[float, ...]]:
        """Positions by name."""
        self._ask(key, _named(_list(_value("m", "any"), count)))
        return {}

    def distances(self, key: str) -> dict[str, float]:
        """Lengths by name."""
        self._ask(key, _named(_value("m", "zero or positive")))
        return {}

    def positions(self, key: str) -> list[tuple[float, ...]]:
        """Positions."""
        self._ask(key, {"type": "array", "items": _list(_value("m", "any"), 3)}, needed=True)
        return []

    def line(self, key: str) -> str:
        """A text."""
        self._ask(key, {"type": "string"})
        return ""

    def whole_numbers(self, key: str) -> tuple[int, ...]:
        """Whole numbers."""
        self._ask(key, {"type": "array", "items": {"type": "integer", "minimum": 1}}, needed=True)
        return ()

    def numbers_of_names(self, key: str) -> dict[str, int]:
        """Whole numbers by name."""
        self._ask(key, _named({"type": "integer", "minimum": 1}))
        return {}

    def one_of(self, *keys: str) -> str:
        """One after the other."""
        for key in keys:
            self._log.looked_for.add(self._key + key)
            self._log.instead[self._key + key] = tuple(other for other in keys if other != key)
        depth = self._key.count(".") - 1
        made = self._log.turn // int(_CHOICES**depth)
        return keys[made % len(keys)]


def _value(unit: str, sign: Sign) -> Tree:
    """As scene files write it."""
    return {"type": ["number", "string"], "unit": unit, "sign": sign}


def _list(items: Tree, count: int) -> Tree:
    return {"type": "array", "items": items, "minItems": count, "maxItems": count}


def _named(values: Tree) -> Tree:
    return {"type": "object", "additionalProperties": values}
