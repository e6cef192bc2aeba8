"""Structural damping in a scene file: in proportion to stiffness, its ratio stated at a reference frequency."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .table import Table
from .units import PositiveFrequency, Ratio, damping_time

_LOWEST = 1e-3
"""Hz; below it modes pass for free motions."""


class StructuralDamping(Table):
    """Kelvin-Voigt damping C = time K: what a mode of frequency f gets is ratio f / reference_frequency.

    [structural_damping]: of the whole wing. Every flexible body that says nothing else, the stiffnesses of all
    hinges in place of [joint]'s ratio, and latch springs in place of their own: then C is proportional to K over
    the assembly, and so every assembled mode j gets exactly ratio f_j / reference_frequency. Joints
    by a preset follow; cables, motors, dampers and every other [[connection]] keep their own damping.
    """

    ratio: Annotated[Ratio, Field(le=1.0)]
    """Damping ratio, of critical, at the reference frequency; half the loss factor."""
    reference_frequency: Annotated[PositiveFrequency, Field(ge=_LOWEST)]
    """Frequency at which the ratio holds; a mode gets it in proportion to its own."""

    @property
    def time(self) -> float:
        """Damping over stiffness, s."""
        return damping_time(self.ratio, self.reference_frequency)
