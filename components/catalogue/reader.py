"""A table -> the definition of a body: plate, hinge arms, inserts, beams, attached masses, the rigid twin.

The keys are those of the catalogue's data sheets and of `[body.panel]`, `[body.frame]`, `[body.beam]`,
`[body.import]` in scene files.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate
from math import inf, isclose, isnan, nan, sqrt
from typing import Any, Literal, NamedTuple, TypeAlias

from ..flexible.beam_frame import BeamSection, tube_section
from ..flexible.laminate import Layer, laminate_stiffness
from ..flexible.plate import Geometry, HingeArm, Panel, Plate, sandwich_stiffness
from ..flexible.stress import FaceSheets
from ..imported.body import ImportedBody
from .beam import BeamBody
from .beam_reader import read_beam, read_material
from .definition import BodyDefinition, PointMasses, RigidTwin
from .frame import Frame, Path, SpreadMass
from .import_reader import read_import
from .tables import Convert, Table, TableError, stated

_Edge = Literal["inboard", "outboard"]
_EDGES: tuple[_Edge, ...] = ("inboard", "outboard")
_GEOMETRIES: tuple[Geometry, ...] = ("linear", "von_karman")
_SIDES = (("left", 1.0), ("right", -1.0))
_UNKNOWN: tuple[float, ...] = (nan, nan, nan, nan)
_SAME = 1.05
"""Times one thickness that another of the same plate may be."""
_ALIKE = 1.3
"""Times the height of sheets by which a plate bends that they may lie at: layers within them are not told apart."""
_NO_SECTION = BeamSection(0.0, 0.0, 0.0, 0.0)


def read_body(raw: Mapping[str, Any], convert: Convert = stated) -> BodyDefinition:
    """The body of a table; TableError with everything that is wrong with it.

    convert: how values are written, by default as in data sheets.
    """
    problems: list[str] = []
    table = Table(raw, "", convert, problems)
    (
        (panel, sheets),
        (frame, joints, frame_nodes),
        (beam, stations, beam_nodes),
        (imported, file_ends, file_nodes),
        twin,
    ) = read_parts(table)
    arms = [arm.name for arm in panel.arms] if panel else []
    own = (name for name in arms if frame is None or name not in dict(frame.joints))
    ends = (*joints, *own, *stations, *file_ends)
    nodes = (*(panel.nodes if panel else ()), *frame_nodes, *beam_nodes, *file_nodes)
    masses = _masses(table, (*ends, *nodes))
    table.close()
    if panel is None and frame is None and beam is None and imported is None and not problems:
        problems.append("give a table panel, a table frame, both, a table import, or a table beam")
    if "beam" in raw and ("panel" in raw or "frame" in raw):
        problems.append("beam: a beam stands alone; join it to other bodies by fixed connections")
    if "import" in raw and any(kind in raw for kind in ("panel", "frame", "beam")):
        problems.append("import: an imported body stands alone; join it to other bodies by fixed connections")
    if not problems:
        problems += [f"panel: {problem}" for problem in (panel.problems() if panel else ())]
        problems += [f"beam.{problem}" for problem in (beam.problems() if beam else ())]
        tips = {} if panel is None else {arm.name: (panel.ends(arm)[1], arm.y, arm.z) for arm in panel.arms}
        problems += [f"frame.{problem}" for problem in (frame.problems(tips) if frame else ())]
        problems += _lost(ends, nodes)
    if problems:
        raise TableError(problems)
    return BodyDefinition(panel, frame, ends, nodes, masses, twin, sheets, beam, imported)


_Points: TypeAlias = tuple[str, ...]


class Parts(NamedTuple):
    """What the tables of a body say, with the names of its attachment points and of its further ones."""

    panel: tuple[Panel | None, FaceSheets | None]
    frame: tuple[Frame | None, _Points, _Points]
    beam: tuple[BeamBody | None, _Points, _Points]
    imported: tuple[ImportedBody | None, _Points, _Points]
    twin: RigidTwin


def read_parts(table: Table) -> Parts:
    """The parts of a body, None where a table is not there."""
    return Parts(
        _panel(table.table("panel", required=False)),
        _frame(table.table("frame", required=False)),
        read_beam(table.table("beam", required=False)),
        read_import(table.table("import", required=False)),
        _twin(table.table("rigid_twin", required=False)),
    )


def _lost(ends: tuple[str, ...], nodes: tuple[str, ...]) -> list[str]:
    """Problems of the points of a whole body."""
    names = [*ends, *nodes]
    found = [f"two points are called {name!r}; rename one" for name in _twice(names)]
    if not ends:
        found.append(
            "no point can be connected to; give panel.hinge_lines, panel.arms or panel.inserts, or name joints of "
            "the frame in frame.attachment_points"
        )
    return found


def _twice(names: Sequence[str]) -> list[str]:
    return sorted({name for name in names if names.count(name) > 1})


def _panel(table: Table | None) -> tuple[Panel | None, FaceSheets | None]:
    if table is None:
        return None, None
    plate, sheets = _plate(table)
    arms = tuple(_arms(table, table.table("arm", required=False)))
    start = table.number(
        "start", "m", "any", max((a.length for a in arms if a.edge == "inboard"), default=0.0)
    )
    center = {"center": (start + 0.5 * plate.length, 0.0)}
    nodes = center | {name: (x, y) for name, (x, y) in table.places("nodes", 2).items()}
    inserts = tuple(_insert(entry) for entry in table.entries("inserts"))
    size = table.number("element_size", "m", default=0.05)
    if "element_size" in table and size > (most := 0.5 * min(plate.length, plate.width)):
        table.note(
            "element_size", f"is {size:g} m; it must be at most {most:g} m, so that two elements fit each way"
        )
    table.close()
    return Panel(plate, (*arms, *inserts), nodes, start, size), sheets


def _plate(table: Table) -> tuple[Plate, FaceSheets | None]:
    """The plate, and the sheets that carry its stress where they are known."""
    length, width = table.number("length", "m"), table.number("width", "m")
    areal_mass = table.number("areal_mass", "kg/m2")
    kind = table.one_of("stiffness", "sandwich", "layers")
    bending, membrane = _UNKNOWN, _UNKNOWN
    sheets, layers = None, []
    if kind == "stiffness" and (given := table.table("stiffness")):
        bending, membrane = given.numbers("bending", "N.m", 4), given.numbers("membrane", "N/m", 4)
        given.close()
    elif kind == "sandwich" and (given := table.table("sandwich")):
        bending, membrane, sheets = _sandwich(given, min(length, width))
    elif kind == "layers":
        layers = [_layer(entry, min(length, width)) for entry in table.entries("layers")]
        if not layers:
            table.note("layers", "is empty; give at least one")
        elif all(layer.is_known for layer in layers):
            bending, membrane, problem = laminate_stiffness(layers)
            if problem:
                table.note("layers", problem)
    for name, values in (("bending", bending), ("membrane", membrane)):
        if min(values[0], values[1], values[3]) <= 0.0 or values[2] ** 2 >= values[0] * values[1]:
            told = f"is {list(values)} in {name}; 11, 22, 66 and 11 x 22 - 12 x 12 of a plate are positive"
            table.note(kind, told)
    prestress = table.number("prestress", "N/m", "zero or positive", 0.0)
    geometry = table.text("geometry", _GEOMETRIES, "linear")
    plate = Plate(
        *(length, width, areal_mass, _orthotropic(bending), _orthotropic(membrane), prestress),
        geometry="von_karman" if geometry == "von_karman" else "linear",
    )
    return plate, _face_sheets(table, sheets, plate, [layer.thickness for layer in layers])


def _orthotropic(values: Sequence[float]) -> tuple[float, float, float, float]:
    first, second, mixed, twist = values
    return first, second, mixed, twist


def _thickness(table: Table, key: str, side: float) -> float:
    """A thickness (m), which is less than the shorter side of its plate (m)."""
    thickness = table.number(key, "m")
    if thickness >= side:
        meant = f"; did you mean {thickness:g} mm" if 1e-3 * thickness < side else ""
        table.note(key, f"{thickness:g} m is thicker than the panel is wide ({side:g} m){meant}")
    return thickness


def _sandwich(table: Table, side: float) -> tuple[tuple[float, ...], tuple[float, ...], FaceSheets | None]:
    """Bending and membrane stiffness of two isotropic skins on a core, and these skins; side: the shorter (m)."""
    skin, core = (_thickness(table, key, side) for key in ("skin", "core"))
    modulus, ratio = table.number("youngs_modulus", "Pa"), table.number("poisson_ratio", "1", "any")
    if abs(ratio) >= 1.0:
        table.note("poisson_ratio", f"is {ratio:g}; it must be between -1 and 1")
        ratio = nan
    shear = table.number("shear_modulus", "Pa", default=0.5 * modulus / (1.0 + ratio))
    table.close()
    sheets = FaceSheets.sandwich(skin, core + skin) if skin > 0.0 and core > 0.0 else None
    return *sandwich_stiffness(skin, core, modulus, ratio, shear), sheets


def _layer(table: Table, side: float) -> Layer:
    modulus = table.number("youngs_modulus", "Pa")
    layer = Layer(
        _thickness(table, "thickness", side),
        modulus,
        table.number("transverse_modulus", "Pa", default=modulus),
        table.number("poisson_ratio", "1", "any"),
        table.number("shear_modulus", "Pa"),
        table.number("angle", "rad", "any", 0.0),
    )
    table.close()
    return layer


def _face_sheets(
    table: Table, own: FaceSheets | None, plate: Plate, layers: Sequence[float]
) -> FaceSheets | None:
    """Those given in place of the plate's own, which it has as a sandwich; layers: thicknesses (m), if it has such."""
    given = table.table("face_sheets", required=False)
    if given is None:
        return own
    solid = given.one_of("thickness", "skin") == "thickness"
    thickness = given.number("thickness" if solid else "skin", "m")
    distance = 0.0 if solid else given.number("distance", "m")
    given.close()
    if not thickness > 0.0 or not (solid or distance > 0.0):
        return None
    sheets = FaceSheets.solid(thickness) if solid else FaceSheets.sandwich(thickness, distance)
    if problem := _contradiction(sheets, own, layers, thickness, distance) or _misplaced(
        sheets, plate, 0.5 * (thickness if solid else distance)
    ):
        table.note("face_sheets", problem)
    return sheets


