"""The static search before a run: uneven stiffnesses, and scenes without an equilibrium."""

from __future__ import annotations

import numpy as np
import pytest

from fmus import native_library
from orchestrator.assembly import Part
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from orchestrator.cosim.settings import Settings
from orchestrator.cosim.static_search import _described, _motion
from orchestrator.cosim.stepping import StepError
from orchestrator.results.recorder import NoRecorder
from orchestrator.run.run import as_fmus, run
from orchestrator.scene import find_scene, load_scene
from tests.references.coupled import base, between, rigid, turned
from tests.references.random_wings import load_wing

PRELOAD = 80.0


@pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")
@pytest.mark.parametrize(
    ("axial", "radial"),
    [("1e4", "1e9"), ("1e7", "1e9"), ("1e9", "1e4"), ("161343", "57132832"), ("1e4", "1e4")],
)
def test_any_stiffnesses_of_the_joints(axial, radial):
    """Closed form: the loops' 80 N are internal loads, so nothing is left at the base of a wing at rest.

    The iteration ends at 1e-6 of the largest wrench; a share of 1e-5 allows for the sum over its hinges and loops.
    """
    settings = (f"joint.axial_stiffness={axial}", f"joint.radial_stiffness={radial}")
    assembly = assemble(load_scene(find_scene("amos3"), (), settings), (), ())
    with as_fmus(assembly) as participants:
        network = Network(participants, assembly.links)
        Master(network, assembly.hinge_lines, NoRecorder(), Settings()).initialize(preload=True)
        spacecraft = network.by_name["spacecraft"]
        found, at = spacecraft.observe(), spacecraft.observation_layout
        assert np.abs(found[at["interface_force"]]).max() < 1e-5 * PRELOAD
        assert np.abs(found[at["interface_torque"]]).max() < 1e-5 * PRELOAD


def test_free_motion_is_named():
    """A body that slides along z under gravity: body, direction and size."""
    body = rigid("load", 2.0, (0.1, 0.1, 0.1), {"top": (0.0, 0.0, 0.0)}, gravity=(0.0, 0.0, -9.8))
    stiffness = {"translational_stiffness": (1e6, 1e6, 0.0), "rotational_stiffness": (1e4,) * 3}
    parts = [base(root=(0.0, 0.0, 0.0)), body, Part("joint", "hinge", {}, stiffness)]
    network = Network(in_process(parts), between("joint", "base.root", "load.top"))
    master = Master(network, (), NoRecorder(), Settings())
    with pytest.raises(StepError, match=r"load .*\(0, 0, -1\).* 9.8 m/s2"):
        master.initialize(preload=True)


def test_free_rotation_is_named():
    """Closed form: small turns about an axis keep it, and in h seconds an acceleration a turns by a h^2."""
    before = np.array((1.0, 2.0, 3.0, *turned((0.0, 0.6, 0.8), 0.7)))
    after = np.array((1.0, 2.0, 3.0, *turned((0.0, 0.6, 0.8), 0.702)))
    assert _described(_motion(before, after), 0.1) == "about (0, 0.6, 0.8), by 0.2 rad/s2"


@pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")
@pytest.mark.parametrize("seed", [26, 402])
def test_softly_held_bodies_start_at_rest(seed):
    """Conservation law: preload is internal, so at rest the base carries the weight of all and no more.

    The joints of these random wings give way by millimetres, and the search by steps crept towards equilibrium: 402
    began with 2.6 N on its base, and at another place at every tolerance.
    """
    scene = load_wing(seed)
    found = run(assemble(scene), None, Settings(1e-4, 0.02), 1e-5)
    weight = sum(body.rigid.mass for body in scene.bodies) * np.array(scene.header.gravity)
    load = found.result.signal(scene.base.name, "interface_force")[0]
    assert found.restless == ""
    assert np.abs(load - weight).max() < 1e-4


def test_what_does_not_come_to_rest_is_told():
    """A pendulum of 0.05 Hz: the search takes steps of at most 0.12 s, and does not call that rest."""
    body = rigid("load", 2.0, (0.1, 0.1, 0.1), {"top": (0.0, 0.0, 0.0)}, gravity=(0.0, 0.0, -0.1))
    soft = 2.0 * (2.0 * np.pi * 0.05) ** 2
    stiffness = {"translational_stiffness": (1e6, 1e6, soft), "rotational_stiffness": (1e4,) * 3}
    parts = [base(root=(0.0, 0.0, 0.0)), body, Part("joint", "hinge", {}, stiffness)]
    network = Network(in_process(parts), between("joint", "base.root", "load.top"))
    master = Master(network, (), NoRecorder(), Settings())
    master.initialize(preload=True)
    assert "(0, 0, -1)" in master.statistics.restless
