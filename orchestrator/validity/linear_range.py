"""Bodies beyond the range of their theory: linear plates, large rotations by modes, spin."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.flexible.plate import Panel

from ..assembly import Assembly, Part
from ..assembly.fidelities import has_beam
from ..messages import coded, message
from ..results.result import Result
from ..scene import PlacedScene
from .bodies import panel_of
from .centrifugal_stiffening import unstiffened_rates, unstiffened_spins
from .holding_points import holding_points

_THICKNESSES = 1.0
"""Of deflection; a clamped square plate is at 0.90 of them where linear theory has it at 1.3 (Levy, 1942)."""
_MOST_ROWS = 2000
_FEWEST_HOLDERS = 3
_TURN, _SECOND_ORDER_TURN = 0.3, 0.8
"""Largest turns (rad) of a point of a body against another of its points by its modes. A cantilever whose end turns by
an angle shortens by a quarter of its square: 2 % that modes do not know of. Second order does, and what is left goes
with the fourth power."""


class _Bend(NamedTuple):
    """Deflection (m) from the plane through the points that hold a body, and when (s)."""

    deflection: float
    time: float


class _Turn(NamedTuple):
    """Turn (rad) of a point against the first one of its body, which point, and when (s)."""

    angle: float
    point: str
    time: float


def linear_range_warnings(scene: PlacedScene, assembly: Assembly, result: Result) -> Iterator[str]:
    """A message for each body that deformed or spun beyond the range of its model."""
    yield from _bent_plates(scene, assembly, result)
    yield from coded("W-large-rotation", _turned_bodies(scene, assembly, result))
    if not any(unstiffened_spins(scene, assembly)):  # which warn before the run
        rates = {name: _mean_rate(result, name) for name in assembly.flexible}
        yield from coded("W-spin", unstiffened_rates(scene, assembly, rates, "a mean of"))


def _mean_rate(result: Result, body: str) -> float:
    """Root mean square of the rate (rad/s) at which a body turned over the run."""
    time, orientation = result.time, np.asarray(result.signal(body, "frame_orientation")).reshape(-1, 4)
    steps = np.diff(time)
    halves = np.linalg.norm(np.diff(orientation, axis=0), axis=1)
    squares = np.divide(4.0 * halves**2, steps, out=np.zeros_like(steps), where=steps > 0.0)
    return float(np.sqrt(squares.sum() / max(time[-1] - time[0], np.finfo(float).tiny)))


def _turned_bodies(scene: PlacedScene, assembly: Assembly, result: Result) -> Iterator[str]:
    """A sentence for each body whose modes rotated its points relative to one another beyond their range."""
    bodies = {body.name: body for body in scene.bodies}
    for part in assembly.parts:
        if part.name not in assembly.flexible:
            continue
        modal = part.structure["modal"]
        if not np.size(modal["frequency"]):
            continue
        turn = _largest_turn(part, result)
        if turn.angle <= (_SECOND_ORDER_TURN if np.size(modal["second_order_points"]) else _TURN):
            continue
        remedy = "Compare with smaller loads, or model the body in several pieces."
        if part.name in bodies and has_beam(bodies[part.name]):
            remedy = f"Compare with --large-deformation {part.name}."
        yield (
            f"{part.name} bent by {np.degrees(turn.angle):.3g} deg between its points {modal['point_names'][0]} "
            f"and {turn.point} at {turn.time:.4g} s, beyond the small deformation of its modes. {remedy}"
        )


def _largest_turn(part: Part, result: Result) -> _Turn:
    modal = part.structure["modal"]
    shapes = np.asarray(modal["rotation"])
    eta = np.asarray(result.signal(part.name, "modal_coordinate")).reshape(result.time.size, -1)
    chosen = _some_rows(len(eta))
    turns = np.linalg.norm((shapes - shapes[:1]) @ eta[chosen].T, axis=1)
    point, row = np.unravel_index(int(np.argmax(turns)), turns.shape)
    return _Turn(float(turns[point, row]), modal["point_names"][point], float(result.time[chosen[row]]))


def _some_rows(count: int) -> NDArray[np.int64]:
    """Rows of a result, the first and the last among them, no more than are looked at."""
    return np.unique(np.linspace(0, count - 1, min(count, _MOST_ROWS)).astype(np.int64))


def _bent_plates(scene: PlacedScene, assembly: Assembly, result: Result) -> Iterator[str]:
    """A message for each linear plate that bent by more than its thickness between its joints.

    It is a note where the scene states that the plate is linear.
    """
    bodies = {body.name: body for body in scene.bodies}
    for part in assembly.parts:
        panel = panel_of(bodies[part.name]) if part.name in assembly.flexible else None
        if panel is None or panel.plate.geometry != "linear":
            continue
        bend = _largest_bend(assembly, part, panel, result)
        if bend is None:
            continue
        thickness = panel.plate.equivalent_thickness
        if bend.deflection <= _THICKNESSES * thickness:
            continue
        table = bodies[part.name].panel
        states_linear = table is not None and "geometry" in table.model_fields_set
        yield message(
            "N-linear-plate" if states_linear else "W-linear-plate",
            f"{part.name} bent by {1e3 * bend.deflection:.3g} mm between its joints, at {bend.time:.4g} s, "
            f"{bend.deflection / thickness:.2g} times its thickness of {1e3 * thickness:.3g} mm, and its linear model "
            f'has no tension from bending. Compare with body.{part.name}.panel.geometry = "von_karman".',
        )


def _largest_bend(assembly: Assembly, part: Part, panel: Panel, result: Result) -> _Bend | None:
    """Largest deflection between the points that hold a body; None if they enclose no part of it."""
    from scipy.spatial import Delaunay  # which takes a while to load, and few scenes need

    modal, shown = part.structure["modal"], assembly.geometry.get(part.name)
    places, lifts = _held(panel, modal, {point for _, point in holding_points(part, assembly)})
    plane = _with_ones(places)
    if shown is None or np.linalg.matrix_rank(plane, tol=1e-6) < _FEWEST_HOLDERS:
        return None
    surface = np.asarray(shown.positions)
    between = Delaunay(places).find_simplex(surface[:, :2], tol=1e-9) >= 0
    # the deflection of the surface less that of the plane, both linear in the modes
    tilt = np.linalg.pinv(plane) @ lifts
    shapes = np.asarray(shown.shapes)[between, 2] - _with_ones(surface[between]) @ tilt
    eta = np.asarray(result.signal(part.name, "modal_coordinate")).reshape(result.time.size, -1)
    chosen = _some_rows(len(eta))
    size = np.abs(shapes @ eta[chosen].T).max(axis=0, initial=0.0)
    top = int(np.argmax(size))
    return _Bend(float(size[top]), float(result.time[chosen[top]]))


def _held(
    panel: Panel, modal: Mapping[str, Any], points: Collection[str]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Places (k, 2) where these points hold a panel, corners of rigid inserts among them, and shapes (k, M) along z."""
    arms = {arm.name: arm for arm in panel.arms if arm.section is None}
    places, lifts = [], []
    for row, name in enumerate(modal["point_names"]):
        if name not in points:
            continue
        position = np.asarray(modal["point_positions"])[row, :2]
        lift, turn = np.asarray(modal["translation"])[row, 2], np.asarray(modal["rotation"])[row]
        corners = (
            [corner for patch in panel.patches(arms[name]) for corner in product(*patch)]
            if name in arms
            else []
        )
        for corner in (position, *np.array(corners).reshape(-1, 2)):
            arm = corner - position
            places.append(corner)
            lifts.append(lift + turn[0] * arm[1] - turn[1] * arm[0])
    return np.array(places).reshape(-1, 2), np.array(lifts).reshape(len(places), -1)


def _with_ones(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3): 1, x, y, by which planes are linear."""
    return np.column_stack([np.ones(len(positions)), positions[:, :2]])
