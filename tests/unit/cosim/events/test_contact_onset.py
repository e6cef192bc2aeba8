"""Stops and contacts that a light part strikes: their loads are judged beside the energy of what strikes them."""

from __future__ import annotations

from math import sqrt

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from orchestrator.cosim.settings import Settings
from orchestrator.scene import load_scene
from tests.references.coupled import mastered
from tests.references.coupling_parts import call
from tests.references.native_fmus import needs_native

HEAVY_AND_LIGHT = """
[scene]
name = "heavy_and_light"
until = 4.0
tolerance = 1e-3

[base]
points = { left = [0, 0.15, 0], right = [0, -0.15, 0] }

[joint]
axial_stiffness = 2.4e7
radial_stiffness = 4e6
cross_stiffness = 9.5e4
damping_ratio = 0.054
damping_frequency = 218

[[body]]
name = "heavy"
[body.rigid]
mass = 49
center_of_mass = [0.63, 0, 0]
inertia = [0.55, 14, 14]
points = { left = [0, 0.15, 0], right = [0, -0.15, 0], tip = [1.85, 0, 0] }

[[body]]
name = "light"
[body.rigid]
mass = 1.8
center_of_mass = [0.32, -0.05, 0]
inertia = [0.11, 0.095, 0.2]
points = { root = [0, 0, 0] }

[[hinge_line]]
name = "L0"
inboard = "base"
outboard = "heavy"
axis = "+y"
aligned_angle = "135 deg"
hinges = [
  { name = "l", inboard = "left", outboard = "left" },
  { name = "r", inboard = "right", outboard = "right", kind = "cylindrical" },
]
motor = { stowed = 6.1, deployed = 2.7 }
end_stop = { stiffness = 2e4 }

[[hinge_line]]
name = "L1"
inboard = "heavy"
outboard = "light"
axis = "-y"
aligned_angle = "180 deg"
hinges = [{ name = "elbow", inboard = "tip", outboard = "root" }]
motor = { stowed = 0.21, deployed = 0.17 }
end_stop = { stiffness = 120, damping = 7.8 }
"""
"""The light body's damped stop pushes in full 1 mrad after it is touched, 0.3 ms; steps are 1 ms long before it."""

MASS, INERTIA, LEVER, STIFFNESS = 2.0, 0.3, 0.8, 5e4
BAR = f"""
[scene]
name = "bar"
until = 1.0

[base]
points = {{ root = [0, 0, 0], pad = [0, 0, 0.5] }}

[[body]]
name = "bar"
[body.rigid]
mass = {MASS}
center_of_mass = [0.4, 0, 0]
inertia = [0.01, {INERTIA}, {INERTIA}]
points = {{ root = [0, 0, 0], tip = [{LEVER}, 0, 0] }}

[[hinge_line]]
name = "HL"
inboard = "base"
outboard = "bar"
axis = "+y"
aligned_angle = "90 deg"
hinges = [{{ name = "hinge", inboard = "root", outboard = "root" }}]

[[connection]]
name = "pad"
kind = "contact"
structure = {{ normal = [1, 0, 0] }}
ports = {{ inboard = {{ body = "base", point = "pad" }}, outboard = {{ body = "bar", point = "tip" }} }}
parameters = {{ gap = 1e-3, reference_force = {STIFFNESS * 1e-3}, reference_penetration = 1e-3, exponent = 1 }}
"""
"""Folded along z, its tip 1 mm in the plane that it would strike across."""
STEP = 1e-4


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    path = tmp_path_factory.mktemp("strikes") / "heavy_and_light.toml"
    path.write_text(HEAVY_AND_LIGHT, encoding="utf-8")
    return path


def elbow_force(scene, tolerance):
    """Largest force (N) at the hinge between both bodies, from where the light one strikes its stop."""
    result = fanfold.simulate(scene, tolerance=tolerance, estimate=False)
    return result.headline.hinge_force_peaks["elbow"]


@pytest.mark.filterwarnings("ignore:.*W-not-opened", "ignore:.*W-no-end")
def test_loads_of_a_light_body_that_strikes_are_resolved(scene):
    """Convergence, to ten tolerances. Regression: steps over the pulse, 22 % too low."""
    assert elbow_force(scene, 1e-3) == pytest.approx(elbow_force(scene, 1e-5), rel=1e-2)


@needs_native
def test_a_contact_has_the_inertia_of_what_strikes_it(tmp_path):
    """Closed form: the root of stiffness times lever squared over the inertia about the hinge."""
    path = tmp_path / "bar.toml"
    path.write_text(BAR, encoding="utf-8")
    assembly = assemble(load_scene(path))
    network = Network(in_process(assembly.parts), assembly.links)
    master = mastered(network, Settings(order=2)).master
    master.initialize(preload=False)
    found = np.zeros(3)
    assert call("struck", master.coupling, network.participants.index(network.by_name["pad"]), STEP, found)
    about_hinge = INERTIA + MASS * 0.4**2
    assert found[:2] == pytest.approx((0, STIFFNESS), rel=1e-6)
    assert found[2] == pytest.approx(sqrt(STIFFNESS * LEVER**2 / about_hinge), rel=1e-2)
