"""Loads just after a latch-up, wherever communication steps happen to end before it."""

from math import sqrt

import pytest
from scipy.integrate import solve_ivp

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.results.key_figures import latch_times
from orchestrator.run.run import run
from orchestrator.scene import read_scene
from tests.unit.analysis.sampling.flap import ANGLE, INERTIA, STIFFNESS, flap

DAMPING_RATIO = 2.0


@pytest.fixture(scope="module")
def assembly():
    """A flap whose latch brakes with more than its spring ever holds."""
    return assemble(read_scene("flap.toml", flap(damping_ratio=DAMPING_RATIO).tree))


@pytest.fixture(scope="module")
def latch_time(assembly):
    """Where the run itself meets the latch (s), whatever a bushing leaves of the closed form."""
    return sum(run(assembly, None, Settings(1e-6)).segments[0])


@pytest.mark.parametrize("short", [4e-12, 1e-9, 1e-7, 1e-5])
def test_a_short_step_before_it_does_not_show(assembly, latch_time, short):
    """Closed form: the latch brakes with c w at once, w from the motor's work; the base bears it and the motor.

    In the instant after it (1e-8 s) braking fades by 3e-7. The load was extrapolated from the short step: doubled.
    """
    plan = [[(latch_time - short) / 500] * 500 + [1e-3], [1e-5]]
    settings = Settings(1e-6, step_plan=plan)
    result = run(assembly, None, settings, latch_time + 1e-6).result
    at = result.time.searchsorted(latch_time + 5e-9)
    braking = 2.0 * DAMPING_RATIO * sqrt(STIFFNESS * INERTIA) * sqrt(2.0 * ANGLE / INERTIA)
    assert result.signal("base", "interface_torque")[at, 1] == pytest.approx(braking - 1.0, rel=1e-6)


def _ringing_joint(damping, rate):
    """Peak of the force (N) on a joint of 2e7 N/m that a latch which damps (N.m.s/rad) has ring, met at a rate (rad/s).

    A panel of 5 kg and 0.5 kg.m2, 0.5 m from its line, in the plane: integrated with SciPy from the motor's statics.
    """
    mass, arm, inertia, stiffness, motor = 5.0, 0.5, 0.5, 2e7, 1.0

    def slope(_, state):
        place, _, speed, turning = state
        force = -stiffness * place
        turned = (motor - STIFFNESS * state[1] - damping * turning - arm * force) / inertia
        return [speed, turning, force / mass - arm * turned, turned]

    held = mass * arm * motor / (inertia + mass * arm**2)
    start = [-held / stiffness, 0.0, 0.0, rate]
    return (
        stiffness * abs(solve_ivp(slope, (0.0, 0.02), start, rtol=1e-9, atol=1e-15, max_step=2e-5).y[0]).max()
    )


@pytest.mark.parametrize("damping_ratio", [0.3, 1.0])
def test_joints_that_a_latch_has_ring_are_seen(damping_ratio):
    """Independent formulation, to two tolerances; steps that resolve the latch led over the joints: 67 N for 99."""
    scene = fanfold.Scene("flap", until="2.4 s")
    points = {"left": (0, 0.5, 0), "right": (0, -0.5, 0)}
    panel = {"mass": 5.0, "center_of_mass": (0.5, 0, 0), "inertia": (1, 0.5, 1), "points": points}
    scene.joint(radial_stiffness=1e7, damping_ratio=0.0)
    scene.hinge_line(
        "line", scene.base(points=points), scene.body("panel", rigid=panel), axis="+y", aligned_angle="90 deg",
        motor={"stowed": 1.0, "deployed": 1.0}, hinges={"left": "left", "right": "right"},
        latch={"stiffness": STIFFNESS, "effective_inertia": 1.75, "damping_ratio": damping_ratio},
    )  # fmt: skip
    result = run(assemble(read_scene("flap.toml", scene.tree)), None, Settings(1e-2)).result
    at = result.time.searchsorted(latch_times(result)["line"] - 1e-9)
    rate = abs(result.signal("left", "angular_rate")[at])
    after = result.signal("base", "interface_force")[at : at + 400, 2]
    expected = _ringing_joint(2.0 * damping_ratio * sqrt(STIFFNESS * 1.75), rate)
    assert abs(after).max() == pytest.approx(expected, rel=2e-2)


@pytest.mark.parametrize("backend", ["native", pytest.param("python", marks=pytest.mark.thorough)])
def test_a_lock_keeps_its_load_when_another_line_locks(backend):
    """Statics: what does not move any more rests on the first lock, which the motor of its line presses with 50 N.m.

    The second panel opens slowly and stops dead, so next to nothing changes for the first lock. Regression: all locks
    were engaged anew in the impulse of the second, so that the first began without load, and swung to 100 N.m.
    """
    scene = fanfold.Scene("two_locks", until="0.56 s")
    base = scene.base(points={"root": (0, 0, 0)})
    panel = {"mass": 5.0, "center_of_mass": (0.5, 0, 0), "inertia": (0.2, 0.5, 0.7)}
    inner = scene.body("inner", rigid={**panel, "points": {"root": (0, 0, 0), "tip": (1, 0, 0)}})
    outer = scene.body("outer", rigid={**panel, "points": {"root": (0, 0, 0)}})
    for name, inboard, outboard, start, torque, point in (
        ("HL1", base, inner, "89.99 deg", 50.0, "root"),
        ("HL2", inner, outer, "89.95 deg", 0.02, "tip"),
    ):
        scene.hinge_line(
            name, inboard, outboard, axis="+y", aligned_angle="90 deg", start_angle=start,
            motor={"stowed": torque, "deployed": torque}, latch={"kind": "kinematic", "stiffness": 1e3},
            hinges={f"{name.lower()}_hinge": (point, "root")},
        )  # fmt: skip
    result = fanfold.simulate(scene, backend=backend, step=5e-3, estimate=False)
    first, second = result.latch_times["HL1"], result.latch_times["HL2"]
    assert first < second - 0.2
    torque = result.signal("hl1_hinge", "latch_torque")[result.time > second + 1e-6]
    assert torque == pytest.approx(-50.0, abs=0.1)
