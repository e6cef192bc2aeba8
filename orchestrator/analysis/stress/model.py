"""The plate of a body in a result, rebuilt from the scene that the result holds, and its recorded motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from components import ComponentError
from components.contract.component import Vector
from components.flexible.finite_elements import FiniteElementModel, PlateNodes
from components.flexible.modal import ModalData
from components.flexible.reduction import inertia_relief, orthonormal_modes
from components.flexible.stress import Indices, StressRecovery, stress_recovery
from components.flexible.von_karman import tension_fields

from ...results.parts import json_of
from ...results.result import Result, ResultError
from ...scene.bodies import body_definition, body_model
from ...scene.body_tables import Body
from ...scene.layers import Tree
from ...scene.placed_scene import PlacedScene
from ...scene.reader import read_scene
from .body_acceleration import acceleration_field

AT_INSERT = 1e-9
"""Distance (m) below which a node is on the edge of a rigid insert, where stresses depend on the mesh."""
_SAME = 1e-6  # of a mode's largest display value; round-off of the modes leaves 1e-9
_EQUAL_FREQUENCY = 1e-3  # relative; round-off of 1e-11 turns modes that are this near by up to 1e-8


@dataclass(frozen=True)
class BodyStress:
    """Recovery at the chosen nodes of a body's plate, and the coordinates (N, M + 12 + P) that go with it."""

    plate: PlateNodes
    recovery: StressRecovery
    coordinates: Vector
    """modal coordinates, the acceleration field of the static correction, then tensions that bending makes"""
    slopes: Vector | None
    """(2 K, S) by modal coordinates, row 2 k + axis, where bending stretches the plate"""
    prestress: float
    """tension of the plate at rest, Pa, which the recovery leaves out"""
    shapes: Vector
    """(n, 3, M) of all nodes of the plate by the modal coordinates of the run, m / (kg^1/2 m)"""


def body_stress(result: Result, body: str, choose: Callable[[PlateNodes], Indices]) -> BodyStress:
    """Stress recovery of a flexible panel; ResultError where the result or the catalogue does not allow it."""
    if result.has(body, "section_moment"):
        raise ResultError(
            f"{result.name}: {body} is a beam of large deformation, which has no face sheets; its signals "
            "section_force and section_moment hold the resultants of every element"
        )
    scene, table = bending_body(result, body)
    try:
        definition = body_definition(table)
        sheets = definition.face_sheets
        if sheets is None:
            raise ComponentError(_NO_PANEL if definition.panel is None else _NO_SHEETS)
        model = definition.finite_elements(table.masses)
        data = body_model(table, flexible=True)
        shapes = run_shapes(result, body, table, model, data)
        if model.plate is None:
            raise ComponentError("stresses are recovered for plates only, and this body is none")
        forms = _forms(result, body, data)
        prestress = 0.0 if definition.panel is None else sheets.per_force * definition.panel.plate.prestress
        recovery, slopes = stress_recovery(model, sheets, shapes, choose(model.plate)), None
        if len(forms):
            low = forms.shape[1]
            rows = (2 * recovery.nodes[:, None] + np.arange(2)).ravel()
            slopes = np.asarray(model.plate.slopes[rows] @ shapes[:, :low])
            fields = tension_fields(model, model.plate, shapes[:, :low], data.frequency[:low], forms)
            recovery = recovery.with_tension(sheets, fields)
    except ComponentError as error:
        raise ResultError(f"{result.name}: {body}: {error}") from None
    field = acceleration_field(result, body, data, scene.header.gravity)
    eta = result.signal(body, "modal_coordinate")
    moved = np.asarray(model.plate.translations @ shapes[:, : eta.shape[1]])
    coordinates = np.hstack([eta, field, _tensions(forms, eta)])
    displacement = moved.reshape(-1, 3, eta.shape[1])
    return BodyStress(model.plate, recovery, coordinates, slopes, prestress, displacement)


def scene_of(result: Result) -> PlacedScene:
    """The scene that a result holds, without its plugins; ResultError where it holds none, SceneError for a bad one."""
    return read_scene(f"{result.name} (scene)", scene_tree(result), of_result=True)


