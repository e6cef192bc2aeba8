"""How a body's inertia varies with its deformation: the nine inertia invariants, evaluated in one product.

    J(eta) = I7 - (I8_j + I8_j^T) eta_j - I9_jk eta_j eta_k        B(eta) = I5_j eta_j

(Bagnoli 2007, Table 1-1 and equation 1.36, with the sign of I5 that its definitions give; I3 = I4 = 0.)
Symmetric matrices are held as (xx, yy, zz, xy, xz, yz).
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..contract.component import ComponentError, Vector
from ..flexible.modal import ModalData

CouplingLevel = Literal["rigid", "constant", "partial", "full"]

# what is left, from a reduction, of the interactions that a body's symmetry forbids
_ROUNDING = 1e-10

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class Coupling(NamedTuple):
    """At modal coordinates: B (3, M), J - B B^T (6,), and half the slope of J's quadratic part (6, M)."""

    b: Vector
    inertia: Vector
    quadratic: Vector


class InertiaCoupling:
    """The invariants that a coupling level keeps, laid out for one matrix product per evaluation.

    "rigid" and "constant" keep the undeformed inertia (they coincide for mean axes), "partial" drops I5
    and I9, "full" keeps all.
    """

    def __init__(self, data: ModalData, level: CouplingLevel) -> None:
        if level not in ("rigid", "constant", "partial", "full"):
            raise ComponentError(
                f"inertia_coupling is {level!r}; it must be rigid, constant, partial or full"
            )
        m = self._modes = data.frequency.size
        self.full = m > 0 and level == "full"
        self.varies = m > 0 and level in ("partial", "full")
        self.inverse = np.linalg.inv(data.inertia)
        self._inertia = np.array([data.inertia[i, j] for i, j in _PAIRS])
        i8 = data.invariant8 + data.invariant8.transpose(0, 2, 1)
        self._slope = np.array([i8[:, i, j] for i, j in _PAIRS])
        self._none = Coupling(np.zeros((3, m)), self._inertia, np.zeros((6, m)))
        self._tensors = np.zeros((0, m))
        if not self.full:
            return
        i9 = data.invariant9 + data.invariant9.transpose(0, 1, 3, 2)
        i9 = 0.25 * (i9 + i9.transpose(1, 0, 2, 3))
        quadratic = np.array([i9[:, :, i, j] for i, j in _PAIRS]).reshape(6 * m, m)
        i5 = 0.5 * (data.invariant5 - data.invariant5.transpose(2, 1, 0))
        tensors = np.vstack([quadratic, i5.transpose(1, 2, 0).reshape(3 * m, m)])
        tensors[abs(tensors) < _ROUNDING * abs(tensors).max()] = 0.0
        self._tensors, self._gyroscopic = tensors, tensors[6 * m :]

    def native_data(self) -> dict[str, ArrayLike]:
        """What the kernel of `fmus/native/shared/inertia.h` reads; of the tensors, the triangles."""
        return {
            "inertia_varies": self.varies,
            "full_coupling": self.full,
            "inertia": self._inertia,
            "inverse_inertia": self.inverse,
            "slope": self._slope,
            "tensors": self._tensors,
        }

    def at(self, eta: Vector) -> Coupling:
        """Coupling at modal coordinates (M,)."""
        if not self.varies:
            return self._none
        if not self.full:
            return self._none._replace(inertia=self._inertia - self._slope @ eta)
        m = self._modes
        products = self._tensors @ eta
        return self._of(products[6 * m :].reshape(3, m), products[: 6 * m].reshape(6, m), eta)

    def matrix(self, eta: Vector) -> Vector:
        """J (3, 3) at modal coordinates, body axes."""
        found = self.at(eta)
        return full_matrix(found.inertia) + found.b @ found.b.T

    def slopes(self, eta: Vector) -> Vector:
        """Derivatives of J by the modal coordinates (3, 3, M)."""
        quadratic = self.at(eta).quadratic
        return full_matrix(-self._slope - 2.0 * quadratic if self.varies else quadratic)

    def curvature(self, omega: Vector) -> Vector:
        """Of -omega^T J omega / 2, second derivatives by the modal coordinates (M, M); omega in body axes."""
        m = self._modes
        if not self.full:
            return np.zeros((m, m))
        product = np.outer(omega, omega).ravel()[[0, 4, 8, 1, 2, 5]] * (1.0, 1.0, 1.0, 2.0, 2.0, 2.0)
        found: Vector = np.tensordot(product, self._tensors[: 6 * m].reshape(6, m, m), 1)
        return found

    def drag_rates(self, omega: Vector) -> Vector:
        """Derivatives of B^T omega by the modal coordinates (M, M), antisymmetric; omega in body axes."""
        m = self._modes
        found: Vector = (
            np.tensordot(omega, self._gyroscopic.reshape(3, m, m), 1) if self.full else np.zeros((m, m))
        )
        return found

    def mean(self, start: Coupling, end: Coupling, eta: Vector) -> Coupling:
        """Coupling at the mean of the modal coordinates of two others."""
        if not self.full:
            return self._none._replace(inertia=0.5 * (start.inertia + end.inertia))
        return self._of(0.5 * (start.b + end.b), 0.5 * (start.quadratic + end.quadratic), eta)

    def _of(self, b: Vector, quadratic: Vector, eta: Vector) -> Coupling:
        bb = (b @ b.T).ravel()[[0, 4, 8, 1, 2, 5]]
        return Coupling(b, self._inertia - (self._slope + quadratic) @ eta - bb, quadratic)

    def forces(self, mid: Coupling, start: Vector, end: Vector, bend: Vector, rate: Vector) -> Vector:
        """Forces (M,) on the modes over a step, quadratic in the velocities.

        mid: coupling at the mean modal coordinates; start, end: angular velocities (3,) at both ends, body axes;
        bend: what their mean is above the mean over the step; rate: mean modal rates (M,). Their work is what
        inertia that changes takes from the rotation.
        """
        if not self.varies:
            return np.zeros(self._modes)
        mean = 0.5 * (start + end)
        product = np.outer(start, end) - 2.0 * np.outer(bend, mean)
        product = (0.5 * (product + product.T)).ravel()[[0, 4, 8, 1, 2, 5]]
        product[3:] *= 2.0
        found: Vector = -0.5 * (product @ self._slope)
        if not self.full:
            return found
        found -= product @ mid.quadratic
        found -= (mean - bend) @ (self._gyroscopic @ rate).reshape(3, self._modes)
        return found

    def solve(self, coupling: Coupling, momentum: Vector) -> Vector:
        """Angular velocity (3,) of an angular momentum less its part in the modes, both in body axes."""
        return solve_symmetric(coupling.inertia, momentum) if self.varies else self.inverse @ momentum

    def modal_rate(self, omega: Vector, eta: Vector, pi: Vector) -> Vector:
        """Rates eta' = pi - B^T omega from modal momenta."""
        return pi - omega @ (self._gyroscopic @ eta).reshape(3, self._modes) if self.full else pi

    def angular_velocity(self, momentum: Vector, eta: Vector, pi: Vector) -> Vector:
        """Angular velocity (3,) from the angular momentum, both in body axes."""
        coupling = self.at(eta)
        return self.solve(coupling, momentum - coupling.b @ pi)


def full_matrix(entries: Vector) -> Vector:
    """Symmetric matrices (3, 3, ...) by their six entries (6, ...)."""
    return entries[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3, *entries.shape[1:])


def symmetric_product(entries: Vector, v: Vector) -> Vector:
    """A symmetric 3x3 matrix given by its six entries times a vector (3,)."""
    found: Vector = full_matrix(entries) @ v
    return found


def solve_symmetric(entries: Vector, right: Vector) -> Vector:
    """Solve a symmetric 3x3 system given by its six entries, by cofactors."""
    xx, yy, zz, xy, xz, yz = entries.tolist()
    r0, r1, r2 = right.tolist()
    c00, c01, c02 = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    scale = 1.0 / (xx * c00 + xy * c01 + xz * c02)
    c11, c12, c22 = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    return np.array(
        (
            scale * (c00 * r0 + c01 * r1 + c02 * r2),
            scale * (c01 * r0 + c11 * r1 + c12 * r2),
            scale * (c02 * r0 + c12 * r1 + c22 * r2),
        )
    )
