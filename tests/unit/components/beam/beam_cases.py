"""Beams for tests, and how they are stepped."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from components.beam import Beam
from components.beam_parts.variables import Section
from orchestrator.assembly import Part
from orchestrator.assembly.statics.placed_beam import PlacedBeam
from tests.unit.components.prepared import prepared

STEEL_LINK = Section(
    axial=207e9 * 8e-4, shear_y=5 / 6 * 80.2e9 * 8e-4, shear_z=5 / 6 * 80.2e9 * 8e-4, torsion=5877.0,
    bending_y=5520.0, bending_z=22080.0, line_mass=6.2408, inertia_x=1.04e-3, inertia_y=2.08e-4, inertia_z=8.32e-4,
)  # fmt: skip
"""20 x 40 mm, the links of the antenna unit."""


def slender(bending: float, stiff: float = 1e6) -> Section:
    """Section that bends, and hardly stretches or shears."""
    return Section(stiff, stiff, stiff, bending, bending, bending, 1.0, 0.02, 0.01, 0.01)


def straight(
    start: Sequence[float], end: Sequence[float], elements: int, section: Section, ports: Mapping[str, int]
) -> Beam:
    """A straight beam of equal elements with ports at nodes by name; its y axis is the world's where it is normal."""
    line = np.linspace(start, end, elements + 1)
    x = (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])
    angle = float(np.arctan2(-x[2], x[0]))
    turn = (np.cos(0.5 * angle), 0.0, np.sin(0.5 * angle), 0.0)
    nodes = [{"position": tuple(p), "orientation": turn} for p in line.tolist()]
    return Beam(nodes, section._asdict(), [{"name": name, "node": node} for name, node in ports.items()])


def wrenches(beam: Beam, **by_port: Sequence[float]) -> np.ndarray:
    """Inputs with forces and torques (6,) at ports by name, zero at all others."""
    u = beam.input_layout.start_values()
    for name, wrench in by_port.items():
        u[beam.input_layout[f"{name}.force"]] = wrench[:3]
        u[beam.input_layout[f"{name}.torque"]] = wrench[3:]
    return u


def at_rest(beam: Beam, loads: Sequence[np.ndarray], h: float, relaxing: int = 3) -> np.ndarray:
    """State at rest under the last of some loads, applied one after the other; then so many times more.

    By implicit steps (s) of the motion from rest, so that what is free stays.
    """
    placed = PlacedBeam(Part("beam", "beam", beam.structure, {}))
    for u in [*loads, *[loads[-1]] * relaxing]:
        wrench = u.reshape(-1, 6)
        for _ in range(25):
            tangent = placed.stiffness(wrench) + placed.mass() / h**2
            step = np.linalg.solve(tangent, placed.forces(wrench))
            placed.move(step * min(1.0, 0.1 / max(np.abs(step.reshape(-1, 6)[:, 3:]).max(), 1e-300)))
    c = prepared(beam, **placed.bent_from((1.0, 0.0, 0.0, 0.0)))
    return beam.initial(c, loads[0])


def positions(beam: Beam, x: np.ndarray) -> np.ndarray:
    """Positions of the nodes (n, 3)."""
    return x[beam.state_layout["position"]].reshape(-1, 3)


def observed(beam: Beam, c: object, x: np.ndarray, name: str) -> np.ndarray:
    """An observation by name."""
    return beam.observe(c, x, beam.input_layout.start_values())[beam.observation_layout[name]]


def energy(beam: Beam, c: object, x: np.ndarray) -> float:
    """Kinetic and potential energy, J."""
    return float(observed(beam, c, x, "kinetic_energy")[0] + observed(beam, c, x, "potential_energy")[0])
