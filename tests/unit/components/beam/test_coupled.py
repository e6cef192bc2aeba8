"""A beam under the master, as native FMU: a joint of order 4 meets ports of order 2."""

from math import atan2

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from components.beam import Beam
from components.beam_parts.sections import Material, rectangle
from components.beam_parts.variables import Section
from components.contract.frames import quaternion_of_axes
from orchestrator.assembly import Link, Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import base, between, completed
from tests.references.native_fmus import needs_native
from tests.unit.components.beam.beam_cases import STEEL_LINK, straight

LENGTH, GRAVITY, UNTIL = 0.6, 9.81, 0.4


@needs_native
def test_a_link_swings_like_a_rod():
    """Independent solution: a rigid rod on a pin, J th'' = m g L / 2 cos th; and conservation of all energies together.

    J = m L^2 / 3 with the rotary inertia of the section. The joint gives by m g / k = 7e-6 m, of the length 1e-5; the
    link bends by less.
    """
    link = straight((0, 0, 0), (LENGTH, 0, 0), 8, STEEL_LINK, {"pin": 0})
    parts = [
        base(pin=(0, 0, 0)),
        Part("link", link.kind, dict(link.structure), {"gravity": (0.0, 0.0, -GRAVITY)}),
        Part(
            "joint",
            "hinge",
            {},
            {"translational_stiffness": (5e6,) * 3, "translational_damping": (4000.0,) * 3},
        ),
    ]
    run = completed(UNTIL, parts, between("joint", "base.pin", "link.pin"), native=True)
    weight = STEEL_LINK.line_mass * LENGTH * GRAVITY
    inertia = STEEL_LINK.line_mass * LENGTH**3 / 3.0 + STEEL_LINK.inertia_y * LENGTH

    def swing(t, y):
        return y[1], 0.5 * weight * LENGTH / inertia * np.cos(y[0])

    rod = solve_ivp(swing, (0.0, UNTIL), (0.0, 0.0), rtol=1e-10, atol=1e-12)
    tip = run.signal("link", "node_position")[-1, -3:]
    assert atan2(-tip[2], tip[0]) == pytest.approx(rod.y[0, -1], rel=5e-5)
    kinetic = run.signal("link", "kinetic_energy")
    stored = kinetic + run.signal("link", "potential_energy") + run.signal("joint", "potential_energy")
    total = stored + run.signal("joint", "dissipated_energy") + run.signal("joint", "numerical_dissipation")
    assert np.abs(total - total[0]).max() < 1e-6 * kinetic.max()


def bend_of_45_degrees(elements: int) -> Beam:
    """An eighth of a circle of radius 100 about (100, 0, 0) from the origin along y, section 1 x 1, E 1e7."""
    nodes = []
    for angle in np.linspace(0.0, np.pi / 4.0, elements + 1).tolist():
        s, c = float(np.sin(angle)), float(np.cos(angle))
        turn = quaternion_of_axes((s, c, 0.0), (-c, s, 0.0), (0.0, 0.0, 1.0))
        nodes.append({"position": (100.0 * (1.0 - c), 100.0 * s, 0.0), "orientation": turn})
    bending, shear = 8.33333e5, 4.16667e6
    section = Section(1e7, shear, shear, bending, bending, bending, 1.0, 0.2, 0.1, 0.1)
    return Beam(nodes, section._asdict(), [{"name": "root", "node": 0}, {"name": "tip", "node": elements}])


@needs_native
def test_a_clamped_curved_beam_bends_and_twists_as_published():
    """Published: 45 degree bend of Bathe and Bolourchi with 600 N across its plane, 16 elements.

    GXBeam has (-13.577, -23.545, 53.458) with a shear stiffness of 5e6 N in place of 4.16667e6, which is 0.02 of it.
    The load comes in 40 s, and strong damping brings the beam to rest.
    """
    beam = bend_of_45_degrees(16)
    force = [{"profile": "step5", "start": 0.0, "duration": 40.0, "change": 600.0}]
    clamp = {"translational_stiffness": (1e9,) * 3, "rotational_stiffness": (1e10,) * 3}
    parts = [
        base(clamp=(0, 0, 0)),
        Part("beam", beam.kind, dict(beam.structure), {"stiffness_damping": 4.0}),
        Part("clamp", "hinge", {}, clamp),
        Part("load", "load", {"force": force}, {}),
    ]
    links = [*between("clamp", "base.clamp", "beam.root"), Link(("beam", "tip"), ("load", "body"))]
    run = completed(90.0, parts, links, native=True, settings=Settings(fixed_step=0.1))
    tip = run.signal("beam", "node_position")[:, -3:]
    assert np.abs(tip[-1] - tip[-30]).max() < 1e-3
    assert tip[-1] - tip[0] == pytest.approx((-13.577, -23.545, 53.458), abs=0.03)


PRINCETON = rectangle(12.3777e-3, 3.2024e-3, Material(71.7e9, 71.7e9 / 2.62, 2700.0))
"""Bauchau et al., Multibody System Dynamics 2016: aluminium, 508 mm long, the chord along y."""


@needs_native
@pytest.mark.parametrize(
    ("newton", "angle", "chord", "flap"),
    [(8.896, 90.0, 0.0, 146.1), (13.345, 45.0, 15.31, 156.4)],
)
def test_princeton_beam(newton, angle, chord, flap):
    """Published: a cantilever under a tip load at an angle, which bends and twists; mm, within 0.5 %.

    Our design's numbers, between those of ANSYS's beam elements and Exudyn's, which are 1.3 and 2.4 % apart along the
    chord. The load comes in a second, ten periods, and the first mode is damped critically.
    """
    beam = straight((0, 0, 0), (0.508, 0, 0), 16, PRINCETON, {"root": 0, "tip": 16})
    across = (0.0, float(np.cos(np.radians(angle))), float(np.sin(np.radians(angle))))
    force = [{"profile": "step5", "start": 0.0, "duration": 1.0, "change": newton}]
    clamp = {"translational_stiffness": (1e8,) * 3, "rotational_stiffness": (1e6,) * 3}
    parts = [
        base(clamp=(0, 0, 0)),
        Part("beam", beam.kind, dict(beam.structure), {"stiffness_damping": 0.03}),
        Part("clamp", "hinge", {}, clamp),
        Part("load", "load", {"force": force, "direction": across}, {}),
    ]
    links = [*between("clamp", "base.clamp", "beam.root"), Link(("beam", "tip"), ("load", "body"))]
    run = completed(2.0, parts, links, native=True, settings=Settings(fixed_step=0.02))
    tip = 1e3 * run.signal("beam", "node_position")[:, -3:]
    assert np.abs(tip[-1] - tip[-10]).max() < 1e-3 * flap
    assert tip[-1, 1] == pytest.approx(chord, rel=5e-3, abs=1e-3)
    assert tip[-1, 2] == pytest.approx(flap, rel=5e-3)
