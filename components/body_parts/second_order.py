"""Newton's iteration of the modal coordinates where the forces on the modes depend on them.

From force to coordinates and back an iteration leads away where tension is stronger than bending. Tension comes from
loads on ports, and where bending stretches the body from its own modes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contract.component import Vector
from ..numerics.oscillators import Propagator
from .ports import BodyPorts
from .tension import OwnTension


class _Response(NamedTuple):
    """What a force does to each of S modes over a step, (S,), and by what the coordinates change forces, (S, S)."""

    gain: Vector
    tangent: Vector


class ModalPath(NamedTuple):
    """Of a step: coordinates and rates at its start, and what was found of the end and of the rates' moments, (M,)."""

    start: Vector
    rate: Vector
    end: Vector
    moment: Vector


def correct_step(
    placed: BodyPorts,
    prop: Propagator,
    wrenches: tuple[Vector, Vector],
    own: OwnTension | None,
    path: ModalPath,
    force: Vector,
    slope: Vector,
) -> Vector:
    """Takes forces and slopes (M,) of a step on to those at the coordinates that they make; the rates' moments (M,).

    wrenches: means and slopes, (K, 6), as they do work on the modes; the forces of own tension join them here. path:
    where the present forces were computed.
    """
    # forces of ports act at the mean of the coordinates at both ends
    tension, slope_tension = (0.5 * placed.tension(wrench) for wrench in wrenches)
    s = len(tension)
    if own is None:
        residual = (prop.end(path.start, path.rate, force, slope)[0] - path.end)[:s]
        responses = _Response(prop.b1[:s], tension), _Response(prop.c1[:s], slope_tension)
        for acting, change in zip((force, slope), _corrections(residual, *responses), strict=True):
            acting[:s] += change
        return path.moment
    own = own.after(path.end, path.moment)
    own.add_forces(force, slope)
    by_end, slope_by_end, by_moment = own.tangents()
    by_end, slope_by_end = by_end + tension, slope_by_end + slope_tension
    end = (prop.end(path.start, path.rate, force, slope)[0] - path.end)[:s]
    moment = (prop.moment(path.start, path.rate, force, slope) - path.moment)[:s]
    b, c, d = (gain[:s, None] for gain in (prop.b1, prop.c1, prop.d))
    matrix = np.eye(2 * s) - np.block(
        [[b * by_end + c * slope_by_end, b * by_moment], [d * slope_by_end - c * by_end, -c * by_moment]]
    )
    end, moment = np.split(solved(matrix, np.concatenate((end, moment))), 2)
    force[:s] += by_end @ end + by_moment @ moment
    slope[:s] += slope_by_end @ end
    return prop.moment(path.start, path.rate, force, slope)


def _corrections(residual: Vector, *responses: _Response) -> list[Vector]:
    """By what the forces of each response (S,) change; values that are not finite where no coordinates are found."""
    matrix = np.eye(residual.size) - sum(r.gain[:, None] * r.tangent for r in responses)
    change = solved(matrix, residual)
    return [r.tangent @ change for r in responses]


def solved(matrix: Vector, right: Vector) -> Vector:
    """Solution (N,) of a square system; values that are not finite where it has none."""
    try:
        found = np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        found = np.full_like(right, np.nan)
    return found
