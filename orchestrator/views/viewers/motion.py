"""Motions of bodies as viewers play them: a pose and amplitudes of forms at few times, linear in between."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector
from components.contract.frames import rotated

from ...assembly import Geometry
from ...results.result import Result, ResultError
from ..placement import placed
from .thinning import sufficient

Rows = NDArray[np.int64]
_AT_ONCE = 2_000_000
"""Coordinates of nodes that are in memory at a time."""
_SHARE = 0.25
"""Of the tolerance, that the forms of a beam's motion may miss."""


@dataclass(frozen=True)
class Motion:
    """Nodes at rest (D, 3) m, forms (D, 3, M) m; at times (N,) s position (N, 3) m, orientation (N, 4), amplitudes.

    Nodes are where the pose brings positions + forms amplitudes. Orientations are unit quaternions, scalar first,
    each on the same side as the one before; amplitudes (N, M) are at most 1.
    """

    time: Vector
    nodes: Vector
    forms: Vector
    position: Vector
    orientation: Vector
    amplitudes: Vector
    missed: float | None = None
    """m, that no node is farther from where principal forms bring it; None where forms are modes of the body"""

    def at(self, rows: Rows) -> Vector:
        """Nodes (n, D, 3) in world axes at some rows."""
        return self._placed(self.position[rows], self.orientation[rows], self.amplitudes[rows])

    def between(self, left: int, right: int, times: Vector) -> Vector:
        """Nodes (n, D, 3) at times between two rows, as viewers play them if there is none in between."""
        share = ((times - self.time[left]) / (self.time[right] - self.time[left]))[:, None]
        ends = [(part[left], part[right]) for part in (self.position, self.amplitudes)]
        position, amplitudes = (first + share * (last - first) for first, last in ends)
        orientation = _slerp(self.orientation[left], self.orientation[right], share)
        return self._placed(position, orientation, amplitudes)

    def part(self, rows: Rows) -> Motion:
        """The same motion at some of its rows."""
        return Motion(
            self.time[rows], self.nodes, self.forms, self.position[rows], self.orientation[rows],
            self.amplitudes[rows], self.missed,
        )  # fmt: skip

    def _placed(self, position: Vector, orientation: Vector, amplitudes: Vector) -> Vector:
        bent = self.nodes + np.einsum("dam,rm->rda", self.forms, amplitudes, optimize=True)
        return rotated(orientation[:, None, :], bent) + position[:, None, :]


