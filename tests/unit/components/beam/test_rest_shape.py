"""Axes of beams without load against the geometry of circles and helices."""

import numpy as np
import pytest

from components.beam_parts.rest_shape import Arc, Curve, section_orientations
from components.contract.component import ComponentError
from components.contract.frames import rotation_matrix


def test_an_arc_is_part_of_a_circle():
    """Closed form: all points are as far from the centre; straight is its limit."""
    distances = np.linspace(0.0, 5.0, 11)
    places, tangents = Arc(5.0, 0.5).at(distances)
    assert np.linalg.norm(places - (0.0, 0.0, 2.0), axis=1) == pytest.approx(2.0, rel=1e-14)
    assert np.arctan2(tangents[:, 2], tangents[:, 0]) == pytest.approx(0.5 * distances, abs=1e-14)
    assert np.abs(Arc(5.0, 1e-12).at(distances)[0] - Arc(5.0).at(distances)[0]).max() < 1e-10


def test_a_curve_through_points_of_a_helix():
    """Closed form: length and places of a helix of radius 1 and rise 0.3 a radian, to the spline's fourth order."""
    angle = np.linspace(0.0, 3.0, 61)
    points = np.column_stack((np.cos(angle), np.sin(angle), 0.3 * angle))
    curve = Curve(tuple(map(tuple, points.tolist())))
    speed = np.hypot(1.0, 0.3)
    assert curve.length == pytest.approx(3.0 * speed, rel=1e-6)
    places, tangents = curve.at(speed * np.array([0.333, 1.777]))
    for place, tangent, at in zip(places, tangents, (0.333, 1.777), strict=True):
        assert place == pytest.approx((np.cos(at), np.sin(at), 0.3 * at), abs=2e-6)
        assert tangent == pytest.approx(np.array((-np.sin(at), np.cos(at), 0.3)) / speed, abs=1e-4)


def test_a_line_through_two_points():
    """Geometry: straight, however long."""
    places, tangents = Curve(((1.0, 0.0, 0.0), (1.0, 3.0, 4.0))).at(np.array([0.0, 2.5, 5.0]))
    assert places[1:] == pytest.approx(np.array([(1.0, 1.5, 2.0), (1.0, 3.0, 4.0)]), abs=1e-12)
    assert tangents == pytest.approx(np.array([(0.0, 0.6, 0.8)] * 3), abs=1e-15)


def test_sections_turn_as_little_as_the_axis():
    """Geometry: x along the axis, and on a plane curve the normal of the plane stays where it was."""
    tangents = Arc(3.0, 1.0).at(np.linspace(0.0, 3.0, 13))[1]
    for tangent, turn in zip(tangents, section_orientations(tangents, (0.2, 1.0, 0.0)), strict=True):
        axes = rotation_matrix(turn)
        assert axes[:, 0] == pytest.approx(tangent, abs=1e-14)
        assert axes[:, 2] == pytest.approx((0.0, 1.0, 0.0), abs=1e-14)


@pytest.mark.parametrize("points", [((0.0, 0.0, 0.0),), ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))])
def test_an_axis_needs_two_places(points):
    with pytest.raises(ComponentError, match="two points"):
        Curve(points)


def test_section_z_across_the_axis():
    with pytest.raises(ComponentError, match="across"):
        section_orientations(Arc(1.0).at(np.array([0.0, 1.0]))[1], (1.0, 0.0, 0.0))
