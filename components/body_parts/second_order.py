"""Newton's iteration of the modal coordinates where the forces on the modes depend on them.

From force to coordinates and back an iteration leads away where tension is stronger than bending.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contract.component import Vector
from ..numerics.oscillators import Propagator
from .ports import BodyPorts


class _Response(NamedTuple):
    """What a force does to each of S modes over a step, (S,), and by what the coordinates change forces, (S, S)."""

    gain: Vector
    tangent: Vector


def correct_step(
    placed: BodyPorts,
    prop: Propagator,
    wrenches: tuple[Vector, Vector],
    residual: Vector,
    force: Vector,
    slope: Vector,
) -> None:
    """Takes forces and slopes (M,) of a step on to those at the coordinates that they make.

    wrenches: means and slopes, (K, 6), as they do work on the modes. residual (M,): what the present forces make of the
    coordinates at the end, less those that they were computed at.
    """
    # forces act at the mean of the coordinates at both ends
    tension, slope_tension = (0.5 * placed.tension(wrench) for wrench in wrenches)
    s = len(tension)
    responses = _Response(prop.b1[:s], tension), _Response(prop.c1[:s], slope_tension)
    for acting, change in zip((force, slope), _corrections(residual[:s], *responses), strict=True):
        acting[:s] += change


def static_deflection(
    placed: BodyPorts, compliance: Vector, a: Vector, eta: Vector, wrench: Vector
) -> Vector:
    """Modal coordinates (M,) under world wrenches (K, 6) on a body turned by a, from those before.

    Those that the forces depend on converge as poses do.
    """
    conjugate = placed.conjugate(a, a, eta, wrench[:, :3], wrench[:, 3:])
    force, tension = placed.modal_force(conjugate, eta), placed.tension(conjugate)
    s = len(tension)
    (change,) = _corrections((compliance * force - eta)[:s], _Response(compliance[:s], tension))
    force[:s] += change
    return compliance * force


def _corrections(residual: Vector, *responses: _Response) -> list[Vector]:
    """By what the forces of each response (S,) change; values that are not finite where no coordinates are found."""
    matrix = np.eye(residual.size) - sum(r.gain[:, None] * r.tangent for r in responses)
    try:
        change = np.linalg.solve(matrix, residual)
    except np.linalg.LinAlgError:
        change = np.full_like(residual, np.nan)
    return [r.tangent @ change for r in responses]
