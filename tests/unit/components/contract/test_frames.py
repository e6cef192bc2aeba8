"""Rotations and spatial vectors against an independent library and against their defining identities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from components.contract import frames

COORDINATE = st.floats(-3.0, 3.0)
VECTOR = st.tuples(COORDINATE, COORDINATE, COORDINATE)
QUATERNION = (
    st.tuples(COORDINATE, COORDINATE, COORDINATE, COORDINATE)
    .filter(lambda q: np.linalg.norm(q) > 1e-3)
    .map(frames.normalized)
)


def library(q):
    return Rotation.from_quat(np.roll(q, -1))


@given(QUATERNION, QUATERNION, VECTOR)
def test_products_and_rotations(a, b, v):
    """Independent library (SciPy): product, inverse, matrix, rotation of a vector and back."""
    both = frames.multiply(a, b)
    assert library(both).as_matrix() == pytest.approx((library(a) * library(b)).as_matrix(), abs=1e-14)
    assert frames.rotation_matrix(a) == pytest.approx(library(a).as_matrix(), abs=1e-14)
    assert frames.rotate(a, v) == pytest.approx(library(a).apply(v), abs=1e-14)
    assert frames.rotate_back(a, frames.rotate(a, v)) == pytest.approx(v, abs=1e-14)
    assert frames.multiply(a, frames.conjugate(a)) == pytest.approx((1, 0, 0, 0), abs=1e-15)
    assert frames.left_product(a) @ np.array(b) == pytest.approx(both, abs=1e-14)


@given(VECTOR)
def test_exponential(v):
    """Independent library (SciPy): the rotation of a rotation vector."""
    assert library(frames.exponential(v)).as_matrix() == pytest.approx(
        Rotation.from_rotvec(v).as_matrix(), abs=1e-14
    )


@pytest.mark.parametrize("angle", [0.0, 1e-12, 0.99e-6, 1.01e-6, 1e-3])
def test_exponential_of_small_vectors_keeps_full_accuracy(angle):
    """Closed form: half the vector to relative round-off on both sides of the switch of formulas."""
    q = frames.exponential((angle, 0.0, 0.0))
    assert q[1] == pytest.approx(np.sin(0.5 * angle), rel=1e-15)
    assert q[0] == pytest.approx(np.cos(0.5 * angle), rel=1e-15)


@given(VECTOR, VECTOR)
def test_vector_algebra(a, b):
    """Independent library (NumPy): sums, products, skew matrices, sums of moments."""
    u, v = np.array(a), np.array(b)
    assert frames.cross(a, b) == pytest.approx(np.cross(u, v), abs=1e-14)
    assert frames.dot(a, b) == pytest.approx(u @ v, abs=1e-14)
    assert frames.norm(a) == pytest.approx(np.linalg.norm(u), abs=1e-14)
    assert frames.mean(a, b) == pytest.approx((u + v) / 2)
    assert frames.subtract(frames.add(a, b), b) == pytest.approx(u, abs=1e-14)
    assert frames.scaled(-2.0, a) == pytest.approx(-2 * u)
    assert frames.skew(u) @ v == pytest.approx(np.cross(u, v), abs=1e-14)
    assert frames.skew(np.stack((u, v)))[1] == pytest.approx(frames.skew(v))
    assert frames.sum_of_moments(np.stack((u, v)), np.stack((v, 2 * u))) == pytest.approx(
        np.cross(u, v) + 2 * np.cross(v, u), abs=1e-13
    )


@given(st.floats(-9.0, 9.0), st.floats(-3.1, 3.1), st.floats(0.0, 6.28))
def test_swing_twist_recomposes(twist, swing, direction):
    """Defining identity q = swing twist, the swing about an axis normal to x."""
    axis = (0.0, swing * np.cos(direction), swing * np.sin(direction))
    q = frames.multiply(frames.exponential(axis), frames.exponential((twist, 0.0, 0.0)))
    found, sy, sz = frames.swing_twist(q)
    again = frames.multiply(frames.exponential((0.0, sy, sz)), frames.exponential((found, 0.0, 0.0)))
    assert library(again).as_matrix() == pytest.approx(library(q).as_matrix(), abs=1e-12)
    turns = (found - twist) / (2 * np.pi)
    assert turns == pytest.approx(round(turns), abs=1e-10)
    assert -2 * np.pi <= found <= 2 * np.pi


@given(VECTOR.filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_frame_with_x_along(axis):
    """Defining property: unit quaternion that turns x into the direction."""
    q = frames.frame_with_x_along(axis)
    assert frames.rotate(q, (1.0, 0.0, 0.0)) == pytest.approx(np.array(axis) / np.linalg.norm(axis), abs=2e-6)
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-15)


def test_frame_with_x_backwards_and_without_length():
    """Limit case of the shortest rotation, and the refusal where there is none."""
    assert frames.rotate(frames.frame_with_x_along((-2.0, 0.0, 0.0)), (1.0, 0.0, 0.0)) == pytest.approx(
        (-1.0, 0.0, 0.0)
    )
    with pytest.raises(ValueError, match="length"):
        frames.frame_with_x_along((0.0, 0.0, 0.0))


@given(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
def test_nearest_turn(angle, reference):
    """Defining property: the same direction, at most half a turn from the reference."""
    found = frames.nearest_turn(angle, reference)
    assert abs(found - reference) <= np.pi * (1 + 1e-12)
    assert np.exp(1j * found) == pytest.approx(np.exp(1j * angle), abs=1e-12)
