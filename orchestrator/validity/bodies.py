"""Masses, inertias and sections of bodies that suggest other units."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from components.contract.frames import Vector3, norm, subtract
from components.flexible.plate import Panel

from ..messages import coded
from ..scene.bodies import body_definition, body_model
from ..scene.body_tables import Body, Inertial
from ..scene.placed_scene import PlacedScene
from ..scene.plausible import Plausible

if TYPE_CHECKING:
    from components.catalogue.beam import BeamBody

_UNLIKE = 0.1
"""Of its mass that a rigid twin may differ by: hardware that finite elements leave out."""
_FIRST_BENDING = 22.3733
"""Square of the first wave number of a free beam times its length, 4.730^2."""
_SMALL = 0.01
"""m, of the radius of gyration of what may stand for a point mass."""
_CLAMPED = 0.24
"""Of an element, by which two held rims make a membrane narrower: 1.8, 1.4, 0.7, 0.4 % of 0.6 m for 50 to 10 mm."""
_COARSE = 0.01
"""Of a frequency, from which on that is told."""
_INERTIAS = "Check the units of mass, inertia, center_of_mass and points."
_GYRATION = Plausible("W-body-data", most=5.0, reason="points span their body", check=_INERTIAS)
_CENTER = Plausible("W-body-data", most=100.0, reason="no body is so far from its points", check=_INERTIAS)
_PLATES = "Check the units of thickness, stiffness, youngs_modulus and areal_mass."
_THICKNESS = Plausible("W-panel-data", most=0.2, reason="the limit of plate theory", check=_PLATES)
_DENSITY = Plausible("W-panel-data", "kg/m3", 1.0, 22_600.0, "air has 1.2, osmium 22 600", _PLATES)
_BENDING = Plausible("W-panel-data", "Hz", least=0.01, reason="a cloth bends so slowly", check=_PLATES)
_SOUND = Plausible("W-panel-data", "m/s", 200.0, 18_000.0, "cork has 500, diamond 18 000", _PLATES)
_SECTIONS = "Check the units of its section and of youngs_modulus."
_STUBBY = Plausible("W-beam-data", most=0.5, reason="the limit of beam theory", check=_SECTIONS)
_ROPE = Plausible("W-beam-data", "Hz", least=0.01, reason="a rope bends so slowly", check=_SECTIONS)
Derived = tuple[str, float, Plausible]
"""What a quantity computed from a table is, its value, and its range."""


def body_warnings(scene: PlacedScene) -> Iterator[str]:
    """The first implausible quantity of each body, and membranes with a coarse mesh."""
    for key, quantities in _quantities(scene):
        found = (
            one for what, value, range_ in quantities for one in range_.warnings(f"{key}: {what} of", value)
        )
        yield from islice(found, 1)
    yield from coded("W-membrane-mesh", _coarse_membranes(scene))


def _quantities(scene: PlacedScene) -> Iterator[tuple[str, Iterable[Derived]]]:
    """Keys of bodies and what is computed from their tables."""
    if scene.base.free is not None:
        yield "base.free", _of_inertia(scene.base.free, scene.base.points.values())
    for body in scene.bodies:
        if body.rigid is not None:
            yield f"body.{body.name}.rigid", _of_inertia(body.rigid, body.rigid.points.values())
        elif (definition := body_definition(body)).panel is not None:
            yield f"body.{body.name}", _of_panel(definition.panel)
        elif definition.beam is not None:
            yield f"body.{body.name}.beam", _of_beam(definition.beam)


def _of_inertia(inertial: Inertial, points: Iterable[Vector3]) -> Iterator[Derived]:
    gyration = float(np.sqrt(np.linalg.eigvalsh(np.array(inertial.inertia))[-1] / inertial.mass))
    distances = [norm(subtract(point, inertial.center_of_mass)) for point in points]
    if reach := max(distances, default=0.0):
        yield f"a radius of gyration ({gyration:.3g} m) over the farthest point", gyration / reach, _GYRATION
        nearest = min(distances) / max(gyration, _SMALL)
        yield f"a distance of all points over the radius of gyration ({gyration:.3g} m)", nearest, _CENTER


def _of_panel(panel: Panel) -> Iterator[Derived]:
    """By the plate that has the panel's stiffnesses; membranes need none of their own."""
    plate = panel.plate
    thickness = plate.equivalent_thickness
    yield "a thickness over its width", thickness / min(plate.length, plate.width), _THICKNESS
    yield f"with a thickness of {1e3 * thickness:.3g} mm a density", plate.areal_mass / thickness, _DENSITY
    if plate.prestress == 0.0:
        bending = _first_bending(min(plate.bending[:2]), plate.areal_mass, max(plate.length, plate.width))
        yield "a first bending frequency", bending, _BENDING
        yield "a speed of sound", float(np.sqrt(plate.membrane[0] / plate.areal_mass)), _SOUND


def _of_beam(beam: BeamBody) -> Iterator[Derived]:
    section, length = beam.section, beam.axis.length
    thickness = float(np.sqrt(12.0 * max(section.bending_y, section.bending_z) / section.axial))
    yield "a thickness over its length", thickness / length, _STUBBY
    bending = _first_bending(min(section.bending_y, section.bending_z), section.line_mass, length)
    yield "a first bending frequency", bending, _ROPE


def _first_bending(bending: float, mass: float, length: float) -> float:
    """Hz, of a free beam or strip of a bending stiffness (N.m2, or N.m over its width) and a mass a length."""
    return float(_FIRST_BENDING / (2.0 * np.pi) * np.sqrt(bending / (mass * length**4)))


def unlike_rigid_models(scene: PlacedScene, bending: Collection[str]) -> Iterator[str]:
    """Flexible bodies whose rigid twin, which latch inertias follow from, has another mass."""
    for body in scene.bodies:
        if body.name in bending and body.rigid_twin:
            twin, own = (body_model(body, flexible).mass for flexible in (False, True))
            if abs(twin - own) > _UNLIKE * own:
                yield (
                    f"body.{body.name}: the rigid twin has {twin:.4g} kg, the flexible body {own:.4g} kg, and "
                    "latch inertias follow from the twin. Give both the same mass."
                )


def _coarse_membranes(scene: PlacedScene) -> Iterator[str]:
    """Membranes with elements longer than the bending length sqrt(D / T) near a held rim."""
    for body in scene.bodies:
        panel = panel_of(body)
        if panel is None or panel.plate.prestress <= 0.0 or body.default_fidelity != "flexible":
            continue
        bent = float(np.sqrt(max(panel.plate.bending[:2]) / panel.plate.prestress))
        rise = _CLAMPED * panel.element_size / min(panel.plate.length, panel.plate.width)
        if rise > _COARSE and panel.element_size > bent:
            yield (
                f"body.{body.name}: elements of {1e3 * panel.element_size:g} mm are longer than the "
                f"{1e3 * bent:.2g} mm over which the membrane bends near a held rim, so frequencies with all rims "
                f"held are about {100.0 * rise:.1g} % too high. Choose a smaller element_size."
            )


def panel_of(body: Body) -> Panel | None:
    """The panel that a body is defined as, if it is."""
    return None if body.rigid is not None else body_definition(body).panel
