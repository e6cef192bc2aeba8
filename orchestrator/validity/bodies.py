"""Masses, inertias and sections of bodies that suggest other units."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from components.contract.frames import Vector3, norm, subtract
from components.flexible.plate import Panel, Plate

from ..messages import coded
from ..scene.bodies import body_definition, body_model
from ..scene.body_tables import Body, Inertial
from ..scene.placed_scene import CheckedScene

_UNLIKE = 0.1
"""Of its mass that a rigid twin may differ by: hardware that finite elements leave out."""
_THICK = 0.2
"""Thickness of a plate over its shorter side, from which on plate theory does not hold by far."""
_STUBBY = 0.5
"""Thickness of a beam over its length, from which on it is none."""
_SLACK = 0.01
"""Hz, of a free beam's first bending: ropes, hoses and cloths bend so slowly, no boom or panel does."""
_FIRST_BENDING = 22.3733
"""Square of the first wave number of a free beam times its length, 4.730^2."""
_LIGHTEST = 1.0
"""kg/m3, of air; the lightest foams have five times that."""
_DENSEST = 22_600.0
"""kg/m3, of osmium: nothing is denser."""
_FAR_CENTER = 100.0
"""Of the radius of gyration, that no centre of mass is from all points of its body."""
_SMALL = 0.01
"""m, of the radius of gyration of what may stand for a point mass."""
_SOUND = (200.0, 18_000.0)
"""m/s, in the plane of what is no membrane: cork has 500 m/s and diamond the most; panels have some thousands."""
_CLAMPED = 0.24
"""Of an element, by which two held rims make a membrane narrower: 1.8, 1.4, 0.7, 0.4 % of 0.6 m for 50 to 10 mm."""
_COARSE = 0.01
"""Of a frequency, from which on that is told."""
_BEYOND_POINTS = 5.0
"""A body's radius of gyration over the distance of its farthest point, where the points still span the body."""


def body_warnings(scene: CheckedScene) -> Iterator[str]:
    """Sentences with their keys."""
    yield from coded("W-body-data", _large_inertias(scene))
    yield from coded("W-panel-data", _unlikely_panels(scene))
    yield from coded("W-membrane-mesh", _coarse_membranes(scene))
    yield from coded("W-beam-data", _unlikely_beams(scene))


def unlike_rigid_models(scene: CheckedScene, bending: Collection[str]) -> Iterator[str]:
    """Flexible bodies whose rigid twin, which latch inertias follow from, has another mass."""
    for body in scene.bodies:
        if body.name in bending and body.rigid_twin:
            twin, own = (body_model(body, flexible).mass for flexible in (False, True))
            if abs(twin - own) > _UNLIKE * own:
                yield (
                    f"body.{body.name}: the rigid twin has {twin:.4g} kg, the flexible body {own:.4g} kg, and "
                    "latch inertias follow from the twin. Give both the same mass."
                )


def _large_inertias(scene: CheckedScene) -> Iterator[str]:
    """Rigid bodies, the spacecraft included, whose inertia is too large for their points."""
    for body in scene.bodies:
        if body.rigid is not None:
            yield from _large_inertia(f"body.{body.name}.rigid", body.rigid, list(body.rigid.points.values()))
    if scene.base.free is not None:
        yield from _large_inertia("base.free", scene.base.free, list(scene.base.points.values()))


def _large_inertia(key: str, inertial: Inertial, points: list[Vector3]) -> Iterator[str]:
    gyration = float(np.sqrt(np.linalg.eigvalsh(np.array(inertial.inertia))[-1] / inertial.mass))
    reach = max((norm(subtract(point, inertial.center_of_mass)) for point in points), default=0.0)
    if reach and gyration > _BEYOND_POINTS * reach:
        yield (
            f"{key}: the radius of gyration is {gyration:.3g} m, but all points are within {reach:.3g} m of the "
            "centre of mass. Check the units of mass, inertia and points."
        )
    nearest = min((norm(subtract(point, inertial.center_of_mass)) for point in points), default=0.0)
    if nearest > _FAR_CENTER * max(gyration, _SMALL):
        yield (
            f"{key}: the centre of mass is {nearest:.3g} m from all points, but the radius of gyration is "
            f"{gyration:.3g} m. Check the units of center_of_mass and points."
        )