def _contradiction(
    sheets: FaceSheets, own: FaceSheets | None, layers: Sequence[float], thickness: float, distance: float
) -> str:
    """A sentence where sheets of this thickness and distance (m; 0: solid) are not those of the sandwich or layers."""
    if own is not None and not isclose(sheets.per_moment, own.per_moment, rel_tol=_SAME - 1.0):
        return "are not those of the sandwich, whose skins are known; leave face_sheets out"
    through, total = thickness + distance, sum(layers)
    if not layers or isnan(total):
        return ""
    if through > _SAME * total or (distance == 0.0 and _SAME * through < total):
        return f"reach over {through:g} m, and the layers are {total:g} m thick"
    outer = list(accumulate(layers))
    if distance and not any(isclose(thickness, one, rel_tol=_SAME - 1.0) for one in outer):
        known = ", ".join(f"{one:g}" for one in outer[:-1])
        return f"have a skin of {thickness:g} m, and the outer layers together are {known} m thick"
    return ""


def _misplaced(sheets: FaceSheets, plate: Plate, height: float) -> str:
    """A sentence where sheets at this height (m) are not those whose stretching makes the plate's bending stiffness."""
    bending, membrane = (sum(values[:2]) for values in (plate.bending, plate.membrane))
    if not bending > 0.0 or not membrane > 0.0:
        return ""
    found = sqrt(height * sheets.per_moment * bending / (sheets.per_force * membrane))
    if 1.0 / _ALIKE < found / height < _ALIKE:
        return ""
    return (
        f"lie {2.0 * height:.3g} m apart, and the plate bends as if they lay {2.0 * found:.3g} m apart; check them "
        "against its stiffness"
    )


