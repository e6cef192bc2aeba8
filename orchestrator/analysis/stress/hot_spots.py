"""Stresses of a panel over a run: hot spots, the peak von Mises field, histories of the hottest nodes.

Modal coordinates times the stresses of the modes, plus a static correction for inertia: what the modes lack
under the acceleration field of the body's frame. Peaks are those at the recorded times.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from components.flexible.finite_elements import PlateNodes
from components.flexible.stress import FACES, Indices, PeakStress, hot_spots, nodes_around, nodes_in_rectangle

from ...records import short_repr
from ...results.result import Result, ResultError
from .model import AT_INSERT, BodyStress, body_stress
from .stretching import Stretching, left_out, stretching


@dataclass(frozen=True)
class HotSpot:
    """A node where the von Mises stress of the larger face peaks."""

    stress: float
    """Pa"""
    node: int
    face: str
    time: float
    """s"""
    position: tuple[float, float]
    """construction frame, m"""
    at_insert: bool
    """on the edge of a rigid insert, where the value depends on the mesh"""

    def row(self, rank: int) -> tuple[str, ...]:
        """Texts in the order of the table's columns."""
        x, y = (f"{v:.4f}" for v in self.position)
        note = "yes" if self.at_insert else ""
        return (
            f"{rank}", f"{self.stress / 1e6:.4f}", f"{self.node}", self.face, f"{self.time:.5f}", x, y, note
        )  # fmt: skip


@dataclass(frozen=True)
class Choice:
    """Which nodes of the plate are asked for; what is not given excludes nothing. Lengths in m."""

    nodes: tuple[int, ...] | None = None
    within: tuple[float, float, float, float] | None = None
    """smallest and largest x, smallest and largest y"""
    around: tuple[float, float, float] | None = None
    """x, y, radius"""
    insert_margin: float = 0.0
    """nodes closer to a rigid insert are left out; those on its edge stay at 0"""

    def __post_init__(self) -> None:
        if self.within is not None and (self.within[0] > self.within[1] or self.within[2] > self.within[3]):
            raise ResultError(
                f"the rectangle is {self.within}; give x0, x1, y0, y1 with x0 <= x1 and y0 <= y1"
            )
        if self.around is not None and self.around[2] < 0.0:
            raise ResultError(f"the radius of the circle is {self.around[2]:g} m; it must not be negative")

    def __call__(self, plate: PlateNodes) -> Indices:
        """Numbers of the nodes."""
        found = np.arange(len(plate.positions)) if self.nodes is None else np.unique(self.nodes)
        if self.within is not None:
            x0, x1, y0, y1 = self.within
            found = np.intersect1d(found, nodes_in_rectangle(plate.positions, (x0, x1), (y0, y1)))
        if self.around is not None:
            x, y, radius = self.around
            found = np.intersect1d(found, nodes_around(plate.positions, (x, y), radius))
        if self.insert_margin > 0.0:
            clear = plate.insert_distance() >= self.insert_margin - AT_INSERT
            found = np.intersect1d(found, np.flatnonzero(clear))
        return found


@short_repr
@dataclass(frozen=True)
class PanelStress:
    """Von Mises stresses of a panel over a run: hot spots, falling, and the peak of the larger face at every node."""

    body: str
    hot_spots: tuple[HotSpot, ...]
    radius: float
    """m; nodes this near to a hot spot are no further one"""
    peak: PeakStress = field(repr=False)
    places: Indices = field(repr=False)
    """of the hot spots among the nodes of the recovery"""
    stress: BodyStress = field(repr=False)
    result: Result = field(repr=False)
    stretching: Stretching | None = None
    """of a plate whose bending stretches it"""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What these stresses do not hold, as sentences."""
        return tuple(left_out(self.body, self.stress, self.stretching))


def panel_stress(result: Result, body: str, choice: Choice, radius: float, count: int) -> PanelStress:
    """Stresses at the chosen nodes of a flexible panel; ResultError where the result does not allow it."""
    stress = body_stress(result, body, choice)
    peak = stress.recovery.peak(stress.coordinates)
    if not np.all(np.isfinite(peak.value)):
        raise ResultError(
            f"{result.name}: {body}: the modal coordinates are not finite; the run was unstable"
        )
    places, spots = find_hot_spots(result, stress, peak, radius, count)
    stretched = stretching(stress, result.time)
    return PanelStress(body, tuple(spots), radius, peak, places, stress, result, stretched)


def find_hot_spots(
    result: Result, stress: BodyStress, peak: PeakStress, radius: float, count: int
) -> tuple[Indices, list[HotSpot]]:
    """Hot spots, falling, and their places among the nodes of the recovery."""
    recovery = stress.recovery
    places = hot_spots(peak.value, recovery.positions, radius, count)
    distance = stress.plate.insert_distance()[recovery.nodes]
    spots = [
        HotSpot(
            stress=float(peak.value[k]),
            node=int(recovery.nodes[k]),
            face=FACES[peak.face[k]],
            time=float(result.time[peak.row[k]]),
            position=(float(recovery.positions[k, 0]), float(recovery.positions[k, 1])),
            at_insert=bool(distance[k] <= AT_INSERT),
        )
        for k in places
    ]
    return places, spots
