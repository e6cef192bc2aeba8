"""The isolated membrane of the thesis (Mollo, section 4.1): stiffness, symmetry and stress where it is pushed out."""

import numpy as np
import pytest

import orchestrator as fanfold

pytestmark = pytest.mark.filterwarnings("ignore:membrane.*W-linear-plate")  # linear theory is the point

COARSE = {"body.membrane.panel.element_size": "40 mm"}


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """The motion of 100 mm in 1 s and a second of rest, on a coarse mesh."""
    path = tmp_path_factory.mktemp("membrane") / "membrane.h5"
    scene = fanfold.load("membrane-isolated", settings=COARSE)
    return fanfold.simulate(scene, save=path, estimate=False)


@pytest.mark.thorough
def test_force_of_the_motion(result):
    """Closed form: a clamped square pushed by a patch of 40 mm, 1642 N/m; what it swings with averages out."""
    time, force = result.time, np.asarray(result["motion", "motion_force"][:])
    rest = time > 1.2
    mean = np.trapezoid(force[rest], time[rest]) / np.ptp(time[rest])
    assert mean == pytest.approx(164.2, rel=0.01)


def test_joints_are_alike(result):
    """Symmetry: the corners carry the same, and sides in pairs (M17) that differ by the mesh; sides carry most."""
    peaks = result.headline.port_force_peaks
    corners = [peaks[f"at_corner_{k}"] for k in range(1, 5)]
    sides = [peaks[f"at_side_{k}"] for k in ("12", "23", "34", "41")]
    assert np.ptp(corners) < 1e-6 * max(sides)
    assert np.ptp(sides[::2]) < 1e-6 * max(sides)
    assert np.ptp(sides[1::2]) < 1e-6 * max(sides)
    assert np.ptp(sides) < 1e-3 * max(sides)
    assert min(sides) > 5.0 * max(corners)


def test_energy(result):
    """Conservation: the work of the motion is what the membrane holds and has lost."""
    assert abs(result.headline.energy_residual) < 1e-6