def _changed(table: Table, arm: HingeArm) -> HingeArm:
    """An arm with the values of a table in place of its own."""
    section = arm.section
    if (stiffness := table.table("stiffness", required=False)) is not None:
        section = _stiffness(stiffness)
        stiffness.close()
    is_rigid = table.flag("rigid", default=section is None)
    if not is_rigid and section is None:
        table.note("rigid", "is false, so the arm needs a table stiffness")
    return replace(
        arm,
        y=table.number("y", "m", "any", arm.y),
        length=table.number("length", "m", "zero or positive", arm.length),
        section=None if is_rigid else section,
        point_mass=table.number("point_mass", "kg", "zero or positive", arm.point_mass),
        patch=table.number("patch", "m", default=arm.patch),
        z=table.number("z", "m", "any", arm.z),
    )


def _stiffness(table: Table) -> BeamSection:
    """A massless section."""
    return BeamSection(
        table.number("axial", "N"),
        table.number("bending_y", "N.m2"),
        table.number("bending_z", "N.m2"),
        table.number("torsion", "N.m2"),
    )


def _arms(table: Table, shared: Table | None) -> list[HingeArm]:
    """Those given one by one, then two on every hinge line, left at +y and right at -y; shared: what all have alike."""
    arms, common = [], HingeArm("", nan, length=0.0)
    has_y = shared is not None and "y" in shared
    if shared is not None:
        common = _changed(shared, common)
        shared.close()
    for entry in table.entries("arms"):
        arm = replace(_changed(entry, common), name=entry.text("name"))
        edge = entry.text("edge", _EDGES, "inboard")
        arms.append(replace(arm, edge="outboard" if edge == "outboard" else "inboard"))
        if isnan(arm.y) and not has_y and "y" not in entry:
            entry.note("y", "is missing")
        entry.close()
    if (lines := table.table("hinge_lines", required=False)) is not None:
        named = {edge: lines.text(edge, default="") for edge in _EDGES}
        if not has_y:
            table.note("arm.y", "is missing; hinge_lines have their arms at + and - y")
        elif common.y <= 0.0:
            table.note("arm.y", f"is {common.y:g}; hinge_lines have left arms at + y and right ones at - y")
        offsets = _offsets(table.table("hinge_line_offsets", required=False), common.z)
        for edge, line in named.items():
            for side, sign in _SIDES if line else ():
                name = f"{line}_{side}"
                arms.append(replace(common, name=name, y=sign * common.y, edge=edge, z=offsets[edge]))
        lines.close()
    return arms