def motion(result: Result, name: str, body: Geometry, rows: Rows, tolerance: float) -> Motion:
    """Motion of a body at rows (N,) of a result; tolerance (m): of beams, whose forms are principal ones."""
    if result.has(name, "node_position"):
        return _of_beam(result, name, body, rows, tolerance)
    count, nodes, shapes = rows.size, np.asarray(body.positions), np.asarray(body.shapes)
    position, orientation = np.zeros((count, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    amplitudes = np.zeros((count, shapes.shape[2]))
    if result.has(name, "frame_position"):
        position = result.signal(name, "frame_position")[rows]
        orientation = _continuous(result.signal(name, "frame_orientation")[rows])
        if not np.all(np.isfinite(orientation)):
            raise ResultError(f"{result.name}: {name}.frame_orientation has rows that are no rotation")
    if result.has(name, "modal_coordinate"):
        amplitudes = result.signal(name, "modal_coordinate").reshape(result.time.size, -1)[rows]
    return _scaled(Motion(result.time[rows], nodes, shapes, position, orientation, amplitudes))


def _of_beam(result: Result, name: str, body: Geometry, rows: Rows, tolerance: float) -> Motion:
    """Nodes move about their mean in principal forms, as many as it takes to come near enough to every node."""
    count = rows.size
    where = placed(result, name, body, rows).reshape(count, -1)
    mean = where.mean(axis=0)
    away = where - mean
    _, directions = np.linalg.eigh(away.T @ away)
    principal, missed = directions[:, ::-1], away
    number = 0
    while number < principal.shape[1] and _farthest(missed) > _SHARE * tolerance:
        form = principal[:, number : number + 1]
        missed = missed - (missed @ form) @ form.T
        number += 1
    forms = principal[:, :number]
    still = np.zeros((count, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    shapes = forms.reshape(len(forms) // 3, 3, number)
    return _scaled(
        Motion(result.time[rows], mean.reshape(-1, 3), shapes, *still, away @ forms, _farthest(missed))
    )


def _farthest(flat: Vector) -> float:
    """Largest length of vectors (N, 3 D)."""
    return float(np.linalg.norm(flat.reshape(-1, 3), axis=1).max(initial=0.0))


def _scaled(found: Motion) -> Motion:
    """The same with amplitudes of at most 1."""
    scale = scales_of(found.amplitudes)
    return Motion(
        found.time, found.nodes, found.forms * scale, found.position, found.orientation, found.amplitudes / scale,
        found.missed,
    )  # fmt: skip


def from_least(found: Motion) -> Motion:
    """The same motion with amplitudes from 0 to 1, as Blender and others clip weights: nodes are at the least ones."""
    least, span = found.amplitudes.min(axis=0), np.ptp(found.amplitudes, axis=0)
    scale = np.where(span > 0.0, span, 1.0)
    return replace(
        found,
        nodes=found.nodes + found.forms @ least,
        forms=found.forms * scale,
        amplitudes=(found.amplitudes - least) / scale,
    )


def scales_of(amplitudes: Vector) -> Vector:
    """Largest magnitude of each amplitude (M,) over all rows (N, M); 1 where it is zero."""
    largest = np.abs(amplitudes).max(axis=0, initial=0.0)
    found: Vector = np.where(largest > 0.0, largest, 1.0)
    return found


def _continuous(orientation: Vector) -> Vector:
    """Unit quaternions (N, 4), each of the two signs nearer to the one before."""
    with np.errstate(invalid="ignore"):
        unit = orientation / np.linalg.norm(orientation, axis=1, keepdims=True)
    turned = np.sum(unit[1:] * unit[:-1], axis=1) < 0.0
    sign = np.where(np.cumsum(np.concatenate([[False], turned])) % 2, -1.0, 1.0)
    found: Vector = sign[:, None] * unit
    return found


def _slerp(first: Vector, last: Vector, share: Vector) -> Vector:
    """Quaternions (n, 4) at shares (n, 1) of the shorter way between two (4,) (Shoemake 1985)."""
    cosine = float(first @ last)
    last, cosine = (-last, -cosine) if cosine < 0.0 else (last, cosine)
    angle = np.arctan2(np.linalg.norm(last - cosine * first), cosine)
    if angle < 1e-8:  # the straight line, which the arc is in every digit
        mixed = first + share * (last - first)
    else:
        mixed = (np.sin((1.0 - share) * angle) * first + np.sin(share * angle) * last) / np.sin(angle)
    found: Vector = mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
    return found


def keys(found: Motion, tolerance: float) -> Rows:
    """Rows that suffice: between them no node is, at any row, off by more than a tolerance (m)."""
    left_over = tolerance - (found.missed or 0.0)
    return sufficient(found.time.size, lambda left, right: _worst(found, left, right), left_over)


def _worst(found: Motion, left: int, right: int) -> tuple[int, float]:
    """The row between two that is farthest off, and by how much (m)."""
    worst, largest = left, 0.0
    at_once = max(1, _AT_ONCE // max(found.nodes.size, 1))
    for first in range(left + 1, right, at_once):
        rows = np.arange(first, min(first + at_once, right))
        played = found.between(left, right, found.time[rows])
        off = np.linalg.norm(played - found.at(rows), axis=2).max(axis=1)
        k = int(np.argmax(off))
        if off[k] > largest:
            worst, largest = int(rows[k]), float(off[k])
    return worst, largest
