"""Where the theory of a plate that bending stretches ends: slopes beyond a tenth, and tension that is none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from components.contract.component import Vector

from .model import AT_INSERT, BodyStress

LARGEST_SLOPE = 0.1
"""Beyond it w,x^2 / 2 is not the strain that a slope makes: its next order is a quarter of its square."""
_SLIGHT = 1e-3  # of the largest tension: less wrinkles nothing
_AT_ONCE = 4_000_000  # values held at once, 32 MB


@dataclass(frozen=True)
class Extreme:
    """Largest slope (1) or largest compression (Pa) over a run, and where and when."""

    value: float
    position: tuple[float, float]
    """construction frame, m"""
    time: float
    """s"""

    def __str__(self) -> str:
        x, y = self.position
        return f"at x = {x:.3f} m, y = {y:.3f} m, {self.time:.5g} s"


@dataclass(frozen=True)
class Stretching:
    """Of a plate whose bending stretches it, at the nodes of a recovery."""

    slope: Extreme
    compression: Extreme

    def sentences(self, body: str) -> Iterator[str]:
        """Warnings about the stresses."""
        if self.slope.value > LARGEST_SLOPE:
            yield (
                f"{body}: slopes reach {self.slope.value:.2g} {self.slope}, beyond the limit of {LARGEST_SLOPE} of von"
                " Karman's geometry, so stresses and deflections are inaccurate there"
            )
        if self.compression.value > 0.0:
            yield (
                f"{body}: its mid-plane is most compressed {self.compression}, by"
                f" {self.compression.value / 1e6:.3g} MPa; a membrane would wrinkle there, unlike this model"
            )


def left_out(body: str, stress: BodyStress, stretched: Stretching | None) -> Iterator[str]:
    """Sentences on what the stresses omit."""
    if stretched is not None:
        yield from stretched.sentences(body)
    if stress.prestress:
        yield f"{body}: stresses do not include its tension at rest, {stress.prestress:.4g} Pa"


def stretching(stress: BodyStress, time: Vector) -> Stretching | None:
    """At the nodes of a recovery and at times (N,) s; compression at those that are on no rigid insert's edge.

    None where bending does not stretch the plate.
    """
    if stress.slopes is None:
        return None
    recovery, count = stress.recovery, len(stress.recovery.nodes)
    edge = stress.plate.insert_distance()[recovery.nodes] <= AT_INSERT
    found: list[tuple[float, int, int]] = [(-np.inf, 0, 0), (-np.inf, 0, 0)]
    largest = 0.0
    rows = max(1, _AT_ONCE // (6 * count))
    for start in range(0, len(stress.coordinates), rows):
        part = stress.coordinates[start : start + rows]
        turned = (part[:, : stress.slopes.shape[1]] @ stress.slopes.T).reshape(len(part), count, 2)
        sx, sy, shear = np.moveaxis(recovery.stress(part).mean(axis=2), -1, 0)
        pressed = np.hypot(0.5 * (sx - sy), shear) - 0.5 * (sx + sy) - stress.prestress
        largest = max(largest, float(np.abs(pressed).max()))
        pressed[:, edge] = -np.inf
        for k, field in enumerate((np.hypot(turned[..., 0], turned[..., 1]), pressed)):
            row, node = np.unravel_index(np.argmax(field), field.shape)
            found[k] = max(found[k], (float(field[row, node]), int(row) + start, int(node)))
    slope, compression = (_extreme(one, recovery.positions, time) for one in found)
    if compression.value < _SLIGHT * largest:
        compression = replace(compression, value=0.0)
    return Stretching(slope, compression)


def _extreme(found: tuple[float, int, int], positions: Vector, time: Vector) -> Extreme:
    value, row, node = found
    return Extreme(value, (float(positions[node, 0]), float(positions[node, 1])), float(time[row]))
