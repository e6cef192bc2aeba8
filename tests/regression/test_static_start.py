"""The static equilibrium before a run: uneven stiffnesses, soft ones, and scenes without an equilibrium."""

from __future__ import annotations

import numpy as np
import pytest

import orchestrator as fanfold
from fmus import native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.start import static_start
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.settings import Settings
from orchestrator.results.recorder import NoRecorder
from orchestrator.run.run import as_fmus, run
from orchestrator.scene import find_scene, load_scene
from tests.references.random_wings import load_wing

PRELOAD = 80.0


@pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")
@pytest.mark.parametrize(
    ("axial", "radial"),
    [("1e4", "1e9"), ("1e7", "1e9"), ("1e9", "1e4"), ("161343", "57132832"), ("1e4", "1e4")],
)
def test_any_stiffnesses_of_the_joints(axial, radial):
    """Closed form: the loops' 80 N are internal loads, so nothing is left at the base of a wing at rest."""
    settings = (f"joint.axial_stiffness={axial}", f"joint.radial_stiffness={radial}")
    assembly = static_start(assemble(load_scene(find_scene("amos3"), (), settings), (), ())).assembly
    with as_fmus(assembly) as participants:
        network = Network(participants, assembly.links)
        master = Master(network, assembly.hinge_lines, NoRecorder(), Settings())
        master.initialize(preload=True)
        at = [number for number, (body, _) in enumerate(network.port_names) if body == "spacecraft"]
        wrenches = master.coupling.accepted.reshape(-1, 6)[at]
        motions = network.by_name["spacecraft"].outputs[: 13 * len(at)].reshape(-1, 13)
        moment = wrenches[:, 3:] + np.cross(motions[:, :3], wrenches[:, :3])
        assert np.abs(wrenches[:, :3].sum(0)).max() < 1e-7 * PRELOAD
        assert np.abs(moment.sum(0)).max() < 1e-7 * PRELOAD


def sliding(stiffness, gravity):
    """A body of 2 kg on a joint that is soft along z, or has no stiffness there."""
    scene = fanfold.Scene("sliding", until="1 ms", preload=True, gravity=(0, 0, -gravity))
    scene.base("wall", points={"p": (0, 0, 0)})
    load = {"mass": 2, "center_of_mass": (0, 0, 0), "inertia": (0.1, 0.1, 0.1), "points": {"p": (0, 0, 0)}}
    scene.body("load", rigid=load, place={"body": "wall", "point": "p"})
    springs = {
        "translational_stiffness": (1e6, 1e6, stiffness),
        "rotational_stiffness": (1e4,) * 3,
        "hold_stiffness": 0.0,
    }
    ports = {"inboard": ("wall", "p"), "outboard": ("load", "p")}
    scene.connection("joint", "hinge", ports=ports, parameters=springs)
    return assemble(scene.check(), (), ())


def test_free_motion_is_named():
    """A body that slides along z under gravity: body, direction and size."""
    with pytest.raises(fanfold.FanfoldError, match=r"load .*\(0, 0, -1\).* 9.8 m/s2"):
        static_start(sliding(0.0, 9.8))


def test_what_is_soft_starts_where_it_hangs():
    """Closed form: g / w^2. Regression: the search took steps of at most 0.12 s, and 0.05 Hz did not come to rest."""
    soft = 2.0 * (2.0 * np.pi * 0.05) ** 2
    (load,) = (part for part in static_start(sliding(soft, 0.1)).assembly.parts if part.name == "load")
    assert load.start["initial_position"] == pytest.approx((0.0, 0.0, -0.2 / soft), abs=1e-9)


@pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")
@pytest.mark.parametrize("seed", [26, 402])
def test_softly_held_bodies_start_at_rest(seed):
    """Conservation law: preload is internal, so at rest the base carries the weight of all and no more.

    The joints of these random wings give way by millimetres. Regression: a search by steps crept towards equilibrium,
    and 402 began with 2.6 N on its base, and at another place at every tolerance.
    """
    scene = load_wing(seed)
    found = run(assemble(scene), None, Settings(1e-4, 0.02), 1e-5)
    weight = sum(body.rigid.mass for body in scene.bodies) * np.array(scene.header.gravity)
    load = found.result.signal(scene.base.name, "interface_force")[0]
    assert np.abs(load - weight).max() < 1e-4
