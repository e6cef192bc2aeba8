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


def _functions(count: int, border: int, first: int, x: Vector) -> list[Vector]:
    """Values and two derivatives (3, points) of (1 - x^2)^border times Legendre polynomials first, first + 2, ..."""
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
        points, weight = leggauss(_POINTS)
        middle = np.zeros(1)
        scale = 2.0 / side
        area = np.kron(weight, weight) / scale**2
        plane = np.array([[1.0, ratio, 0.0], [ratio, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - ratio)]])
        even = _functions(count, 2, 0, points)
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
        top = np.array([f[0, 0] for f in _functions(count, 2, 0, middle)])
        self.middle = shapes @ np.outer(top, top).ravel()
        slopes = (shapes @ values(1, 0), shapes @ values(0, 1))
        first, second = np.triu_indices(modes)
        strain = np.array(
            [
                slopes[0][first] * slopes[0][second],
                slopes[1][first] * slopes[1][second],
                slopes[0][first] * slopes[1][second] + slopes[1][first] * slopes[0][second],
            ]
        )
        in_plane = scale * _in_plane(count, points)
        elasticity = tension * plane

        def work(one: Vector, other: Vector) -> Vector:
            found: Vector = np.einsum("aiq,ab,bjq,q->ij", one, elasticity, other, area, optimize=True)
            return found

        held = work(in_plane, strain)
        response = np.linalg.solve(work(in_plane, in_plane), held)
        self._stiffness = work(strain, strain) - held.T @ response
        # where nothing slopes
        self._middle_tension = -tension * plane[0] @ (scale * _in_plane(count, middle)[:, :, 0]) @ response
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
        return float(self.middle @ self._held(pressure))

    def tension(self, pressure: float) -> float:
        """In the middle, in all directions of the plane (N/m), under a pressure (Pa)."""
        eta = self._held(pressure)
        return float(self._middle_tension @ (self._times * eta[self._first] * eta[self._second]))

    def _held(self, pressure: float) -> Vector:
        """Coordinates of the modes (M,) in equilibrium with a pressure (Pa)."""
        eta = np.zeros(self.frequency.size)
        for share in np.linspace(0.1, 1.0, 10) ** 3:
            eta = root(lambda e, p=share * pressure: self.force(e) - p * self.load, eta, tol=1e-12).x
        return eta

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


def _in_plane(count: int, x: Vector) -> Vector:
    """Strains (3, functions, points) of motion in the plane, along one side and along the other, at pairs of places."""
    odd, even = _functions(count, 1, 1, x), _functions(count, 1, 0, x)
    pairs = [(f, g) for f in odd for g in even]
    none = np.zeros((len(pairs), x.size**2))
    along = [[np.kron(f[1], g[0]) for f, g in pairs], none, [np.kron(f[0], g[1]) for f, g in pairs]]
    across = [none, [np.kron(g[0], f[1]) for f, g in pairs], [np.kron(g[1], f[0]) for f, g in pairs]]
    return np.concatenate((np.array(along), np.array(across)), axis=1)
