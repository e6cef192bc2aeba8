"""Stresses and forces of elements that an imported body brings rows for, over a run."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from components import ComponentError
from components.contract.component import Vector

from ...records import short_repr
from ...results.result import Result, ResultError
from ...scene.bodies import body_definition, body_model
from .body_acceleration import acceleration_field
from .model import bending_body, run_shapes


@short_repr
@dataclass(frozen=True)
class BodyOutputs:
    """Outputs of an imported body at the recorded times."""

    body: str
    labels: tuple[str, ...]
    """(S,) such as `element 11 axial`"""
    units: tuple[str, ...]
    """(S,) Pa, N, N.m or N/m"""
    time: Vector = field(repr=False)
    """(N,) s"""
    values: Vector = field(repr=False)
    """(N, S)"""

    def extremes(self) -> list[tuple[str, str, float, float, float, float]]:
        """Label, unit, smallest value and its time, largest value and its time (s) of each."""
        low, high = np.argmin(self.values, axis=0), np.argmax(self.values, axis=0)
        return [
            (
                label,
                unit,
                float(self.values[i, k]),
                float(self.time[i]),
                float(self.values[j, k]),
                float(self.time[j]),
            )
            for k, (label, unit, i, j) in enumerate(zip(self.labels, self.units, low, high, strict=True))
        ]


def body_outputs(result: Result, body: str) -> BodyOutputs:
    """Rows of the body's files times its motion; ResultError where it brought none, or did not bend.

    Modes that the run left out follow the inertia loads statically where the body has mass at nodes or samples of it.
    """
    scene, table = bending_body(result, body)
    try:
        model = body_definition(table).finite_elements(table.masses)
        if model.outputs is None:
            raise ComponentError(_NONE)
        data = body_model(table, flexible=True)
        shapes = run_shapes(result, body, table, model, data)
    except ComponentError as error:
        raise ResultError(f"{result.name}: {body}: {error}") from None
    moved = np.hstack(
        [
            result.signal(body, "modal_coordinate"),
            acceleration_field(result, body, data, scene.header.gravity),
        ]
    )
    values = moved @ (model.outputs.rows @ shapes).T
    return BodyOutputs(body, model.outputs.labels, model.outputs.units, result.time, values)


_NONE = (
    "no rows of stresses or forces came with it; an imported body has them from the .pch and .op4 of a superelement "
    "(mes1, mef1), or as matrices stress, force, moment, force_per_length"
)
