"""Without any damping a wing keeps swinging: what the scheme takes from its first modes is hardly anything.

Steps of 5 ms resolve these modes (w h is 0.014 to 0.1) but not the joints between the flexible bodies, so the
inertial terms of stiff coordinates act in full, and nothing else takes energy.
"""

import numpy as np
import pytest

from orchestrator.cosim.settings import Settings
from tests.references.native_fmus import needs_native
from tests.references.ringing import swing, undamped_wing

STEP = 5e-3
SETTLED, END = 10.0, 20.0
"""Periods: until what a kick starts besides the mode has died away, and until when the loss is watched."""


@needs_native
@pytest.mark.parametrize("variant", [(), ("spring_latch",)], ids=["kinematic", "spring"])
@pytest.mark.parametrize("number", [pytest.param(0, marks=pytest.mark.thorough), 1, 2])
def test_a_mode_keeps_its_energy(variant, number):
    """Conservation of energy: in 100 periods less than 1 % of a joule; what is lost is told as numerical."""
    record, period = swing(undamped_wing("amos3", variant), number, END, Settings(fixed_step=STEP))
    times, stored = np.array(record.times), record.scene("stored_energy")
    assert stored[0] == pytest.approx(1.0, rel=1e-3)
    settled = np.interp(SETTLED * period, times, stored)
    assert abs(settled - stored[-1]) / (END - SETTLED) * 100.0 < 0.01
    assert abs(1.0 - stored[-1]) < 0.01
    assert np.all(record.scene("dissipated_energy") == 0.0)
    assert stored[0] - stored[-1] == pytest.approx(
        record.scene("numerical_dissipation")[-1] - record.scene("numerical_dissipation")[0], abs=1e-5
    )
