"""A long step never runs away: a slender cantilever at a step that does not resolve its own turning."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import orchestrator as fanfold
from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.flexible.reduction import craig_bampton
from fmus import native_library
from orchestrator.assembly import Part
from orchestrator.cosim.network import Network
from orchestrator.cosim.settings import Settings
from tests.benchmark.models.chain import as_instances
from tests.references.coupled import base, between, mastered

LENGTH, BENDING, LINE_MASS, GRAVITY = 10.0, 1.4e4, 1.2, 10.0
CLAMP = {"translational_stiffness": (1e7,) * 3, "rotational_stiffness": (1e6,) * 3}


def cantilever():
    """The beam across gravity on its clamp.

    Its cross-section turns about the axis a thousand times more easily straight than bent by 0.3 m, so the mobility
    of its root changes as much.
    """
    section = BeamSection(2.8e7, BENDING, BENDING, 1e4, LINE_MASS, gyration_radius=0.01)
    ends = {"root": (0.0, 0.0, 0.0), "tip": (LENGTH, 0.0, 0.0)}
    data = craig_bampton(
        beam_frame(ends, [Member("root", "tip", section, elements=10)]), ["root"], 4, ["tip"]
    )
    ports = [{"name": "root", "point": "root"}]
    beam = Part(
        "beam", "body", {"modal": data.to_arrays(), "ports": ports}, {"gravity": (0.0, 0.0, -GRAVITY)}
    )
    return [base(root=ends["root"]), beam, Part("clamp", "hinge", {}, CLAMP)], between(
        "clamp", "base.root", "beam.root"
    )


def followed(participants, links, until, step):
    """The scene at a fixed step up to a time (s)."""
    run = mastered(Network(participants, links), Settings(fixed_step=step))
    run.master.initialize(preload=False)
    run.master.run(until)
    return run


@pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")
def test_slender_cantilever_at_a_fixed_long_step():
    """Conservation: no step opens the balance by more than the guard's share of what moves; without it it gains 1e4 J.

    That share of 26 J in a hundred steps is 1 %.

    Closed form: under a load that comes at once the first mode's kinetic energy is at most (its share of the load)^2
    over 2 m w1^2, shares and frequency of a clamped-free beam; the other modes have less than 2 % of it.
    """
    parts, links = cantilever()
    with as_instances(parts, "native") as participants:
        assert [p.constant_mobility for p in participants] == [True, False, False]
        run = followed(participants, links, 2.0, 0.02)
    residual, share = run.scene("energy_residual"), 1e-4
    in_motion = run.signal("beam", "kinetic_energy").max()
    assert np.abs(np.diff(residual)).max() <= share * in_motion
    assert np.abs(residual).max() < 0.01 * in_motion
    mass, first = LINE_MASS * LENGTH, 1.875104**2 * np.sqrt(BENDING / LINE_MASS) / LENGTH**2
    of_load = 4.0 * (0.734096 / 1.875104) ** 2
    kinetic = (mass * GRAVITY) ** 2 * of_load / (2.0 * mass * first**2)
    assert in_motion == pytest.approx(kinetic, rel=0.02)


@pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
@pytest.mark.parametrize(("step", "told"), [("0.5 s", True), ("5 ms", False)])
def test_a_step_that_cannot_be_kept_is_told(step, told):
    """Regression: a folded wing was asked for steps of 0.5 s and took 0.06 s, without a word."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        fanfold.simulate("amos3", rigid="all", step=step, until=3.0, estimate=False)
    assert any("W-step-divided" in str(one.message) for one in heard) == told


def swinging_tube(roll):
    """A tube of 1.5 m on a hinge across it, with a moment of inertia (kg.m2) about its own axis."""
    scene = fanfold.Scene("tube", until="1 s")
    base = scene.base("base", points={"root": (0, 0, 0)})
    rigid = {"mass": 3, "center_of_mass": (0.75, 0, 0), "inertia": (roll, 0.5625, 0.5625)}
    tube = scene.body("tube", rigid={**rigid, "points": {"root": (0, 0, 0)}})
    motor = {"stowed": "50 N.m", "deployed": "30 N.m"}
    hinges = {"hinge": ("root", "root")}
    scene.hinge_line("line", base, tube, axis="+y", aligned_angle="90 deg", motor=motor, hinges=hinges)
    return scene


@pytest.mark.skipif(native_library() is None, reason="no C compiler built the native FMUs")
@pytest.mark.parametrize("step", ["8 ms", "16 ms"])
@pytest.mark.parametrize("roll", [6e-4, 6e-5])
def test_a_slender_tube_swings_in_its_plane(roll, step):
    """Closed form: nothing leaves the plane, and the swing is that of any roll inertia.

    Turned by 0.1 and 0.2 rad a step, a thousand and ten thousand times harder to turn across than along: an iteration
    from angular velocity to angular velocity leads away, and whatever it ends with threw the tube out of its plane.
    """
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        run = fanfold.simulate(swinging_tube(roll), step=step, estimate=False)
    assert not [one for one in told if "divided" in str(one.message)]
    x, y, z = run.headline.interface_force_peaks
    assert y < 1e-5 * min(x, z)
    stout = fanfold.simulate(swinging_tube(0.5), step=step, estimate=False)
    assert run.headline.overruns["line"].last == pytest.approx(stout.headline.overruns["line"].last, abs=1e-6)
