"""Laminates against closed forms."""

import numpy as np
import pytest

from components.flexible.laminate import Layer, laminate_stiffness

E1, E2, NU, G = 130e9, 9e9, 0.3, 5e9


def ply(angle, thickness=0.125e-3):
    return Layer(thickness, E1, E2, NU, G, np.radians(angle))


def test_one_isotropic_layer():
    """Closed form: D = E t³ / 12 (1 - nu²), A = E t / (1 - nu²), whatever the angle."""
    for angle in (0.0, 33.0):
        layer = Layer(2e-3, 70e9, 70e9, 0.3, 70e9 / 2.6, np.radians(angle))
        bending, membrane, problem = laminate_stiffness([layer])
        plane = 70e9 / 0.91
        np.testing.assert_allclose(membrane, plane * 2e-3 * np.array([1, 1, 0.3, 0.35]), rtol=1e-12)
        np.testing.assert_allclose(bending, plane * 8e-9 / 12 * np.array([1, 1, 0.3, 0.35]), rtol=1e-12)
        assert problem == ""


def test_cross_ply():
    """Closed form (Jones 1999, 4.3): 0/90/90/0 has seven eighths of the bending stiffness from its outer plies."""
    bending, membrane, problem = laminate_stiffness([ply(a) for a in (0, 90, 90, 0)])
    scale = 1.0 - NU**2 * E2 / E1
    q11, q22 = E1 / scale, E2 / scale
    thickness = 0.5e-3
    np.testing.assert_allclose(membrane[:2], [thickness * (q11 + q22) / 2] * 2, rtol=1e-12)
    own = thickness**3 / 12
    np.testing.assert_allclose(
        bending[:2], [own * (7 * q11 + q22) / 8, own * (7 * q22 + q11) / 8], rtol=1e-12
    )
    np.testing.assert_allclose([bending[3], membrane[3]], [own * G, thickness * G], rtol=1e-12)
    assert problem == ""


def test_quasi_isotropic_membrane():
    """Symmetry: 0/45/-45/90 mirrored is isotropic in its plane; it twists when bent, which is told."""
    _, membrane, problem = laminate_stiffness([ply(a) for a in (0, 45, -45, 90, 90, -45, 45, 0)])
    assert membrane[0] == pytest.approx(membrane[1], rel=1e-12)
    assert membrane[3] == pytest.approx((membrane[0] - membrane[2]) / 2, rel=1e-12)
    assert "twist" in problem


@pytest.mark.parametrize(
    ("angles", "told"), [((0, 90), "not symmetric"), ((30,), "not balanced"), ((45, -45), "not symmetric")]
)
def test_other_laminates_are_told(angles, told):
    """Messages: what an orthotropic plate does not do."""
    assert told in laminate_stiffness([ply(a) for a in angles])[2]


def test_core_and_skins():
    """Closed form: thin skins on a core without stiffness of its own, by parallel axes."""
    skin, core = Layer(0.2e-3, 70e9, 70e9, 0.3, 27e9), Layer(0.02, 1.0, 1.0, 0.0, 1.0)
    bending, _, problem = laminate_stiffness([skin, core, skin])
    expected = 2 * 70e9 / 0.91 * (0.2e-3 * 0.0101**2 + 0.2e-3**3 / 12)
    assert bending[0] == pytest.approx(expected, rel=1e-9)
    assert problem == ""
