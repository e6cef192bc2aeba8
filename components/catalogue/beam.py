"""Beams as they are written down: an axis without load, a section, and points along the axis; at any fidelity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np

from ..beam_parts.elements import Elements, Poses
from ..beam_parts.linear_model import linear_model
from ..beam_parts.rest_shape import Arc, Curve, section_orientations
from ..beam_parts.variables import Section
from ..contract.component import ComponentError, Vector
from ..contract.frames import Quaternion, rotation_matrix
from ..flexible.finite_elements import FiniteElementModel

_FINE = 120
"""Elements of linear models at the least, which are reduced: they hold the first bending, free, to 0.02 %."""
_TOGETHER = 1e-6
"""Of the length: points closer than this are one place."""


@dataclass(frozen=True)
class BeamBody:
    """A beam along an arc or curve, its points by their distance (m) from the start.

    elements: of the beam for large deformation, shared out between points. section_z: direction that the z axis of the
    first section is near to.
    """

    axis: Arc | Curve
    section: Section
    elements: int
    points: tuple[tuple[str, float], ...]
    section_z: tuple[float, ...] = (0.0, 0.0, 1.0)

    def problems(self) -> list[str]:
        """What no beam can be made of, as sentences with their keys."""
        length = self.axis.length
        found = [
            f"attachment_points.{name}: is {at:g} m from the start of a beam of {length:g} m"
            for name, at in self.points
            if not -_TOGETHER * length <= at <= (1.0 + _TOGETHER) * length
        ]
        ordered = sorted(self.points, key=lambda point: point[1])
        found += [
            f"attachment_points: {a} and {b} are at one place; connections may share a point"
            for (a, first), (b, second) in pairwise(ordered)
            if second - first <= _TOGETHER * length
        ]
        stretches = len(self._stops) - 1
        if not found and self.elements < stretches:
            found.append(
                f"elements: is {self.elements}; its points divide the beam into {stretches} stretches, which "
                "need one each"
            )
        if not found:
            try:
                self._check_turns()
            except ComponentError as error:
                found.append(str(error))
        return found

    def _check_turns(self) -> None:
        positions, orientations = self._sections()
        directors = np.array([rotation_matrix(turn) for turn in orientations])
        Elements(Poses(directors, np.diff(positions, axis=0)), self.section.stiffness)

    @property
    def _stops(self) -> Vector:
        """Distances of both ends and all points, in order, each once."""
        length = self.axis.length
        every = np.unique(np.clip([0.0, length, *(at for _, at in self.points)], 0.0, length))
        apart: Vector = every[np.append(True, np.diff(every) > _TOGETHER * length)]
        return apart

    def _distances(self, parts: int) -> Vector:
        """Of the nodes from the start, m; parts: into which every element is divided."""
        stops = self._stops
        lengths = np.diff(stops)
        counts = np.ones(len(lengths), dtype=np.int64)
        for _ in range(self.elements - len(lengths)):
            counts[np.argmax(lengths / counts)] += 1
        runs = [
            np.linspace(a, b, parts * count, endpoint=False)
            for a, b, count in zip(stops[:-1], stops[1:], counts, strict=True)
        ]
        return np.append(np.concatenate(runs), stops[-1])

    def _sections(self, parts: int = 1) -> tuple[Vector, list[Quaternion]]:
        """Positions (n, 3) of the nodes and quaternions of the sections there."""
        positions, tangents = self.axis.at(self._distances(parts))
        return positions, section_orientations(tangents, self.section_z)

    def _node_of(self, parts: int) -> dict[str, int]:
        distances = self._distances(parts)
        return {name: int(np.argmin(np.abs(distances - at))) for name, at in self.points}

    def nodes(self) -> list[Mapping[str, Any]]:
        """Nodes of the component `beam`."""
        positions, orientations = self._sections()
        return [
            {"position": tuple(place), "orientation": turn}
            for place, turn in zip(positions.tolist(), orientations, strict=True)
        ]

    @property
    def point_nodes(self) -> dict[str, int]:
        """Numbers of the nodes at the points."""
        return self._node_of(1)

    def model(self, points: Sequence[str]) -> FiniteElementModel:
        """Finite elements in small motion, with these points."""
        parts = ceil(_FINE / self.elements)
        positions, orientations = self._sections(parts)
        directors = np.array([rotation_matrix(turn) for turn in orientations])
        nodes = self._node_of(parts)
        return linear_model(positions, directors, self.section, {name: nodes[name] for name in points})
