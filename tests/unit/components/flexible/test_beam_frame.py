"""Beams and frames against closed forms."""

import numpy as np
import pytest

from components.contract.component import ComponentError
from components.flexible.beam_frame import BeamSection, Member, beam_frame, tube_section
from components.flexible.reduction import craig_bampton, fixed_interface_frequencies, free_frequencies

CLAMPED_CLAMPED = np.array([22.3733, 61.6728, 120.903])
CLAMPED_FREE = np.array([3.51602, 22.0345, 61.6972])
SECTION = BeamSection(1e9, 1000.0, 3000.0, 700.0, 1.3, 1e-4)


def slanted_beam(elements=20, section=SECTION):
    """Beam of length 1.5 m in a general direction."""
    tip = 1.5 * np.array([0.6, -0.48, 0.64])
    return beam_frame({"root": (0.0, 0.0, 0.0), "tip": tip}, [Member("root", "tip", section, elements)])


def bending(coefficients, stiffness, length=1.5, line_mass=1.3):
    return np.asarray(coefficients) * np.sqrt(stiffness / line_mass) / length**2


def test_clamped_at_both_attachment_points():
    """Closed form: (bL)^2 = 22.3733, 61.6728, 120.903 are the fixed-interface modes of either plane."""
    found = fixed_interface_frequencies(slanted_beam(), ["root", "tip"], 5)
    both = np.sort(np.concatenate([bending(CLAMPED_CLAMPED, 1000.0), bending(CLAMPED_CLAMPED, 3000.0)]))[:5]
    np.testing.assert_allclose(found, both, rtol=1e-4)


def test_clamped_at_one_attachment_point():
    """Closed form: a cantilever, (bL)^2 = 3.51602, 22.0345, 61.6972."""
    found = fixed_interface_frequencies(slanted_beam(), ["root"], 6)
    both = np.sort(np.concatenate([bending(CLAMPED_FREE, 1000.0), bending(CLAMPED_FREE, 3000.0)]))
    np.testing.assert_allclose(found, both, rtol=1e-4)


def test_free_modes_and_their_reduction():
    """Closed form: free-free equals clamped-clamped; a reduction with 8 modes a plane keeps the first two."""
    model = slanted_beam()
    exact = np.sort(np.concatenate([bending(CLAMPED_CLAMPED, 1000.0), bending(CLAMPED_CLAMPED, 3000.0)]))
    np.testing.assert_allclose(free_frequencies(model, 5), exact[:5], rtol=1e-4)
    reduced = craig_bampton(model, ["root", "tip"], 16)
    np.testing.assert_allclose(reduced.frequency[:4], exact[:4], rtol=1e-3)


def test_twist_and_stretch():
    """Closed form: clamped rods, n pi / L sqrt(GJ / (m r^2)) and n pi / L sqrt(EA / m)."""
    soft = BeamSection(2e4, 1e7, 1e7, 50.0, 1.3, 0.1)
    found = fixed_interface_frequencies(slanted_beam(100, soft), ["root", "tip"], 6)
    twist = np.arange(1, 7) * np.pi / 1.5 * np.sqrt(50.0 / (1.3 * 0.1**2))
    stretch = np.arange(1, 7) * np.pi / 1.5 * np.sqrt(2e4 / 1.3)
    np.testing.assert_allclose(found, np.sort(np.concatenate([twist, stretch]))[:6], rtol=2e-3)


def test_right_angle_under_a_normal_load():
    """Castigliano: the tip of a right angle moves by P (a^3 + b^3) / 3 EI + P a b^2 / GJ."""
    a, b, load = 0.8, 0.5, 10.0
    joints = {"root": (0, 0, 0), "knee": (a, 0, 0), "tip": (a, b, 0)}
    model = beam_frame(joints, [Member("root", "knee", SECTION, 3), Member("knee", "tip", SECTION, 2)])
    free = np.setdiff1d(np.arange(model.stiffness.shape[0]), model.attachment_dofs["root"])
    force = np.zeros(model.stiffness.shape[0])
    force[model.attachment_dofs["tip"][2]] = load
    motion = np.zeros_like(force)
    motion[free] = np.linalg.solve(model.stiffness[free][:, free].toarray(), force[free])
    expected = load * (a**3 + b**3) / (3 * 1000.0) + load * a * b**2 / 700.0
    assert motion[model.attachment_dofs["tip"][2]] == pytest.approx(expected, rel=1e-9)


def test_mass_properties_of_a_tube():
    """Closed form: m = rho A L, about the axis m (R^2 + r^2) / 2, across m (L^2/12 + (R^2 + r^2)/4)."""
    section = tube_section(0.1, 0.01, 70e9, 26e9, 2700.0)
    model = beam_frame({"a": (0, 0, 0), "b": (0, 2.0, 0)}, [Member("a", "b", section, 3)])
    mass = 2700.0 * np.pi * (0.05**2 - 0.04**2) * 2.0
    squares = 0.05**2 + 0.04**2
    across = mass * (4.0 / 12.0 + squares / 4.0)
    assert model.mass == pytest.approx(mass)
    np.testing.assert_allclose(model.center_of_mass, [0.0, 1.0, 0.0], atol=1e-14)
    np.testing.assert_allclose(model.inertia, np.diag([across, mass * squares / 2.0, across]), atol=1e-12)


def test_lumped_masses_count():
    """Bookkeeping: a mass at a joint moves the centre of mass and lowers the first mode."""
    joints = {"a": (0, 0, 0), "b": (1, 0, 0)}
    light, heavy = (beam_frame(joints, [Member("a", "b", SECTION, 6)], m) for m in (None, {"b": 1.3}))
    assert heavy.center_of_mass[0] == pytest.approx(0.75)
    # a tip mass equal to the beam's: tip mass + 33/140 of the beam on 3 EI / L^3, within 1 %
    estimate = np.sqrt(3 * 1000.0 / (1.3 + 33 / 140 * 1.3))
    assert fixed_interface_frequencies(heavy, ["a"], 1)[0] == pytest.approx(estimate, rel=0.01)
    assert light.mass == pytest.approx(1.3)


def test_member_between_unknown_joints():
    """The message says which member."""
    with pytest.raises(ComponentError, match="'a' to 'c'"):
        beam_frame({"a": (0, 0, 0), "b": (1, 0, 0)}, [Member("a", "c", SECTION)])
