"""A beam under the master, as native FMU: a joint of order 4 meets ports of order 2."""

from math import atan2

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrator.assembly import Part
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
