"""Rotations and spatial vectors in plain floats: small enough for a step, where array calls cost more.

Quaternions are tuples (w, x, y, z) that rotate body into world coordinates; vectors are tuples (x, y, z).
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Vector3: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]

_ROUNDING = 1e-12
"""Of a unit quaternion's components: cos(pi / 2) is no zero in floats."""
SKEW = np.zeros((3, 9))
"""(3, 9): `v @ SKEW`, reshaped to (3, 3), is the skew matrix of v (v x w = skew(v) w)."""
SKEW[0, 5], SKEW[0, 7] = -1.0, 1.0
SKEW[1, 2], SKEW[1, 6] = 1.0, -1.0
SKEW[2, 1], SKEW[2, 3] = -1.0, 1.0


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Product a b: first b, then a."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def conjugate(q: Quaternion) -> Quaternion:
    """Inverse of a unit quaternion."""
    return (q[0], -q[1], -q[2], -q[3])


def normalized(q: Quaternion) -> Quaternion:
    """The quaternion of unit length."""
    scale = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return (q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale)


def with_positive_scalar(q: Quaternion) -> Quaternion:
    """The unit quaternion of the same rotation whose first component that is no rounding is positive."""
    leading = next(component for component in q if abs(component) > _ROUNDING)
    return q if leading > 0.0 else (-q[0], -q[1], -q[2], -q[3])


def exponential(v: Vector3) -> Quaternion:
    """Quaternion of the rotation vector v (rad)."""
    angle = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    if angle < 1e-6:
        k = 0.5 - angle * angle / 48.0
        return (1.0 - angle * angle / 8.0, k * v[0], k * v[1], k * v[2])
    k = sin(0.5 * angle) / angle
    return (cos(0.5 * angle), k * v[0], k * v[1], k * v[2])


def rotation_vector(q: Quaternion) -> Vector3:
    """Rotation vector (rad), half a turn at most, of a unit quaternion: the inverse of `exponential`."""
    w, x, y, z = q if q[0] >= 0.0 else (-q[0], -q[1], -q[2], -q[3])
    half = sqrt(x * x + y * y + z * z)
    return scaled(2.0 if half < 1e-8 else 2.0 * atan2(half, w) / half, (x, y, z))


def rotation_between(before: Quaternion, after: Quaternion) -> Vector3:
    """Rotation vector (rad) of the shortest rotation from one orientation to another, world axes."""
    return rotation_vector(multiply(after, conjugate(before)))


def rotate(q: Quaternion, v: Vector3) -> Vector3:
    """The vector v turned by q."""
    w, x, y, z = q
    tx = 2.0 * (y * v[2] - z * v[1])
    ty = 2.0 * (z * v[0] - x * v[2])
    tz = 2.0 * (x * v[1] - y * v[0])
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


def rotated(quaternions: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Vectors (..., 3) turned by unit quaternions (..., 4), of shapes that broadcast."""
    scalar, axis = quaternions[..., :1], quaternions[..., 1:]
    twice = 2.0 * np.cross(axis, vectors)
    found: NDArray[np.float64] = vectors + scalar * twice + np.cross(axis, twice)
    return found


def rotate_back(q: Quaternion, v: Vector3) -> Vector3:
    """The vector v turned by the inverse of q."""
    return rotate((q[0], -q[1], -q[2], -q[3]), v)


def rotation_matrix(q: Quaternion) -> NDArray[np.float64]:
    """Rotation matrix (3, 3) of a unit quaternion."""
    w, x, y, z = q
    return np.array(
        (
            (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
            (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
            (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
        )
    )


def quaternion_of_axes(x: Vector3, y: Vector3, z: Vector3) -> Quaternion:
    """Quaternion of the rotation whose matrix has these columns, orthonormal and right-handed."""
    diagonal = (x[0], y[1], z[2])
    squares = [
        1.0 + sum(diagonal),
        *(1.0 + 2.0 * d - sum(diagonal) for d in diagonal),
    ]
    largest = max(range(4), key=squares.__getitem__)
    doubles = (
        (squares[0], y[2] - z[1], z[0] - x[2], x[1] - y[0]),
        (y[2] - z[1], squares[1], x[1] + y[0], z[0] + x[2]),
        (z[0] - x[2], x[1] + y[0], squares[2], y[2] + z[1]),
        (x[1] - y[0], z[0] + x[2], y[2] + z[1], squares[3]),
    )
    return normalized(doubles[largest])


def left_product(q: Quaternion) -> NDArray[np.float64]:
    """Matrix (4, 4) that multiplies a quaternion by q from the left."""
    w, x, y, z = q
    return np.array(((w, -x, -y, -z), (x, w, -z, y), (y, z, w, -x), (z, -y, x, w)))


def skew(v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Skew matrices (..., 3, 3) of vectors (..., 3): skew(v) w = v x w."""
    return (v @ SKEW).reshape(*v.shape[:-1], 3, 3)


def sum_of_moments(arms: NDArray[np.float64], forces: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum over rows of arms x forces, both (n, 3); one product instead of n."""
    s = arms.T @ forces
    return np.array((s[1, 2] - s[2, 1], s[2, 0] - s[0, 2], s[0, 1] - s[1, 0]))


def cross(a: Vector3, b: Vector3) -> Vector3:
    """Vector product a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Vector3, b: Vector3) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def add(a: Vector3, b: Vector3) -> Vector3:
    """Sum a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vector3, b: Vector3) -> Vector3:
    """Difference a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(k: float, a: Vector3) -> Vector3:
    """Product k a."""
    return (k * a[0], k * a[1], k * a[2])


def mean(a: Vector3, b: Vector3) -> Vector3:
    """Mean of two vectors."""
    return (0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2]))


def norm(a: Vector3) -> float:
    """Length."""
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def nearest_turn(angle: float, reference: float) -> float:
    """The angle plus the multiple of a full turn that brings it nearest to the reference (unwrapping)."""
    return angle + 2.0 * pi * round((reference - angle) / (2.0 * pi))


def swing_twist(q: Quaternion) -> tuple[float, float, float]:
    """Split a rotation into a twist about x and a swing about an axis normal to it, q = swing twist.

    Returns the twist angle in (-2 pi, 2 pi) and the two components (y, z) of the swing's rotation vector.
    """
    w, x, y, z = q
    twist = 2.0 * atan2(x, w)
    length = sqrt(w * w + x * x)
    tw, tx = w / length, x / length
    # swing = q * conjugate(twist); its x component vanishes
    sy = y * tw - z * tx
    sz = z * tw + y * tx
    half = sqrt(sy * sy + sz * sz)
    k = 2.0 if half < 1e-8 else 2.0 * atan2(half, length) / half
    return twist, k * sy, k * sz


def frame_with_x_along(axis: Vector3) -> Quaternion:
    """The shortest rotation that turns the x axis into the given direction; ValueError if it has no length."""
    length = norm(axis)
    if not length > 0.0:
        raise ValueError("a direction needs a length")
    x, y, z = axis[0] / length, axis[1] / length, axis[2] / length
    if x < -1.0 + 1e-12:
        return (0.0, 0.0, 0.0, 1.0)
    return normalized((1.0 + x, 0.0, -z, y))
