"""Latches of light bodies in heavy wings: the first swing is over in a tenth of a millisecond.

References are runs with first steps of 5e-7 s after a latch-up at a tolerance of 1e-7: 1073.1 and 503.1 N.m.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fmus import native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import run
from orchestrator.scene import load_scene
from tests.references.random_wings import load_wing

pytestmark = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")
SCENES = Path(__file__).parents[1] / "scenes"


@pytest.mark.parametrize(
    ("scene", "tolerance", "until", "peak", "error"),
    [
        ("light_body_latch", 1e-3, 1.5, 1073.1, 1e-2),
        ("light_body_latch", 1e-5, 1.5, 1073.1, 1e-3),
        ("light_root_latch", 1e-3, 2.63, 503.1, 1e-2),
    ],
)
def test_peak_follows_the_tolerance(tmp_path, scene, tolerance, until, peak, error):
    """L1 latches 40 ms before the end, several hundred of its first swings."""
    assembly = assemble(load_scene(SCENES / f"{scene}.toml"))
    settings = Settings(tolerance=tolerance, largest_step=assembly.largest_step)
    outcome = run(assembly, tmp_path / "run.h5", settings, until)
    assert outcome.headline.latch_torque_peaks["L1"] == pytest.approx(peak, rel=error)


@pytest.mark.thorough
def test_first_swing_beside_a_lock_is_resolved():
    """Random wing 40: in steps of 20 ms the hinge of L2, beside a lock, would turn against its torque.

    Against 314.7 N of a run at a hundredth of the tolerance. L2 latches at 4.660 s.
    """
    scene = load_wing(40)
    assembly = assemble(scene)
    tolerance = scene.header.tolerance
    found = run(assembly, None, Settings(tolerance, assembly.largest_step), until=4.7).headline
    assert found.interface_force_peaks[2] == pytest.approx(314.7, rel=10.0 * tolerance)
