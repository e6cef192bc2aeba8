"""Linear model of an assembly about a configuration at rest: M q'' + (C + G) q' + K q = f, and its normal modes.

At rest in axes that may turn: then K has what the spin stiffens and softens, and G is what rates do there.

Exact derivatives of bodies and of preloaded connections; friction is left out, latches that lock are their lock
(`connection_at_rest`), inertia is that of undeformed bodies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from components.contract.component import Vector

from ...scene.table import SceneError
from ..dense import generalized_modes, null_space
from . import ZERO_FREQUENCY
from .mechanism import Mechanism

Rows = NDArray[np.int64]
_SHIFT = (2.0 * np.pi * 1.0) ** 2
_LARGEST_SHIFT = 1e12


@dataclass(frozen=True)
class LinearModel:
    """Matrices (n, n) over the coordinates of all bodies of a mechanism, its base included."""

    mechanism: Mechanism
    mass: Vector
    damping: Vector
    gyroscopic: Vector
    stiffness: Vector
    residual: Vector
    """(n,) generalised forces that nothing balances in this configuration"""

    @property
    def is_grounded(self) -> bool:
        """Whether the base is ground, which has no mass and does not move."""
        base = self.mechanism.bodies.get(self.mechanism.base)
        return base is not None and base.is_led

    @property
    def base_rows(self) -> Rows:
        """Numbers of the six rigid coordinates of the base."""
        start = self.mechanism.rows[self.mechanism.base].start
        return np.arange(start, start + 6)

    @property
    def free_rows(self) -> Rows:
        """Numbers of the coordinates that move."""
        moving = np.setdiff1d(np.arange(len(self.mass)), self._led_rows)
        return self.other_rows if self.is_grounded else moving

    @property
    def other_rows(self) -> Rows:
        """Numbers of all coordinates that are neither rigid ones of the base nor led by a law."""
        return np.setdiff1d(np.arange(len(self.mass)), [*self.base_rows, *self._led_rows])

    @property
    def _led_rows(self) -> list[int]:
        """Numbers of the coordinates of bodies that follow a prescribed motion, beside the base."""
        led = [name for name, body in self.mechanism.bodies.items() if body.is_led]
        rows = [self.mechanism.rows[name] for name in led if name != self.mechanism.base]
        return [number for one in rows for number in range(one.start, one.stop)]

    @property
    def base_constraints(self) -> Vector:
        """(6, n) rows that hold the base, for `normal_modes`."""
        result: Vector = np.eye(len(self.mass))[self.base_rows]
        return result

    @property
    def mass_on_base(self) -> Vector:
        """(n, n) mass of all that a base carries, without that of the base itself."""
        result = self.mass.copy()
        if self.mechanism.base in self.mechanism.bodies:
            rows = np.ix_(self.base_rows, self.base_rows)
            result[rows] = self.mechanism.bodies[self.mechanism.base].carried_mass()
        return result

    @property
    def origin(self) -> Vector:
        """(3,) point of the base about which it turns: a ground's reference point, a free base's centre of mass."""
        bodies = self.mechanism.bodies
        return bodies[self.mechanism.base].position if self.mechanism.base in bodies else np.zeros(3)

    @property
    def total_mass(self) -> float:
        """Of all bodies (kg)."""
        return float(sum(self.mass[rows.start, rows.start] for rows in self.mechanism.rows.values()))

    @property
    def unbalanced(self) -> tuple[float, float]:
        """Largest force (N) and torque (N.m) on a body that nothing balances in this configuration."""
        bodies, base = self.mechanism.bodies, self.mechanism.base
        moving = [
            rows for name, rows in self.mechanism.rows.items() if name != base and not bodies[name].is_led
        ]
        load = np.array([self.residual[rows.start : rows.start + 6] for rows in moving]).reshape(-1, 2, 3)
        force, torque = np.linalg.norm(load, axis=2).max(axis=0, initial=0.0).tolist()
        return force, torque


class NormalModes(NamedTuple):
    """Undamped modes in the order of their eigenvalues (k,), rad2/s2; shapes (n, k) have unit modal mass.

    In axes that turn shapes are complex, the imaginary part a quarter of a period ahead, and it is the mean of modal
    mass and modal stiffness / eigenvalue that is one.
    """

    eigenvalues: Vector
    shapes: Vector

    @property
    def frequencies(self) -> Vector:
        """(k,) Hz; negative where the configuration is unstable: the growth rate over 2 pi."""
        result: Vector = np.sign(self.eigenvalues) * np.sqrt(np.abs(self.eigenvalues)) / (2.0 * np.pi)
        return result

    @property
    def is_free(self) -> NDArray[np.bool_]:
        """(k,) whether a mode is a free motion, of the whole or of a mechanism."""
        result: NDArray[np.bool_] = np.abs(self.frequencies) < ZERO_FREQUENCY
        return result


def linearise(mechanism: Mechanism) -> LinearModel:
    """The linear model about the present pose."""
    mechanism.carry()
    return LinearModel(
        mechanism,
        mechanism.mass(),
        mechanism.damping(),
        mechanism.gyroscopic(),
        mechanism.stiffness(),
        mechanism.forces(),
    )


def normal_modes(model: LinearModel, constraints: Vector | None = None) -> NormalModes:
    """Modes of the symmetric part of the stiffness; constraints (r, n) are rows that motions have zero products with.

    Solved for 1 / (eigenvalue + shift), so that stiff joints do not drown soft mechanisms in round-off.
    """
    rows = model.free_rows
    basis = np.eye(len(model.mass))[:, rows]
    if constraints is not None:
        basis = basis @ null_space(constraints[:, rows])
    if not basis.shape[1]:
        raise SceneError(["nothing is free to move, so there are no modes"])
    mass = basis.T @ model.mass @ basis
    stiffness = basis.T @ (0.5 * (model.stiffness + model.stiffness.T)) @ basis
    shift = _SHIFT
    while True:
        try:
            inverse, vectors = generalized_modes(mass, stiffness + shift * mass)
            break
        except np.linalg.LinAlgError:
            shift *= 100.0
            if shift > _LARGEST_SHIFT:
                raise SceneError(["the stiffness has no modes: check springs with negative rates"]) from None
    if not np.all(inverse > 0.0):
        raise SceneError(
            ["the masses have no modes: some are too small relative to others; check their units"]
        )
    order = np.argsort(-inverse)
    vectors = vectors[:, order] / np.sqrt(inverse[order])
    return NormalModes(1.0 / inverse[order] - shift, basis @ vectors)


def spinning_modes(model: LinearModel) -> NormalModes:
    """The modes where rates matter: lambda^2 M + lambda G + K is singular, from all modes without G."""
    still = normal_modes(model)
    count, rates = still.eigenvalues.size, np.sqrt(np.maximum(np.abs(still.eigenvalues), 1.0))
    gyroscopic = still.shapes.T @ model.gyroscopic @ still.shapes
    # coordinates by their rates, so that stiff joints do not drown soft modes in round-off
    first = np.block(
        [[np.zeros((count, count)), np.diag(rates)], [-np.diag(still.eigenvalues / rates), -gyroscopic]]
    )
    roots, vectors = np.linalg.eig(first)
    # of conjugate pairs and of growth and decay, one each
    chosen = np.lexsort((-roots.real, -roots.imag))[:count]
    roots, vectors = roots[chosen], vectors[:count, chosen] / rates[:, None]
    eigenvalues = np.where(np.abs(roots.imag) > np.abs(roots.real), 1.0, -1.0) * np.abs(roots) ** 2
    order = np.argsort(eigenvalues)
    eigenvalues, vectors = eigenvalues[order], vectors[:, order]
    energies = (np.abs(vectors) ** 2).T @ still.eigenvalues / np.where(eigenvalues, eigenvalues, 1.0)
    sizes = 0.5 * np.abs((np.abs(vectors) ** 2).sum(0) + energies)
    return NormalModes(eigenvalues, still.shapes @ (vectors / np.sqrt(sizes)))


def modal_damping(model: LinearModel, modes: NormalModes) -> Vector:
    """Damping ratios (k,) of single modes, the diagonal of the modal damping matrix; nan for free motions."""
    rates = _quadratic(model.damping, modes.shapes)
    omega = 2.0 * np.pi * np.abs(modes.frequencies)
    result: Vector = np.where(modes.is_free, np.nan, rates / (2.0 * np.where(modes.is_free, 1.0, omega)))
    return result


def damping_matrix(model: LinearModel, shapes: Vector) -> Vector:
    """Damping between modes of these shapes (n, k), over their modal mass: (k, k), rad/s."""
    result: Vector = shapes.T @ model.damping @ shapes
    return result


def coupled_by_damping(model: LinearModel, modes: NormalModes) -> Vector:
    """How much less than alone (k,) a mode loses as others, which its damping stirs, give way; to first order.

    Mode j moves mode k by i w c_jk / (w_k^2 - w^2 + i w c_kk), which takes w^2 c_jk^2 c_kk / |...|^2 of c_jj away. Zero
    for free motions and in axes that turn.
    """
    if np.iscomplexobj(modes.shapes):
        return np.zeros(modes.eigenvalues.size)
    damping = damping_matrix(model, modes.shapes)
    own, square = damping.diagonal(), np.where(modes.is_free, 0.0, modes.eigenvalues)
    moved = (square - square[:, None]) ** 2 + np.abs(square)[:, None] * own**2
    taken = np.abs(square)[:, None] * damping**2 * own
    np.fill_diagonal(taken, 0.0)
    shares = np.divide(taken, moved, np.zeros_like(taken), where=moved > 0.0).sum(axis=1)
    result: Vector = np.divide(shares, own, np.zeros_like(own), where=(own > 0.0) & ~modes.is_free)
    return result


def damping_shares(model: LinearModel, modes: NormalModes) -> dict[str, Vector]:
    """Share (k,) of every body and connection in the damping of single modes; zero where nothing damps one."""
    mechanism, shapes = model.mechanism, modes.shapes
    total = _quadratic(model.damping, shapes)
    found = {
        name: _quadratic(viscous, motion @ shapes) for name, motion, viscous in mechanism.damping_parts()
    }
    return {
        name: np.divide(part, total, np.zeros_like(part), where=total > 0.0) for name, part in found.items()
    }


def effective_masses(model: LinearModel, modes: NormalModes) -> tuple[Vector, Vector]:
    """Effective masses (6, k) under motions of the base, and the rigid masses (6,) of what it carries.

    Three translations (kg) and three rotations about the origin (kg m2), world axes. Modes of a free base have none, as
    the whole has no momentum; in axes that turn they are not defined, and not a number.
    """
    rigid = model.mechanism.rigid_motion(model.origin)
    spins = model.mechanism.spin is not None
    participation = rigid.T @ model.mass @ (np.nan * modes.shapes.real if spins else modes.shapes)
    return participation**2, np.diag(rigid.T @ model.mass_on_base @ rigid)


def kinetic_shares(model: LinearModel, modes: NormalModes) -> dict[str, Vector]:
    """Share (k,) of every moving body in the kinetic energy of the modes."""
    result = {}
    for name, rows in model.mechanism.rows.items():
        if model.mechanism.bodies[name].is_led:
            continue
        part = modes.shapes[rows]
        result[name] = _quadratic(model.mass[rows, rows], part)
    total = sum(result.values())
    return {name: part / total for name, part in result.items()}


def _quadratic(matrix: Vector, shapes: Vector) -> Vector:
    """Of every shape (n, k) with itself, (k,)."""
    result: Vector = np.einsum("ik,ij,jk->k", shapes.conj(), matrix, shapes).real
    return result
