"""The definition of a body from its tables: plain values, of which components and finite elements are made."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from itertools import accumulate
from math import isclose, sqrt
from pathlib import Path
from typing import NamedTuple, TypeAlias

from components.beam_parts.rest_shape import Arc, Curve
from components.beam_parts.sections import Material, rectangle, round_section
from components.beam_parts.variables import Section
from components.catalogue.beam import BeamBody
from components.catalogue.definition import BodyDefinition, RigidTwin
from components.catalogue.frame import Frame, SpreadMass
from components.catalogue.frame import Path as Member
from components.contract.component import ComponentError
from components.contract.regular import content
from components.flexible.beam_frame import BeamSection, tube_section
from components.flexible.laminate import Layer, laminate_stiffness
from components.flexible.plate import HingeArm, Panel, Plate, sandwich_stiffness
from components.flexible.stress import FaceSheets
from components.imported.agreement import Stated
from components.imported.body import ImportedBody
from components.imported.points import JoinedPoint
from components.imported.reading import beside

from .body_tables import Body
from .construction.frame_tables import BeamTable, FrameTable, MemberTable
from .construction.import_tables import ImportTable
from .construction.materials import MaterialTable
from .construction.panel_tables import (
    ArmTable,
    CommonArmTable,
    FaceSheetsTable,
    InsertTable,
    LayerTable,
    PanelTable,
)
from .table import BodyError

_SIDES = (("left", 1.0), ("right", -1.0))
_SAME = 1.05
"""Times one thickness that another of the same plate may be."""
_ALIKE = 1.3
"""Times the height of sheets by which a plate bends that they may lie at: layers within them are not told apart."""
_Four: TypeAlias = tuple[float, float, float, float]


def definition(body: Body) -> BodyDefinition:
    """The definition of a body; BodyError with everything that is wrong with it."""
    problems: list[str] = []
    panel, sheets = (None, None) if body.panel is None else _panel(body.panel, problems)
    frame = None if body.frame is None else _frame(body.frame)
    beam = None if body.beam is None else _beam(body.beam, problems)
    imported = None if body.imported is None else _imported(body.imported, problems)
    arms = () if panel is None else panel.arms
    joined = () if imported is None else (*imported.rigid_elements, *imported.means)
    joints = () if body.frame is None else body.frame.joints
    tables = [table for table in (body.frame, body.beam, body.imported) if table is not None]
    ends = (
        *(name for table in tables for name in table.attachment_points),
        *(arm.name for arm in arms if arm.name not in joints),  # others are welded
        *(point.name for point in joined),
    )
    nodes = (*(() if panel is None else panel.nodes), *(name for table in tables for name in table.nodes))
    if not problems:
        problems += [f"panel: {problem}" for problem in (panel.problems() if panel else ())]
        problems += [f"beam.{problem}" for problem in (beam.problems() if beam else ())]
        tips = {arm.name: (panel.ends(arm)[1], arm.y, arm.z) for arm in arms if panel is not None}
        problems += [f"frame.{problem}" for problem in (frame.problems(tips) if frame else ())]
        problems += _lost(ends, nodes)
    if problems:
        raise BodyError(problems)
    twin = RigidTwin() if body.rigid_twin is None else RigidTwin(**body.rigid_twin.model_dump())
    return BodyDefinition(panel, frame, ends, nodes, twin, sheets, beam, imported)


def _lost(ends: Sequence[str], nodes: Sequence[str]) -> Iterator[str]:
    """Problems of the points of a whole body."""
    names = [*ends, *nodes]
    for name in sorted({name for name in names if names.count(name) > 1}):
        yield f"two points are called {name!r}; rename one"
    if not ends:
        yield (
            "no point can be connected to; give panel.hinge_lines, panel.arms or panel.inserts, or name joints of "
            "the frame in frame.attachment_points"
        )


def _panel(table: PanelTable, problems: list[str]) -> tuple[Panel, FaceSheets | None]:
    """The panel, and the sheets that carry its stress where they are known."""
    stiffness = _stiffness(table, problems)
    plate = Plate(
        **table.model_dump(include={"length", "width", "areal_mass", "prestress", "geometry"}),
        bending=stiffness.bending,
        membrane=stiffness.membrane,
    )
    sheets = stiffness.sheets
    if (given := table.face_sheets) is not None:
        sheets = _face_sheets(given)
        thickness, distance = given.thickness or given.skin or 0.0, given.distance or 0.0
        layers = [layer.thickness for layer in table.layers or ()]
        if problem := _contradiction(sheets, stiffness.sheets, layers, thickness, distance) or _misplaced(
            sheets, plate, 0.5 * (distance or thickness)
        ):
            problems.append(f"panel.face_sheets: {problem}")
    arms = tuple(_arms(table))
    longest = max((arm.length for arm in arms if arm.edge == "inboard"), default=0.0)
    start = longest if table.start is None else table.start
    nodes = {"center": (start + 0.5 * plate.length, 0.0), **table.nodes}
    inserts = tuple(map(_insert, table.inserts))
    return Panel(plate, (*arms, *inserts), nodes, start, table.element_size), sheets


class _Stiffness(NamedTuple):
    """Bending (N m) and membrane (N/m) stiffness of a plate, and the sheets that it has as a sandwich."""

    bending: _Four
    membrane: _Four
    sheets: FaceSheets | None = None


def _stiffness(table: PanelTable, problems: list[str]) -> _Stiffness:
    if (sandwich := table.sandwich) is not None:
        kind, skin, core, modulus = "sandwich", sandwich.skin, sandwich.core, sandwich.youngs_modulus
        shear = sandwich.shear_modulus or 0.5 * modulus / (1.0 + sandwich.poisson_ratio)
        pair = sandwich_stiffness(skin, core, modulus, sandwich.poisson_ratio, shear)
        found = _Stiffness(*pair, FaceSheets.sandwich(skin, core + skin))
    elif table.layers is not None:
        kind, layers = "layers", [_layer(layer) for layer in table.layers]
        bending, membrane, problem = laminate_stiffness(layers)
        if problem:
            problems.append(f"panel.layers: {problem}")
        found = _Stiffness(bending, membrane)
    else:
        assert table.stiffness is not None
        kind, found = "stiffness", _Stiffness(**table.stiffness.model_dump())
    for name, values in (("bending", found.bending), ("membrane", found.membrane)):
        if min(values[0], values[1], values[3]) <= 0.0 or values[2] ** 2 >= values[0] * values[1]:
            problems.append(
                f"panel.{kind}: is {list(values)} in {name}; 11, 22, 66 and 11 x 22 - 12 x 12 of a plate are positive"
            )
    return found


def _layer(table: LayerTable) -> Layer:
    return Layer(
        **table.model_dump(exclude={"transverse_modulus"}),
        transverse_modulus=table.transverse_modulus or table.youngs_modulus,
    )


def _face_sheets(table: FaceSheetsTable) -> FaceSheets:
    if table.thickness is not None:
        return FaceSheets.solid(table.thickness)
    assert table.skin is not None
    assert table.distance is not None
    return FaceSheets.sandwich(table.skin, table.distance)


def _contradiction(
    sheets: FaceSheets, own: FaceSheets | None, layers: Sequence[float], thickness: float, distance: float
) -> str:
    """A sentence where sheets of this thickness and distance (m; 0: solid) are not those of the sandwich or layers."""
    if own is not None and not isclose(sheets.per_moment, own.per_moment, rel_tol=_SAME - 1.0):
        return "are not those of the sandwich, whose skins are known; leave face_sheets out"
    through, total = thickness + distance, sum(layers)
    if not layers:
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


def _arms(table: PanelTable) -> Iterator[HingeArm]:
    """Those given one by one, then two on every hinge line, left at +y and right at -y."""
    common = table.arm or CommonArmTable()
    for arm in table.arms:
        yield _arm(arm, common)
    if table.hinge_lines is None or common.y is None:
        return
    for edge, line in (("inboard", table.hinge_lines.inboard), ("outboard", table.hinge_lines.outboard)):
        offset = None if table.hinge_line_offsets is None else getattr(table.hinge_line_offsets, edge)
        for side, sign in _SIDES if line else ():
            name, y = f"{line}_{side}", sign * common.y
            yield _arm(ArmTable.model_construct(name=name, edge=edge, y=y, z=offset), common)


def _arm(arm: ArmTable, common: CommonArmTable) -> HingeArm:
    """An arm with the common keys that it omits."""
    keys = common.model_dump() | arm.model_dump(exclude_none=True)
    stiffness, _ = keys.pop("stiffness"), keys.pop("rigid")
    if common.rigid and arm.stiffness is None:
        stiffness = None
    is_rigid = stiffness is None if arm.rigid is None else arm.rigid
    return HingeArm(**keys, section=None if is_rigid else BeamSection(**stiffness))


def _insert(table: InsertTable) -> HingeArm:
    """A rigid insert inside the plate with an attachment point in the middle of its patch, or that of rectangles."""
    rectangles = tuple((part.x, part.y) for part in table.rectangles)
    return HingeArm(**table.model_dump(exclude={"rectangles"}), length=0.0, rectangles=rectangles)


def _frame(table: FrameTable) -> Frame:
    spread = None if table.spread_mass is None else SpreadMass(**table.spread_mass.model_dump())
    members = tuple(_member(member, table) for member in table.members)
    return Frame(tuple(table.joints.items()), members, spread)


def _member(table: MemberTable, frame: FrameTable) -> Member:
    own = table if table.tube is not None or table.section is not None else frame
    return Member(**table.model_dump(exclude={"tube", "section"}), section=_frame_section(own))


def _frame_section(table: MemberTable | FrameTable) -> BeamSection:
    if table.tube is not None:
        return tube_section(table.tube.diameter, table.tube.wall, *_material(table.tube))
    assert table.section is not None
    return BeamSection(**table.section.model_dump())


def _material(table: MaterialTable) -> Material:
    """Young's modulus, the shear modulus or what follows from Poisson's ratio, and density."""
    shear = table.shear_modulus or 0.5 * table.youngs_modulus / (1.0 + (table.poisson_ratio or 0.0))
    return Material(table.youngs_modulus, shear, table.density)


def _beam(table: BeamTable, problems: list[str]) -> BeamBody | None:
    axis = _axis(table, problems)
    points = (*table.attachment_points.items(), *table.nodes.items())
    if axis is None:
        return None
    return BeamBody(axis, _beam_section(table), table.elements, points, table.section_z)


def _axis(table: BeamTable, problems: list[str]) -> Arc | Curve | None:
    if table.axis is None:
        assert table.length is not None
        return Arc(table.length, 0.0 if table.radius is None else 1.0 / table.radius)
    try:
        return Curve(table.axis)
    except ComponentError as error:
        problems.append(f"beam.axis: {error}")
        return None


def _beam_section(table: BeamTable) -> Section:
    if (shape := table.rectangle) is not None:
        return rectangle(shape.width, shape.height, _material(shape), shape.shear_factor)
    if (tube := table.tube) is not None:
        return round_section(
            tube.diameter, tube.diameter - 2.0 * tube.wall, _material(tube), tube.shear_factor
        )
    if (circle := table.circle) is not None:
        return round_section(circle.diameter, 0.0, _material(circle), circle.shear_factor)
    given = table.section
    assert given is not None
    # the section is flat, so its inertia about x is the sum of the others
    return Section(**given.model_dump(), inertia_x=given.inertia_y + given.inertia_z)


def _imported(table: ImportTable, problems: list[str]) -> ImportedBody:
    return ImportedBody(
        tuple(table.files.items()),
        _digest(table, problems),
        tuple(table.attachment_points.items()),
        tuple(table.nodes.items()),
        tuple(JoinedPoint(**point.model_dump()) for point in table.rigid_elements),
        tuple(JoinedPoint(**point.model_dump()) for point in table.means),
        **table.units.model_dump(),
        stated=Stated() if table.stated is None else Stated(**table.stated.model_dump()),
    )


def _digest(table: ImportTable, problems: list[str]) -> str:
    """Of the content of all files."""
    found = hashlib.sha256()
    for name, given in table.files.items():
        path = Path(given)
        for part in beside(path):
            try:
                found.update(content(part))
            except OSError as error:
                if part == path:
                    problems.append(f"import.{name}: {path}: cannot be read: {error.strerror}")
    return found.hexdigest()