def scene_tree(result: Result) -> Tree:
    """Its tables; ResultError where it holds none."""
    tree = json_of(result.provenance.get("scene_tree", ""))
    if not isinstance(tree, dict):
        raise ResultError(f"{result.name}: the result does not hold its scene; run the scene again")
    return tree


def _forms(result: Result, body: str, data: ModalData) -> Vector:
    """Forms (P, S, S) of bending that stretches, by the modes of the run."""
    display = data.display_shapes.reshape(-1, data.frequency.size)
    recorded = result.geometry[body].shapes.reshape(display.shape)
    low = data.second_order_modes
    mixing = _mixing(data.frequency, display, recorded)[:low, :low]
    found: Vector = mixing.T @ data.tension_forms @ mixing
    return found


def _tensions(forms: Vector, eta: Vector) -> Vector:
    """Tensions (N, P) at modal coordinates (N, M)."""
    low = eta[:, : forms.shape[1]]
    found: Vector = 0.5 * np.einsum("nj,pjk,nk->np", low, forms, low, optimize=True)
    return found


def bending_body(result: Result, body: str) -> tuple[PlacedScene, Body]:
    """The scene that a result holds, and its table of a body; ResultError where the body did not bend."""
    scene = scene_of(result)
    table = next((table for table in scene.bodies if table.name == body), None)
    kept = result.provenance.get("recorded_signals")
    if (
        kept
        and table is not None
        and (body not in result.geometry or not result.has(body, "modal_coordinate"))
    ):
        raise ResultError(
            f"{result.name}: this run kept {kept} alone, not all signals of {body}; run it again with "
            f"--signals '{kept}, {body}'"
        )
    if not result.has(body, "modal_coordinate"):
        result.variables(body)
        flexible = ", ".join(result.recording("modal_coordinate")) or "none"
        raise ResultError(
            f"{result.name}: {body} has no modal coordinates; flexible bodies of this run are {flexible}"
        )
    if table is None or not table.can_bend:
        raise ResultError(f"{result.name}: {body} is not a body that can bend")
    return scene, table


def run_shapes(result: Result, body: str, table: Body, model: FiniteElementModel, data: ModalData) -> Vector:
    """Mode shapes (n, M) in the order and with the signs of the run, then the shapes of the static correction.

    What the run left out of its modes is part of the static correction.
    """
    definition = body_definition(table)
    points, count = (
        definition.attachment_points,
        definition.fixed_interface_modes(table.fixed_interface_modes),
    )
    frequency, modes = orthonormal_modes(model, points, count)
    whole = body_model(table.model_copy(update={"modes_off": (), "frequencies_off": ()}), flexible=True)
    kept = np.flatnonzero(np.isin(whole.frequency, data.frequency))
    frequency, modes = frequency[kept], modes[:, kept]
    display = np.asarray(model.display_displacement @ modes)
    recorded = result.geometry[body].shapes.reshape(display.shape[0], -1)
    if recorded.shape != display.shape:
        raise ComponentError(_CHANGED)
    modes = modes @ _mixing(frequency, display, recorded)
    difference = np.abs(np.asarray(model.display_displacement @ modes) - recorded).max(axis=0)
    if np.any(difference > _SAME * np.abs(recorded).max(axis=0)):
        raise ComponentError(_CHANGED)
    return np.hstack([modes, inertia_relief(model, points, frequency, modes)])


_NO_SHEETS = "no face sheets are known of it; give panel.face_sheets, or the panel as a sandwich"
_NO_PANEL = "it is no panel, and has no face sheets; `fanfold plot` draws the loads at its ports"
_CHANGED = "the catalogue's modes are not those of this run; run the scene again with this version"


def _mixing(frequency: Vector, display: Vector, recorded: Vector) -> Vector:
    """Matrix (M, M) that turns modes into the recorded ones: signs, and rotations among equal frequencies."""
    mixing = np.zeros((frequency.size, frequency.size))
    gaps = np.flatnonzero(np.diff(frequency) > _EQUAL_FREQUENCY * frequency[1:]) + 1
    for group in np.split(np.arange(frequency.size), gaps):
        fit = np.linalg.lstsq(display[:, group], recorded[:, group])[0]
        left, _, right = np.linalg.svd(fit)
        mixing[np.ix_(group, group)] = left @ right
    return mixing