def _offsets(table: Table | None, common: float) -> dict[_Edge, float]:
    """Of the hinge lines from the mid-plane, m, by edge."""
    if table is None:
        return dict.fromkeys(_EDGES, common)
    found = {edge: table.number(edge, "m", "any", common) for edge in _EDGES}
    table.close()
    return found


def _insert(table: Table) -> HingeArm:
    """A rigid insert inside the plate with an attachment point in the middle of its patch, or that of rectangles."""
    rectangles = []
    for entry in table.entries("rectangles"):
        x, y = entry.numbers("x", "m", 2), entry.numbers("y", "m", 2)
        entry.close()
        for axis, (low, high) in (("x", x), ("y", y)):
            if low >= high:
                entry.note(axis, f"is {[low, high]}; give the lower end first")
        rectangles.append(((x[0], x[1]), (y[0], y[1])))
    if rectangles and "patch" in table:
        table.note("patch", "is the side of a square; leave it or rectangles out")
    insert = HingeArm(
        table.text("name"),
        table.number("y", "m", "any"),
        length=0.0,
        point_mass=table.number("point_mass", "kg", "zero or positive", 0.0),
        patch=table.number("patch", "m", default=0.03),
        x=table.number("x", "m", "any"),
        rectangles=tuple(rectangles),
    )
    table.close()
    return insert


def _frame(table: Table | None) -> tuple[Frame | None, tuple[str, ...], tuple[str, ...]]:
    """The frame, and which of its joints are attachment points and nodes."""
    if table is None:
        return None, (), ()
    joints = table.places("joints", 3)
    if "joints" not in table:
        table.note("joints", "is missing")
    common = _section(table)
    members = tuple(_member(entry, common, joints) for entry in table.entries("members"))
    if not members:
        table.note("members", "is missing; a frame needs at least one")
    spread = None
    if (given := table.table("spread_mass", required=False)) is not None:
        spread = SpreadMass(
            given.texts("members", 1, [path.name for path in members]),
            given.number("mass", "kg"),
            given.number("center_of_mass", "m", "any"),
            given.number("inertia", "kg.m2"),
        )
        given.close()
    for name in _twice([path.name for path in members]):
        table.note(f"members.{name}", "stands twice; rename one")
    met = list(dict.fromkeys(name for path in members for name in path.joints))
    for name in sorted(joints.keys() - met):
        table.note(f"joints.{name}", "is where no member goes; leave it out")
    ends, nodes = table.texts("attachment_points", 0, met), table.texts("nodes", 0, met)
    table.close()
    return Frame(tuple(joints.items()), members, spread), ends, nodes


def _member(table: Table, common: BeamSection | None, joints: Collection[str]) -> Path:
    section = _section(table) or common
    if section is None:
        table.note("tube", "is missing; give tube or section, of the member or of the whole frame")
    mass = table.number("mass", "kg", default=inf)
    path = Path(
        table.text("name"),
        table.texts("joints", 2, joints),
        section or _NO_SECTION,
        table.count("elements", 8),
        None if mass == inf else mass,
    )
    table.close()
    return path


def _section(table: Table) -> BeamSection | None:
    """The section of beams, if it is given here."""
    if (tube := table.table("tube", required=False)) is not None:
        diameter, wall = tube.number("diameter", "m"), tube.number("wall", "m")
        if wall > 0.5 * diameter:
            tube.note("wall", f"is {wall:g} m; a tube of {diameter:g} m has a wall of half of that at most")
        material = read_material(tube)
        tube.close()
        return tube_section(diameter, wall, *material) if diameter > wall > 0.0 else _NO_SECTION
    if (given := table.table("section", required=False)) is not None:
        mass, radius = given.number("line_mass", "kg/m"), given.number("gyration_radius", "m")
        section = replace(_stiffness(given), line_mass=mass, gyration_radius=radius)
        given.close()
        return section
    return None


def _masses(table: Table, points: Collection[str]) -> PointMasses:
    found = []
    for entry in table.entries("attached_masses"):
        found.append((entry.text("point", points), entry.number("mass", "kg")))
        entry.close()
    return tuple(found)


def _twin(table: Table | None) -> RigidTwin:
    if table is None:
        return RigidTwin()
    mass = table.number("mass", "kg", default=inf)
    center = table.number("center_of_mass", "m", "any", inf)
    inertia = table.number("inertia", "kg.m2", default=inf)
    twin = RigidTwin(
        table.flag("hardware", True), *(None if value == inf else value for value in (mass, center, inertia))
    )
    table.close()
    return twin
