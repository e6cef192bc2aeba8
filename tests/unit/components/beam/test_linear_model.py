"""Beams in small motion: the energies of the component to second order, and closed forms of vibration."""

import numpy as np
import pytest
from scipy import linalg

from components.beam import Beam
from components.beam_parts.linear_model import linear_model
from components.contract.frames import exponential, multiply, rotation_matrix
from components.flexible.finite_elements import FiniteElementModel
from tests.unit.components.beam.beam_cases import STEEL_LINK, positions, wrenches
from tests.unit.components.prepared import prepared

LENGTH = 0.6


def test_its_energies_are_those_of_the_component_to_second_order():
    """Two formulations: energies of small motions of the curved example by the component, and u^T K u / 2, v^T M v / 2.

    What is of third order and odd falls out of the mean over u and -u, what is left is of the order of u^4.
    """
    beam = Beam.example()
    c, section = prepared(beam), beam._section
    x = beam.initial(c, wrenches(beam))
    at = beam.state_layout
    turns = x[at["orientation"]].reshape(-1, 4)
    directors = np.array([rotation_matrix(tuple(q)) for q in turns])
    model = linear_model(positions(beam, x), directors, section._replace(inertia_x=0.11), {})
    u = np.random.default_rng(3).standard_normal((len(turns), 6))

    def energies(size: float) -> tuple[float, float]:
        moved = x.copy()
        moved[at["position"]] += size * u[:, :3].ravel()
        moved[at["orientation"]] = np.array(
            [multiply(exponential(tuple(size * r)), tuple(q)) for r, q in zip(u[:, 3:], turns, strict=True)]
        ).ravel()
        moved[at["velocity"]] = u[:, :3].ravel()
        moved[at["angular_velocity"]] = np.einsum("nji,nj->ni", directors, u[:, 3:]).ravel()
        seen = beam.observe(c, moved, wrenches(beam))
        of = beam.observation_layout
        return float(seen[of["potential_energy"]][0]), float(seen[of["kinetic_energy"]][0])

    size, flat = 1e-4, u.ravel()
    strain = 0.5 * (energies(size)[0] + energies(-size)[0]) / size**2
    assert strain == pytest.approx(0.5 * flat @ (model.stiffness @ flat), rel=1e-6)
    # the component's example has 0.1 and not 0.11 kg m about x, which a flat section could not
    about_x = np.einsum("nji,nj->ni", directors, u[:, 3:])[:, 0]
    halves = 0.5 * (np.append(beam.elements.lengths, 0.0) + np.append(0.0, beam.elements.lengths))
    kinetic = 0.5 * flat @ (model.mass_matrix @ flat) - 0.5 * 0.01 * halves @ about_x**2
    assert energies(0.0)[1] == pytest.approx(kinetic, rel=1e-12)


def steel_link(elements: int) -> FiniteElementModel:
    """The link of 600 mm, thin along z."""
    line = np.linspace((0.0, 0.0, 0.0), (LENGTH, 0.0, 0.0), elements + 1)
    return linear_model(
        line, np.repeat(np.eye(3)[None], elements + 1, 0), STEEL_LINK, {"a": 0, "b": elements}
    )


def frequencies(model: FiniteElementModel, held: list[int]) -> np.ndarray:
    """Hz, with some degrees of freedom held."""
    free = np.setdiff1d(np.arange(model.stiffness.shape[0]), held)
    square = linalg.eigh(
        model.stiffness.toarray()[np.ix_(free, free)],
        model.mass_matrix.toarray()[np.ix_(free, free)],
        eigvals_only=True,
    )
    return np.sqrt(np.maximum(square, 0.0)) / (2.0 * np.pi)


def pinned(bending: float, inertia: float) -> float:
    """Closed form, Hz: the lowest sine of a pinned Timoshenko beam, deflection w and rotation th in proportion."""
    shear, k = STEEL_LINK.shear_y, np.pi / LENGTH
    stiffness = np.array([[shear * k * k, -shear * k], [-shear * k, bending * k * k + shear]])
    square = linalg.eigh(stiffness, np.diag((STEEL_LINK.line_mass, inertia)), eigvals_only=True)[0]
    return float(np.sqrt(square) / (2.0 * np.pi))


def test_the_link_vibrates_as_a_timoshenko_beam_does():
    """Closed form pinned, thin and thick; antenna design: 129.8 Hz pinned and 292.6 Hz free within 0.5 %.

    Its 259.5 Hz of the thick side are those of Euler and Bernoulli, of which shear takes 0.7 %. Elements
    of length h err by (k h)^2 / 8, two thirds of it by their masses: 7.7e-4 for 40, free 1.7e-3.
    """
    model = steel_link(40)
    last = model.stiffness.shape[0] - 6
    found = frequencies(model, [0, 1, 2, 3, last + 1, last + 2])[:2]
    section = STEEL_LINK
    thin, thick = pinned(section.bending_y, section.inertia_y), pinned(section.bending_z, section.inertia_z)
    assert found == pytest.approx([thin, thick], rel=8e-4)
    assert found[0] == pytest.approx(129.8, rel=5e-3)
    free = frequencies(model, [])
    assert free[5] < 1.0
    assert free[6] == pytest.approx(292.6, rel=5e-3)


def test_rigid_motions_strain_nothing():
    """Invariance: of a curved beam, to round-off of the stiffness."""
    beam = Beam.example()
    x = beam.initial(prepared(beam), wrenches(beam))
    directors = np.array(
        [rotation_matrix(tuple(q)) for q in x[beam.state_layout["orientation"]].reshape(-1, 4)]
    )
    model = linear_model(positions(beam, x), directors, beam._section, {})
    assert np.abs(model.stiffness @ model.rigid_motions).max() < 1e-13 * np.abs(model.stiffness).max()
