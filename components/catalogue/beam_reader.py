"""A table -> a beam: its axis, section and points. The keys are those of `[body.beam]` in scene files."""

from __future__ import annotations

from math import isfinite, isnan, nan

from ..beam_parts.rest_shape import Arc, Curve
from ..beam_parts.sections import Material, rectangle, round_section
from ..beam_parts.variables import Section
from ..contract.component import ComponentError
from .beam import BeamBody
from .tables import Table

_SECTIONS = ("rectangle", "tube", "circle", "section")
_NO_SECTION = Section(*(nan,) * len(Section._fields))
_ELEMENTS = 20


def read_beam(table: Table | None) -> tuple[BeamBody | None, tuple[str, ...], tuple[str, ...]]:
    """The beam, its attachment points and its further points; None where the table gives no whole beam."""
    if table is None:
        return None, (), ()
    axis, section = _axis(table), _section(table)
    elements = table.count("elements", _ELEMENTS)
    ends, nodes = table.distances("attachment_points"), table.distances("nodes")
    up = table.numbers("section_z", "1", 3) if "section_z" in table else (0.0, 0.0, 1.0)
    if not ends:
        table.note("attachment_points", "is missing; give names with distances from the beam's start")
    table.close()
    points = (*ends.items(), *nodes.items())
    sound = axis is not None and all(isfinite(v) for v in (*section, *up, *(at for _, at in points)))
    beam = BeamBody(axis, section, elements, points, up) if axis is not None and sound else None
    return beam, tuple(ends), tuple(nodes)


def _axis(table: Table) -> Arc | Curve | None:
    if table.one_of("length", "axis") == "axis":
        points = table.positions("axis")
        if "radius" in table:
            table.note("radius", "belongs to a length; an axis of points has its own curvature")
        if not points or any(isnan(value) for point in points for value in point):
            return None
        try:
            return Curve(tuple(points))
        except ComponentError as error:
            table.note("axis", str(error))
            return None
    length = table.number("length", "m") if "length" in table else nan
    curvature = 1.0 / table.number("radius", "m") if "radius" in table else 0.0
    return Arc(length, curvature) if isfinite(length) and isfinite(curvature) else None


def _section(table: Table) -> Section:
    kind = table.one_of(*_SECTIONS)
    given = table.table(kind) if kind else None
    if given is None:
        return _NO_SECTION
    section = _general(given) if kind == "section" else _shaped(kind, given)
    given.close()
    return section


def _shaped(kind: str, table: Table) -> Section:
    """A section of one material."""
    factor = table.number("shear_factor", "1") if "shear_factor" in table else None
    if kind == "rectangle":
        width, height = table.number("width", "m"), table.number("height", "m")
        return rectangle(width, height, read_material(table), factor)
    diameter = table.number("diameter", "m")
    wall = table.number("wall", "m") if kind == "tube" else 0.5 * diameter
    if wall > 0.5 * diameter:
        table.note("wall", f"is {wall:g} m; a tube of {diameter:g} m has a wall of half of that at most")
    return round_section(diameter, diameter - 2.0 * wall, read_material(table), factor)


def read_material(table: Table) -> Material:
    """Young's modulus, the shear modulus or what follows from Poisson's ratio, and density."""
    modulus = table.number("youngs_modulus", "Pa")
    if table.one_of("shear_modulus", "poisson_ratio") == "shear_modulus":
        shear = table.number("shear_modulus", "Pa")
    else:
        ratio = table.number("poisson_ratio", "1", "any") if "poisson_ratio" in table else nan
        if abs(ratio) >= 1.0:
            table.note("poisson_ratio", f"is {ratio:g}; it must be between -1 and 1")
            ratio = nan
        shear = 0.5 * modulus / (1.0 + ratio)
    return Material(modulus, shear, table.number("density", "kg/m3"))


def _general(table: Table) -> Section:
    """Stiffnesses and inertia one by one; the section is flat, so its inertia about x is the sum of the others."""
    about_y, about_z = table.number("inertia_y", "kg.m"), table.number("inertia_z", "kg.m")
    return Section(
        axial=table.number("axial", "N"),
        shear_y=table.number("shear_y", "N"),
        shear_z=table.number("shear_z", "N"),
        torsion=table.number("torsion", "N.m2"),
        bending_y=table.number("bending_y", "N.m2"),
        bending_z=table.number("bending_z", "N.m2"),
        line_mass=table.number("line_mass", "kg/m"),
        inertia_x=about_y + about_z,
        inertia_y=about_y,
        inertia_z=about_z,
    )
