"""Controllers whose own step makes their loop unstable: made-up signals of recurrences."""

from types import SimpleNamespace

import numpy as np
import pytest

from orchestrator.validity.sampled_loops import sampled_loop_warnings

K = np.arange(60)
SIGNALS = {
    "unstable": 1e-3 * (-1.2) ** K,  # of a held rate loop, 1 - k h / I
    "stable": 5.0 * (-0.9) ** K,
    "steady": 5.0 * (-1.0) ** K,  # of a relay
    "growing alone": 1e-3 * 1.2**K,
    "ringing at 0.49 of the rate": np.sin(2.0 * np.pi * 0.49 * K) * np.exp(-0.02 * K),
    "quiet": np.zeros(60),
}


@pytest.mark.parametrize("kind", SIGNALS)
def test_a_loop_that_its_step_makes_unstable_is_told(kind):
    """Recurrences: what changes sign and grows from step to step, and neither ringing nor a relay.

    Regression: a wing that a controller shook apart was told to have hinges too soft, and no word of the controller.
    """
    torque = np.repeat(SIGNALS[kind], 7)  # rows between communication points
    fmu = SimpleNamespace(name="pd", step=0.1, outputs=[SimpleNamespace(variable="torque")], inputs=[])
    result = SimpleNamespace(
        has=lambda *of: of == ("pd", "torque"), signal=lambda *of: torque, unit=lambda *of: "N.m"
    )
    told = list(sampled_loop_warnings(SimpleNamespace(signal_fmus=[fmu]), result))
    assert len(told) == (kind == "unstable")
    if told:
        assert told[0].startswith("fmu.pd: torque ")
        assert "0.1 s" in told[0]
        assert f"up to {np.abs(torque).max():.3g} N.m" in told[0]
