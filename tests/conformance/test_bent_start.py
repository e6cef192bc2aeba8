"""Bodies that start bent: the native FMU takes the state that the Python component takes."""

from __future__ import annotations

import numpy as np
import pytest

from components import Instance
from components.body import Body
from fmus import build_fmu, native_library
from orchestrator.cosim.fmu import FmuParticipant
from tests.unit.components.body.body_cases import PORTS, modal_data

START = {
    "initial_modal_coordinate": (0.02, -0.01, 0.004, 0.003),
    "initial_angular_velocity": (0.3, -0.2, 0.5),
    "initial_velocity": (0.1, 0.0, -0.2),
}


@pytest.mark.skipif(native_library() is None, reason="there is no native library here")
@pytest.mark.parametrize("coupling", ["constant", "partial", "full"])
def test_native_bodies_start_as_python_ones(coupling, tmp_path):
    """Rule: both back ends agree to round-off, in what is observed and at the ports."""
    body = Body(modal=modal_data().to_arrays(), ports=PORTS, inertia_coupling=coupling)
    ours = Instance(body, START)
    ours.initialize()
    native = FmuParticipant("bent", build_fmu(body, "bent", tmp_path, START, "native"))
    native.initialize(0.0)
    try:
        native.read()
        assert native.outputs == pytest.approx(ours.outputs(), rel=1e-13, abs=1e-14)
        assert native.observe() == pytest.approx(ours.observe(), rel=1e-13, abs=1e-14)
    finally:
        native.close()
    assert np.any(ours.outputs())
