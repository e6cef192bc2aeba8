"""Latches of light bodies in heavy wings: the first swing is over in a tenth of a millisecond.

References are runs with first steps of 5e-7 s after a latch-up at a tolerance of 1e-7: 1073.1 and 503.1 N.m.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus import native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.master import Settings
from orchestrator.run.run import run
from orchestrator.scene import load_scene

pytestmark = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
SCENES = Path(__file__).parents[1] / "scenes"


@pytest.mark.parametrize(
    ("scene", "tolerance", "peak", "error"),
    [
        ("light_body_latch", 1e-3, 1073.1, 1e-2),
        ("light_body_latch", 1e-5, 1073.1, 1e-3),
        ("light_root_latch", 1e-3, 503.1, 1e-2),
    ],
)
def test_peak_follows_the_tolerance(tmp_path, scene, tolerance, peak, error):
    assembly = assemble(load_scene(SCENES / f"{scene}.toml"))
    settings = Settings(tolerance=tolerance, largest_step=assembly.largest_step)
    outcome = run(assembly, tmp_path / "run.h5", settings)
    assert outcome.headline.latch_torque_peaks["L1"] == pytest.approx(peak, rel=error)
