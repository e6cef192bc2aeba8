"""Stiffness of a laminated plate by classical lamination theory (Jones 1999, chapter 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..contract.component import Vector

_NEGLIGIBLE = 1e-3
"""Share of a stiffness that coupling with another motion takes away: half of it is what a frequency is off by."""
Stiffness = tuple[float, float, float, float]


@dataclass(frozen=True)
class Layer:
    """An orthotropic layer in plane stress."""

    thickness: float
    """m"""
    youngs_modulus: float
    """along its fibres, Pa"""
    transverse_modulus: float
    """across them, Pa"""
    poisson_ratio: float
    """strain across per strain along them under tension along them"""
    shear_modulus: float
    """Pa"""
    angle: float = 0.0
    """from x to the fibres, rad"""

    def stiffness(self) -> Vector:
        """Plane-stress stiffness (3, 3) in the axes of the plate, Pa."""
        minor = self.poisson_ratio * self.transverse_modulus / self.youngs_modulus
        scale = 1.0 - self.poisson_ratio * minor
        own = np.array(
            [
                [self.youngs_modulus / scale, minor * self.youngs_modulus / scale, 0.0],
                [minor * self.youngs_modulus / scale, self.transverse_modulus / scale, 0.0],
                [0.0, 0.0, self.shear_modulus],
            ]
        )
        c, s = np.cos(self.angle), np.sin(self.angle)
        # strains in the layer's axes from those in the plate's, shear as the whole angle
        turn = np.array(
            [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
        )
        result: Vector = turn.T @ own @ turn
        return result


def laminate_stiffness(layers: Sequence[Layer]) -> tuple[Stiffness, Stiffness, str]:
    """Bending (N m) and membrane (N/m) stiffness 11, 22, 12, 66 of layers from bottom to top about the middle.

    The third is a sentence where the plate would couple stretching with bending, or shear with either, which an
    orthotropic plate does not; it is empty otherwise.
    """
    heights = np.cumsum([0.0, *(layer.thickness for layer in layers)])
    heights -= 0.5 * heights[-1]
    membrane, coupling, bending = (
        sum(
            (
                layer.stiffness() * (b**k - a**k) / k
                for layer, a, b in zip(layers, heights, heights[1:], strict=False)
            ),
            np.zeros((3, 3)),
        )
        for k in (1, 2, 3)
    )
    problem = ""
    if (coupling**2 / np.outer(membrane.diagonal(), bending.diagonal())).max() > _NEGLIGIBLE:
        problem = (
            "the layers are not symmetric about the middle, so the plate would bend when it is stretched"
        )
    elif _taken_by_shear(membrane) > _NEGLIGIBLE:
        problem = (
            "the layers are not balanced, so the plate would shear when it is stretched; for every layer at an angle "
            "give one at the opposite angle"
        )
    elif _taken_by_shear(bending) > _NEGLIGIBLE:
        known = ", ".join(f"{value:.4g}" for value in _orthotropic(bending))
        problem = (
            "layers at opposite angles lie at different heights, so the plate would twist when it is bent; write a "
            f"fabric as one layer, or leave that out by a table stiffness in place of layers, with bending [{known}]"
        )
    return _orthotropic(bending), _orthotropic(membrane), problem


def _taken_by_shear(stiffness: Vector) -> float:
    """Largest share of the stiffness 11 or 22 that coupling with 66 takes away."""
    along = stiffness.diagonal()
    return float((stiffness[:2, 2] ** 2 / (along[:2] * along[2])).max())


def _orthotropic(stiffness: Vector) -> Stiffness:
    return float(stiffness[0, 0]), float(stiffness[1, 1]), float(stiffness[0, 1]), float(stiffness[2, 2])
