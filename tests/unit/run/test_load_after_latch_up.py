"""Loads just after a latch-up, wherever communication steps happen to end before it."""

from math import sqrt

import pytest

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
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


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("short", [4e-12, 1e-9, 1e-7, 1e-5])
def test_a_short_step_before_it_does_not_show(assembly, latch_time, short, compiled):
    """Closed form: the latch brakes with c w at once, w from the motor's work; the base bears it and the motor.

    In the instant after it (1e-8 s) braking fades by 3e-7. The load was extrapolated from the short step: doubled.
    """
    plan = [[(latch_time - short) / 500] * 500 + [1e-3], [1e-5]]
    settings = Settings(1e-6, step_plan=plan, compiled=compiled)
    result = run(assembly, None, settings, latch_time + 1e-6).result
    at = result.time.searchsorted(latch_time + 5e-9)
    braking = 2.0 * DAMPING_RATIO * sqrt(STIFFNESS * INERTIA) * sqrt(2.0 * ANGLE / INERTIA)
    assert result.signal("base", "interface_torque")[at, 1] == pytest.approx(braking - 1.0, rel=1e-6)
