"""Sections of homogeneous beams: stiffness and inertia from shape, moduli and density.

Torsion of a rectangle: Saint-Venant's series. Shear: 5/6 of a rectangle's area, of round sections Cowper's factor
(Journal of Applied Mechanics 33, 1966), or the one that is given.
"""

from __future__ import annotations

from math import pi, tanh
from typing import NamedTuple

from .variables import Section

_TERMS = 9
"""Of the series of torsion; the first that is left out is 19^-5 of the first."""
_RECTANGLE = 5.0 / 6.0


class Material(NamedTuple):
    """Young's and shear modulus (Pa), density (kg/m3)."""

    youngs_modulus: float
    shear_modulus: float
    density: float


def rectangle(width: float, height: float, material: Material, shear_factor: float | None = None) -> Section:
    """A rectangle, width (m) along the section's y axis and height (m) along z."""
    about_y, about_z = width * height**3 / 12.0, height * width**3 / 12.0
    moments = about_y, about_z, _torsion_constant(width, height)
    return _homogeneous(width * height, moments, material, shear_factor or _RECTANGLE)


def round_section(
    diameter: float, bore: float, material: Material, shear_factor: float | None = None
) -> Section:
    """A circle, or a tube where there is a bore (m)."""
    moment = pi / 64.0 * (diameter**4 - bore**4)
    factor = shear_factor or _cowper(bore / diameter, material)
    return _homogeneous(pi / 4.0 * (diameter**2 - bore**2), (moment, moment, 2.0 * moment), material, factor)


def _homogeneous(
    area: float, moments: tuple[float, float, float], material: Material, shear_factor: float
) -> Section:
    """moments: second ones about y and z, and the torsion constant (m4)."""
    about_y, about_z, torsion = moments
    e, g, density = material
    shear = shear_factor * g * area
    return Section(
        axial=e * area,
        shear_y=shear,
        shear_z=shear,
        torsion=g * torsion,
        bending_y=e * about_y,
        bending_z=e * about_z,
        line_mass=density * area,
        inertia_x=density * (about_y + about_z),
        inertia_y=density * about_y,
        inertia_z=density * about_z,
    )


def _torsion_constant(width: float, height: float) -> float:
    """Of a rectangle, m4."""
    a, b = max(width, height), min(width, height)
    odd = range(1, 2 * _TERMS, 2)
    series = sum(tanh(0.5 * n * pi * a / b) / n**5 for n in odd)
    return a * b**3 * (1.0 - 192.0 / pi**5 * b / a * series) / 3.0


def _cowper(hollow: float, material: Material) -> float:
    """Shear factor of a ring; hollow: ratio of the diameters."""
    ratio = 0.5 * material.youngs_modulus / material.shear_modulus - 1.0
    square, m = (1.0 + hollow**2) ** 2, hollow**2
    return 6.0 * (1.0 + ratio) * square / ((7.0 + 6.0 * ratio) * square + (20.0 + 12.0 * ratio) * m)
