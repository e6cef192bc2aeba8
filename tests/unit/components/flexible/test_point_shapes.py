"""Shapes from points: a line, a polygon and a convex hull, by their measures."""

import numpy as np
import pytest

from components.flexible.point_shapes import span


def area(positions, faces):
    """Of flat faces, from their diagonals."""
    a, b, c, d = (positions[faces[:, k]] for k in range(4))
    return 0.5 * np.linalg.norm(np.cross(c - a, d - b), axis=1).sum()


def test_points_that_coincide_have_no_shape():
    assert span([(1.0, 2.0, 3.0)] * 3)[1].shape == (0, 4)


def test_points_on_a_line_are_joined_by_its_ends():
    positions, faces = span([(0.0, 0.0, 0.0), (2.0, 2.0, 0.0), (1.0, 1.0, 0.0)])
    assert faces.shape == (1, 4)
    assert faces[0, 1] == faces[0, 2]
    assert np.linalg.norm(positions[faces[0, 1]] - positions[faces[0, 0]]) == pytest.approx(8**0.5)


def test_points_in_a_plane_are_a_polygon():
    """A rectangle of 2 by 3 m in a tilted plane, with a point inside."""
    u, v = np.array((0.6, 0.0, 0.8)), np.array((0.0, 1.0, 0.0))
    corners = [2.0 * a * u + 3.0 * b * v for a, b in ((0, 0), (1, 0), (1, 1), (0, 1), (0.3, 0.6))]
    assert area(*span([tuple(corner) for corner in corners])) == pytest.approx(6.0)


def test_points_in_space_are_a_hull():
    """The surface of a box of 1 by 2 by 3 m."""
    corners = [(float(x), 2.0 * y, 3.0 * z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    assert area(*span(corners)) == pytest.approx(22.0)
