"""Order, tolerance and energy: errors against tight runs, on scenes of one and two panels.

As native FMUs, where a compiler has made them; without, the same in process takes minutes.
"""

from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fmus import native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.scene.builder import Scene
from tests.benchmark.stability import run
from tests.references.panels import TWO_PANELS, one_panel, two_panels_with_latches
from tests.references.panels import undamped as undamped_scene

SCENES = {"smooth": Scene.load(TWO_PANELS), "one": one_panel(), "two": two_panels_with_latches()}


@pytest.fixture(scope="module")
def solved():
    """Runs by scene and settings, each made once."""

    @cache
    def solve(name, undamped=False, until=None, **settings):
        built = SCENES[name]
        scene = assemble((undamped_scene(built) if undamped else built).check())
        options = Settings(**{"largest_step": scene.largest_step, **settings})
        native = native_library() is not None
        outcome = run(
            scene.parts, scene.links, scene.hinge_lines, until or scene.until, options, native=native
        )
        assert not outcome.failure
        return scene, outcome.record

    return solve


def headline(scene, record):
    """Latch times and the peaks of cubic interpolants of the lines' latch torques."""
    found = [time for time, _, _ in record.events]
    times = np.array(record.times)
    for line in scene.hinge_lines:
        torque = np.abs(sum(record.signal(hinge, "latch_torque") for hinge in line.hinges))
        near = slice(max(int(torque.argmax()) - 3, 0), int(torque.argmax()) + 4)
        fine = np.linspace(times[near][0], times[near][-1], 2000)
        found.append(float(CubicSpline(times[near], torque[near])(fine).max()))
    return np.array(found)


def energy_residual(scene, record):
    """Balance residual over time relative to the motors' energy at the end."""
    hinges = [hinge for line in scene.hinge_lines for hinge in line.hinges]
    released = sum(float(record.signal(hinge, "motor_energy")[-1]) for hinge in hinges)
    return record.scene("energy_residual") / released


def slope(steps, errors):
    """Slope of a straight line through the logarithms."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def test_the_coupled_motion_is_of_second_order(solved):
    """Smooth motion, fixed steps: angles and rates against a run with an eighth of the smallest step."""

    def end(h):
        _, record = solved("smooth", until=1.0, fixed_step=h, tolerance=1e-6)
        return np.array(
            [record.signal(n, q)[-1] for n in ("root", "middle_left") for q in ("angle", "angular_rate")]
        )

    steps = (2e-2, 1e-2, 5e-3)
    reference = end(6.25e-4)
    errors = np.array([np.abs(end(h) - reference) for h in steps])
    assert min(slope(steps, column) for column in errors.T) > 1.8


@pytest.mark.parametrize("name", ["one", "two"])
def test_the_tolerance_bounds_the_error_and_governs_it(solved, name):
    """Latch times and peaks against a run at a hundredth of the default tolerance."""
    reference = headline(*solved(name, tolerance=1e-6, order=4))
    at_default, tightened = (
        np.abs(headline(*solved(name, tolerance=tolerance, order=4)) / reference - 1.0)
        for tolerance in (1e-4, 1e-5)
    )
    assert at_default.max() < 1e-3
    assert tightened.max() <= at_default.max() / 3.0
    count = len(at_default) // 2
    assert tightened[:count].max() <= at_default[:count].max() / 3.0


@pytest.mark.parametrize("name", ["one", "two"])
def test_the_energy_balance_closes_at_the_default_tolerance(solved, name):
    """Relative to the energy the motors release."""
    assert np.abs(energy_residual(*solved(name, tolerance=1e-4))).max() < 1e-4


def test_the_energy_residual_is_of_second_order(solved):
    """Fixed steps on the smooth scene."""
    steps = (2e-2, 1e-2, 5e-3)
    residuals = [np.abs(energy_residual(*solved("smooth", undamped=True, fixed_step=h))).max() for h in steps]
    assert slope(steps, residuals) > 1.8


def test_the_energy_residual_does_not_drift(solved):
    """A panel that swings on its latch for nine periods without damping: the last as good as the first."""
    scene, record = solved("one", undamped=True, until=7.5, fixed_step=4e-3)
    residual, times = np.abs(energy_residual(scene, record)), np.array(record.times)
    first, last = (residual[(times > start) & (times <= start + 1.0)].max() for start in (4.3, 6.5))
    assert last < 1.05 * first
