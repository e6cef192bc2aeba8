"""A clamped square plate of von Karman's geometry by Galerkin's method with polynomials over the whole plate.

Nothing of it is shared with the finite elements of `components.flexible`. Functions are symmetric about both middle
lines, the motion in the plane is condensed statically (Timoshenko and Woinowsky-Krieger, section 101).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre, leggauss
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import root

Vector = NDArray[np.float64]
_POINTS = 24


def _functions(count: int, border: int, first: int) -> list[Vector]:
    """Values and two derivatives (3, points) of (1 - x^2)^border times Legendre polynomials first, first + 2, ..."""
    x, _ = leggauss(_POINTS)
    wall = Polynomial([1.0, 0.0, -1.0]) ** border
    found = []
    for k in range(count):
        function = wall * Legendre.basis(first + 2 * k).convert(kind=Polynomial)
        found.append(np.array([function.deriv(order)(x) if order else function(x) for order in range(3)]))
    return found


class ClampedPlate:
    """Of a side, bending stiffness, stiffness in tension, Poisson's ratio and areal mass, in SI units.

    `modes` lowest symmetric modes, of `count` functions along each side.
    """

    def __init__(
        self,
        side: float,
        bending: float,
        tension: float,
        ratio: float,
        areal_mass: float,
        modes: int,
        count: int = 8,
    ) -> None:
        _, weight = leggauss(_POINTS)
        scale = 2.0 / side
        area = np.kron(weight, weight) / scale**2
        plane = np.array([[1.0, ratio, 0.0], [ratio, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - ratio)]])
        even = _functions(count, 2, 0)
        pairs = [(f, g) for f in even for g in even]

        def values(i: int, j: int) -> Vector:
            return np.array([np.kron(f[i], g[j]) for f, g in pairs]) * scale ** (i + j)

        w = values(0, 0)
        curvature = np.array([values(2, 0), values(0, 2), 2.0 * values(1, 1)])
        stiffness = bending * np.einsum("aiq,ab,bjq,q->ij", curvature, plane, curvature, area, optimize=True)
        mass = areal_mass * (w * area) @ w.T
        square, vectors = eigh(stiffness, mass)
        shapes = vectors[:, :modes].T
        self.frequency = np.sqrt(square[:modes])
        self.load = shapes @ (w @ area)
        middle = np.array([f[0] for f in _middle(count)])
        self.middle = shapes @ np.outer(middle, middle).ravel()
        slopes = (shapes @ values(1, 0), shapes @ values(0, 1))
        first, second = np.triu_indices(modes)
        strain = np.array(
            [
                slopes[0][first] * slopes[0][second],
                slopes[1][first] * slopes[1][second],
                slopes[0][first] * slopes[1][second] + slopes[1][first] * slopes[0][second],
            ]
        )
        odd, still = _functions(count, 1, 1), _functions(count, 1, 0)
        u = [(f, g) for f in odd for g in still]
        e_u = np.array(
            [
                [np.kron(f[1], g[0]) for f, g in u],
                np.zeros((len(u), _POINTS**2)),
                [np.kron(f[0], g[1]) for f, g in u],
            ]
        )
        e_v = np.array(
            [
                np.zeros((len(u), _POINTS**2)),
                [np.kron(g[0], f[1]) for f, g in u],
                [np.kron(g[1], f[0]) for f, g in u],
            ]
        )
        in_plane = scale * np.concatenate((e_u, e_v), axis=1)
        elasticity = tension * plane

        def work(one: Vector, other: Vector) -> Vector:
            found: Vector = np.einsum("aiq,ab,bjq,q->ij", one, elasticity, other, area, optimize=True)
            return found

        held = work(in_plane, strain)
        self._stiffness = work(strain, strain) - held.T @ np.linalg.solve(work(in_plane, in_plane), held)
        self._first, self._second = first, second
        self._times = np.where(first == second, 0.5, 1.0)

    def force(self, eta: Vector) -> Vector:
        """What holds the modes at coordinates (M,), N m^-1/2 kg^-1/2."""
        one, other = eta[self._first], eta[self._second]
        tension = self._times * (self._stiffness @ (self._times * one * other))
        found = self.frequency**2 * eta
        np.add.at(found, self._first, tension * other)
        np.add.at(found, self._second, tension * one)
        return found

    def deflection(self, pressure: float) -> float:
        """Of the middle (m) under a pressure (Pa)."""
        eta = np.zeros(self.frequency.size)
        for share in np.linspace(0.1, 1.0, 10) ** 3:
            eta = root(lambda e, p=share * pressure: self.force(e) - p * self.load, eta, tol=1e-12).x
        return float(self.middle @ eta)

    def vibration(self, pressure: Callable[[float], float], damping: float, times: Vector) -> Vector:
        """Of the middle (m) at ascending times from rest at 0 s, under a pressure (Pa) that changes."""
        m = self.frequency.size

        def rates(t: float, state: Vector) -> Vector:
            eta, rate = state[:m], state[m:]
            return np.concatenate(
                (rate, pressure(t) * self.load - self.force(eta) - 2.0 * damping * self.frequency * rate)
            )

        start = np.zeros(2 * m)
        found = solve_ivp(rates, (0.0, times[-1]), start, "DOP853", times, rtol=1e-8, atol=1e-10)
        result: Vector = self.middle @ found.y[:m]
        return result


def _middle(count: int) -> list[Vector]:
    """Values of the functions of the deflection in the middle of a side."""
    found = []
    for k in range(count):
        found.append(np.array([Legendre.basis(2 * k)(0.0)]))
    return found
