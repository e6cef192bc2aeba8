"""Connections of order 4 in structures that no example has: native FMUs against their components."""

from __future__ import annotations

import numpy as np
import pytest

from components.ccl import CableLoop
from components.drive import Drive
from components.gear import Gear
from components.hinge import Hinge
from fmus import native_library
from tests.conformance.programs import trial
from tests.conformance.programs.driver import Fmu, Reference, built, start_of

pytestmark = pytest.mark.skipif(native_library() is None, reason="no native library was built")
VARIANTS = {
    "table_latch": Hinge(
        latch="table",
        latch_deflection=(-1.0, -0.01, 0.0, 0.02, 1.0),
        latch_torque=(-50.0, -9.0, 0.0, 8.0, 60.0),
    ),
    "kinematic_latch": Hinge(axis=(0.3, 0.9, -0.1), latch="kinematic"),
    "free_strands": CableLoop(guided=False),
    "rack": Gear(second_motion="translation"),
    "step_profile": Drive(profile="step"),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_is_equal_at_order_four(name, monkeypatch):
    """Three hundred random steps with random moments, commands, parameters and rollbacks."""
    monkeypatch.setattr(trial, "NATIVE", True)
    monkeypatch.setattr(trial, "STEPS", 300)
    component = VARIANTS[name]
    fmu = Fmu(str(built(component, name, start=start_of(component), backend="native")))
    reference = Reference(component)
    assert trial.set_order(fmu, reference)
    slopes, compare = [], trial.same

    def same(fmu, reference, *words, **options):
        slopes.append(np.any(reference.outputs()[-6 * len(component.ports) :]))
        compare(fmu, reference, *words, **options)

    monkeypatch.setattr(trial, "same", same)
    trial.go_on_alike(fmu, reference)
    assert np.any(slopes)  # but for those of a joint that has failed