def _unlikely_panels(scene: CheckedScene) -> Iterator[str]:
    """Panels too thick for plate theory, denser or lighter than any material, or too soft, by their stiffnesses."""
    for body in scene.bodies:
        panel = panel_of(body)
        if panel is None:
            continue
        plate, key = panel.plate, f"body.{body.name}"
        thickness = float(np.sqrt(12.0 * plate.bending[0] / plate.membrane[0]))
        side = min(plate.length, plate.width)
        density = plate.areal_mass / thickness
        like = f"its stiffness is that of a {1e3 * thickness:.3g} mm plate"
        if thickness > _THICK * side:
            yield (
                f"{key}: {like}, which is too thick for plate theory at a width of {side:.3g} m. Check the units "
                "of its thickness or stiffness."
            )
        elif density < _LIGHTEST:
            yield (
                f"{key}: {like}, so {plate.areal_mass:g} kg/m2 means {density:.3g} kg/m3, lighter than any foam. "
                "Check the unit of areal_mass."
            )
        if density > _DENSEST:
            yield (
                f"{key}: {like}, so {plate.areal_mass:g} kg/m2 means {density:.3g} kg/m3, denser than any "
                "material. Check the units of areal_mass and thickness."
            )
        if plate.prestress == 0.0 and _LIGHTEST <= density <= _DENSEST:
            yield from _unlike_stiffness(key, plate)


def _unlike_stiffness(key: str, plate: Plate) -> Iterator[str]:
    """Plates without tension that are as soft as a cloth, or whose stiffness is that of no material."""
    first = _first_bending(min(plate.bending[:2]), plate.areal_mass, max(plate.length, plate.width))
    speed = float(np.sqrt(plate.membrane[0] / plate.areal_mass))
    if first < _SLACK:
        yield (
            f"{key}: the first bending frequency of the free panel is {first:.2g} Hz, that of a cloth. Check the "
            "units of youngs_modulus or bending."
        )
    elif not _SOUND[0] < speed < _SOUND[1]:
        yield (
            f"{key}: stiffness over mass is that of no material (speed of sound {speed:.3g} m/s, "
            f"{'below cork' if speed < _SOUND[0] else 'above diamond'}). Check the units of youngs_modulus or "
            "membrane, and of areal_mass."
        )


def _coarse_membranes(scene: CheckedScene) -> Iterator[str]:
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


def _first_bending(bending: float, mass: float, length: float) -> float:
    """Hz, of a free beam or strip of a bending stiffness (N.m2, or N.m over its width) and a mass a length."""
    return float(_FIRST_BENDING / (2.0 * np.pi) * np.sqrt(bending / (mass * length**4)))


def _unlikely_beams(scene: CheckedScene) -> Iterator[str]:
    """Beams too thick for beam theory, or as soft as a rope, by their stiffnesses."""
    for body in scene.bodies:
        beam = None if body.beam is None else body_definition(body).beam
        if beam is None:
            continue
        section, length, key = beam.section, beam.axis.length, f"body.{body.name}.beam"
        thickness = float(np.sqrt(12.0 * max(section.bending_y, section.bending_z) / section.axial))
        if thickness > _STUBBY * length:
            yield (
                f"{key}: its stiffness is that of a bar {thickness:.3g} m thick, which is too thick for beam "
                f"theory at a length of {length:.3g} m. Check the units of its section."
            )
        bending = min(section.bending_y, section.bending_z)
        first = _first_bending(bending, section.line_mass, length)
        if first < _SLACK:
            yield (
                f"{key}: the first bending frequency of the free beam is {first:.2g} Hz, that of a rope. Check the "
                "units of its section and of youngs_modulus."
            )


def panel_of(body: Body) -> Panel | None:
    """The panel that a body is defined as, if it is."""
    return None if body.rigid is not None else body_definition(body).panel
