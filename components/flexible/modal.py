"""Modal data of a flexible body: orthonormal Craig-Bampton modes and the nine inertia invariants.

The rigid motions are removed from the modes, mass-orthogonally, so the invariants I3 and I4 vanish and the
floating frame is the mean-axis frame with its origin in the centre of mass (Bagnoli 2007, section 1.3 and
Table 1-1). Made from finite elements by `reduction`, or directly from point masses.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from math import isqrt
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..contract.component import ComponentError, Vector
from ..contract.frames import skew

_NO_FACES = np.zeros((0, 4), dtype=np.int64)


def default_damping(frequency: Vector) -> Vector:
    """Modal damping ratios (M,) of frequencies (M,) in rad/s: 1 % below 100 Hz, 10 % to 1 kHz, 1 above."""
    hertz = np.asarray(frequency, dtype=float) / (2.0 * np.pi)
    return np.where(hertz < 100.0, 0.01, np.where(hertz <= 1000.0, 0.1, 1.0))


def rigid_motion(position: ArrayLike) -> Vector:
    """Motion (6, 6) of a point at `position` (3,) under unit translations and rotations about the origin."""
    motion = np.eye(6)
    motion[:3, 3:] = -skew(np.asarray(position, dtype=float))
    return motion


@dataclass(frozen=True)
class ModalData:
    """Orthonormalised Craig-Bampton body with rigid modes removed; all axes are the construction frame's.

    A rigid body is the same with no modes (M = 0). Inertia of the deformed body about its centre of mass:
    J(eta) = inertia - (I8_j + I8_j^T) eta_j - I9_jk eta_j eta_k.
    """

    mass: float
    """kg"""
    center_of_mass: Vector
    """(3,) undeformed, m"""
    inertia: Vector
    """(3, 3) undeformed, about the centre of mass (I7), kg m2"""
    frequency: Vector
    """(M,) rad/s, ascending"""
    damping_ratio: Vector
    """(M,) fraction of critical"""
    point_names: tuple[str, ...]
    """N attachment points and nodes that a scene may connect to"""
    point_positions: Vector
    """(N, 3) undeformed, m"""
    translation: Vector
    """(N, 3, M) mass-normalised mode shapes at the points, kg^-1/2"""
    rotation: Vector
    """(N, 3, M) small rotation vectors of the modes at the points, rad m^-1 kg^-1/2"""
    invariant5: Vector
    """(M, 3, M) I5[j, :, k] = sum m phi_j x phi_k"""
    invariant8: Vector
    """(M, 3, 3) I8[j] = sum m skew(s) skew(phi_j), s from the centre of mass"""
    invariant9: Vector
    """(M, M, 3, 3) I9[j, k] = sum m skew(phi_j) skew(phi_k)"""
    second_order_points: Vector = field(default_factory=lambda: np.zeros((0, 6, 0, 0)))
    """(N, 6, S, S) translation and rotation of the points by pairs of the S lowest modes, or empty"""
    tension_forms: Vector = field(default_factory=lambda: np.zeros((0, 0, 0)))
    """(P, S, S) of bending that stretches: adds 1/2 sum (1/2 eta^T S_p eta)^2 to the strain energy; or empty"""
    display_positions: Vector = field(default_factory=lambda: np.zeros((0, 3)))
    """(D, 3) coarse grid for pictures, m"""
    display_shapes: Vector = field(default_factory=lambda: np.zeros((0, 3, 0)))
    """(D, 3, M) mode shapes on that grid"""
    display_faces: NDArray[np.int64] = field(default_factory=_NO_FACES.copy)
    """(F, 4) corners of its faces; a line is the degenerate face i, j, j, i"""

    @classmethod
    def rigid(
        cls,
        mass: float,
        center_of_mass: ArrayLike,
        inertia: ArrayLike,
        points: Mapping[str, ArrayLike],
        display_positions: ArrayLike = (),
        display_faces: ArrayLike = (),
    ) -> Self:
        """A body without modes: mass (kg), centre of mass (3,), inertia about it (3, 3), points (3,)."""
        positions = np.array([np.asarray(p, dtype=float) for p in points.values()]).reshape(-1, 3)
        display = np.asarray(display_positions, dtype=float).reshape(-1, 3)
        return cls(
            mass=float(mass),
            center_of_mass=np.array(center_of_mass, dtype=float),
            inertia=np.array(inertia, dtype=float),
            frequency=np.zeros(0),
            damping_ratio=np.zeros(0),
            point_names=tuple(points),
            point_positions=positions,
            translation=np.zeros((len(positions), 3, 0)),
            rotation=np.zeros((len(positions), 3, 0)),
            invariant5=np.zeros((0, 3, 0)),
            invariant8=np.zeros((0, 3, 3)),
            invariant9=np.zeros((0, 0, 3, 3)),
            display_positions=display,
            display_shapes=np.zeros((len(display), 3, 0)),
            display_faces=np.array(display_faces, dtype=np.int64).reshape(-1, 4),
        )

    @classmethod
    def from_point_masses(
        cls,
        masses: ArrayLike,
        positions: ArrayLike,
        shapes: ArrayLike,
        frequency: ArrayLike,
        points: Mapping[str, int],
        rotations: ArrayLike | None = None,
    ) -> Self:
        """A body of point masses (Q,) at positions (Q, 3) with independent shapes (3 Q, M) of any kind.

        The rigid motions are projected out of the shapes and what is left is made orthonormal, in order.
        `points`: mass index by name; `rotations` (N, 3, M) are the shapes' rotations there, by default zero.
        """
        m, x = np.asarray(masses, dtype=float), np.asarray(positions, dtype=float)
        center = m @ x / m.sum()
        root = np.repeat(np.sqrt(m), 3)[:, None]
        rigid = np.concatenate([rigid_motion(p - center)[:3] for p in x])
        fit, *_ = np.linalg.lstsq(root * rigid, root * np.asarray(shapes, dtype=float), rcond=None)
        elastic, triangle = np.linalg.qr(root * (np.asarray(shapes, dtype=float) - rigid @ fit))
        elastic /= root
        index = list(points.values())
        turns = np.zeros((len(index), 3, elastic.shape[1])) if rotations is None else np.asarray(rotations)
        turns = (turns - fit[3:]) @ np.linalg.inv(triangle)
        rate = np.asarray(frequency, dtype=float)
        i = inertia_invariants(m, x - center, elastic)
        return cls(
            mass=i.i1,
            center_of_mass=center,
            inertia=i.i7,
            frequency=rate,
            damping_ratio=default_damping(rate),
            point_names=tuple(points),
            point_positions=x[index],
            translation=elastic.reshape(-1, 3, rate.size)[index],
            rotation=turns,
            invariant5=i.i5,
            invariant8=i.i8,
            invariant9=i.i9,
            display_shapes=np.zeros((0, 3, rate.size)),
        )

    def to_arrays(self) -> dict[str, Any]:
        """Every field by name: arrays, the mass as a float, the names as a tuple."""
        return {f.name: getattr(self, f.name) for f in fields(self)}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any]) -> Self:
        """Inverse of `to_arrays`; nested lists do as well as arrays."""
        known = {f.name for f in fields(cls)}
        if set(arrays) != known:
            wrong = ", ".join(sorted(known.symmetric_difference(arrays)))
            raise ComponentError(f"modal data must have exactly its own fields; missing or unknown: {wrong}")
        modes = np.size(arrays["frequency"])
        values: dict[str, Any] = {
            "mass": float(arrays["mass"]),
            "point_names": tuple(str(name) for name in arrays["point_names"]),
            "display_faces": np.asarray(arrays["display_faces"], dtype=np.int64).reshape(-1, 4),
        }
        points = len(values["point_names"])
        second_order = _second_order_modes(np.size(arrays["second_order_points"]), modes, points)
        forms = np.size(arrays["tension_forms"]) // max(second_order, 1) ** 2
        shapes = _shapes(modes, second_order, points, np.size(arrays["display_positions"]) // 3, forms)
        for name, shape in shapes.items():
            array = np.asarray(arrays[name], dtype=float)
            if array.size != np.prod(shape):
                raise ComponentError(f"{name} has shape {array.shape}; it must be {shape}")
            values[name] = array.reshape(shape)
        return cls(**values)

    @property
    def second_order_modes(self) -> int:
        """Number S of the lowest modes that displace the body to second order."""
        return int(self.second_order_points.shape[3])

    def keep_modes(self, keep: ArrayLike) -> Self:
        """The body with some modes only: a boolean mask (M,) or mode indices from 0, ascending."""
        index = np.arange(self.frequency.size)[np.asarray(keep)]
        low = index[index < self.second_order_modes]
        pairs = np.ix_(range(len(self.second_order_points)), range(6), low, low)
        return replace(
            self,
            frequency=self.frequency[index],
            damping_ratio=self.damping_ratio[index],
            translation=self.translation[:, :, index],
            rotation=self.rotation[:, :, index],
            invariant5=self.invariant5[np.ix_(index, range(3), index)],
            invariant8=self.invariant8[index],
            invariant9=self.invariant9[np.ix_(index, index)],
            second_order_points=self.second_order_points[pairs],
            tension_forms=self.tension_forms[np.ix_(range(len(self.tension_forms)), low, low)],
            display_shapes=self.display_shapes[:, :, index],
        )

    def switch_off(self, modes: Iterable[int] = (), ranges: Iterable[tuple[float, float]] = ()) -> Self:
        """The body without the modes of the given indices (from 0) and frequency ranges (low, high) in Hz."""
        hertz = self.frequency / (2.0 * np.pi)
        keep = np.ones(hertz.size, dtype=bool)
        for mode in modes:
            if not 0 <= mode < hertz.size:
                raise ComponentError(f"there is no mode {mode}; modes are 0 to {hertz.size - 1}")
            keep[mode] = False
        for low, high in ranges:
            keep &= (hertz < low) | (hertz > high)
        return self.keep_modes(keep)

    def with_damping(self, ratios: ArrayLike) -> Self:
        """The body with modal damping ratios (M,), or one for all."""
        ratio = np.broadcast_to(np.asarray(ratios, dtype=float), self.frequency.shape).copy()
        if not np.all(ratio >= 0.0):
            raise ComponentError("modal damping ratios must not be negative")
        return replace(self, damping_ratio=ratio)

    def with_structural_damping(self, time: float) -> Self:
        """The body with damping in proportion to stiffness, C = time K (s, not negative): ratios time w / 2."""
        return self.with_damping(0.5 * time * self.frequency)


def _second_order_modes(size: int, modes: int, points: int) -> int:
    """How many modes so many numbers of second order belong to."""
    count = isqrt(size // (6 * points)) if points else 0
    if count > modes or 6 * points * count**2 != size:
        raise ComponentError(
            f"second_order_points has {size} numbers; it must be 6 by every two of some modes a point"
        )
    return count


def _shapes(
    modes: int, second_order: int, points: int, display: int, forms: int
) -> dict[str, tuple[int, ...]]:
    """Shapes of the floating-point fields of `ModalData`."""
    m = modes
    return {
        "center_of_mass": (3,),
        "inertia": (3, 3),
        "frequency": (m,),
        "damping_ratio": (m,),
        "point_positions": (points, 3),
        "translation": (points, 3, m),
        "rotation": (points, 3, m),
        "invariant5": (m, 3, m),
        "invariant8": (m, 3, 3),
        "invariant9": (m, m, 3, 3),
        "second_order_points": (points if second_order else 0, 6, second_order, second_order),
        "tension_forms": (forms, second_order, second_order),
        "display_positions": (display, 3),
        "display_shapes": (display, 3, m),
    }


@dataclass(frozen=True)
class Invariants:
    """The nine inertia invariants of sampled mass, positions s from the centre of mass (Table 1-1)."""

    i1: float
    """mass, kg"""
    i2: Vector
    """(3,) sum m s = 0"""
    i3: Vector
    """(3, M) sum m phi_j"""
    i4: Vector
    """(3, M) sum m s x phi_j"""
    i5: Vector
    """(M, 3, M) sum m phi_j x phi_k"""
    i6: Vector
    """(M, M) sum m phi_j . phi_k"""
    i7: Vector
    """(3, 3) sum m skew(s)^T skew(s)"""
    i8: Vector
    """(M, 3, 3) sum m skew(s) skew(phi_j)"""
    i9: Vector
    """(M, M, 3, 3) sum m skew(phi_j) skew(phi_k)"""


def inertia_invariants(masses: Vector, arms: Vector, shapes: Vector) -> Invariants:
    """Invariants of masses (Q,) at arms (Q, 3) from the centre of mass with mode shapes (3 Q, M).

    All second-order sums are entries of one Gram matrix over s and phi: skew(a) skew(b) = b a^T - (a.b) 1.
    """
    count, modes = masses.size, shapes.shape[1]
    field_ = np.concatenate([arms[:, :, None], shapes.reshape(count, 3, modes)], axis=2)
    weighted = (np.sqrt(masses)[:, None, None] * field_).reshape(count, 3 * (modes + 1))
    gram = (weighted.T @ weighted).reshape(3, modes + 1, 3, modes + 1).transpose(1, 3, 0, 2)
    dots = np.trace(gram, axis1=2, axis2=3)
    products = gram.transpose(0, 1, 3, 2) - dots[:, :, None, None] * np.eye(3)
    crosses = np.stack([gram[..., a, b] - gram[..., b, a] for a, b in ((1, 2), (2, 0), (0, 1))], axis=-1)
    first = np.tensordot(masses, field_, 1)
    return Invariants(
        i1=float(masses.sum()),
        i2=first[:, 0],
        i3=first[:, 1:],
        i4=crosses[0, 1:].T,
        i5=crosses[1:, 1:].transpose(0, 2, 1),
        i6=dots[1:, 1:],
        i7=-products[0, 0],
        i8=products[0, 1:],
        i9=products[1:, 1:],
    )
