"""Sections against published values and closed forms."""

import pytest

from components.beam_parts.sections import Material, rectangle, round_section
from components.flexible.beam_frame import tube_section
from tests.unit.components.beam.beam_cases import STEEL_LINK

STEEL = Material(207e9, 80.2e9, 7801.0)


def test_the_link_of_the_antenna():
    """Data sheet: EA, EI, GJ and mass of the steel link, 20 mm along z and 40 mm along y; five digits are given."""
    found = rectangle(0.04, 0.02, STEEL)
    for name, value in STEEL_LINK._asdict().items():
        assert getattr(found, name) == pytest.approx(value, rel=2e-3), name
    assert found.torsion == rectangle(0.02, 0.04, STEEL).torsion


@pytest.mark.parametrize(("ratio", "constant"), [(1.0, 0.1406), (1.5, 0.196), (2.0, 0.229), (10.0, 0.312)])
def test_torsion_of_rectangles(ratio, constant):
    """Published: Timoshenko and Goodier, Theory of Elasticity, table of k1 in J = k1 a b^3."""
    found = rectangle(ratio, 1.0, Material(1.0, 1.0, 1.0))
    assert found.torsion / ratio == pytest.approx(constant, abs=6e-4)


def test_round_sections():
    """Same closed forms as frames of beams have; Cowper's shear factors of a circle and of a thin ring at 0.3."""
    material = Material(2.6, 1.0, 3.0)
    tube, other = round_section(0.05, 0.044, material), tube_section(0.05, 0.003, 2.6, 1.0, 3.0)
    for name in ("axial", "bending_y", "bending_z", "torsion", "line_mass"):
        assert getattr(tube, name) == pytest.approx(getattr(other, name), rel=1e-12), name
    assert tube.inertia_x == pytest.approx(other.line_mass * other.gyration_radius**2, rel=1e-12)
    circle, thin = round_section(1.0, 0.0, material), round_section(1.0, 1.0 - 1e-9, material)
    assert circle.shear_y / (circle.axial / 2.6) == pytest.approx(6 * 1.3 / (7 + 6 * 0.3), rel=1e-12)
    assert thin.shear_z / (thin.axial / 2.6) == pytest.approx(2 * 1.3 / (4 + 3 * 0.3), rel=1e-6)
    assert round_section(1.0, 0.0, material, 0.5).shear_y == pytest.approx(0.5 * circle.axial / 2.6)
