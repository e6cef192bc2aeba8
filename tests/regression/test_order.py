"""Order, tolerance and energy: errors against tight runs, on scenes of one and two panels in process."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.master import Settings
from orchestrator.scene import load_scene
from tests.benchmark.stability import run

TWO_PANELS = (Path(__file__).parents[1] / "scenes" / "two_panels.toml").read_text(encoding="utf-8")
ONE_PANEL = """
[scene]
name = "one_panel"
until = 4.6

[base]
points = { left = [0.0, 0.565, 0.0], right = [0.0, -0.565, 0.0] }

[[body]]
name = "panel"
[body.rigid]
mass = 7.582
center_of_mass = [0.805, 0.0, 0.0]
inertia = [1.0, 1.338, 2.2]
points = { left = [0.0, 0.565, 0.0], right = [0.0, -0.565, 0.0] }

[[hinge_line]]
name = "line"
inboard = "base"
outboard = "panel"
axis = "-y"
aligned_angle = "180 deg"
motor = { stowed = "2.304 N.m", deployed = "1.434 N.m" }
latch = { stiffness = 2216, outboard_stiffness = 4000, effective_inertia = 6.2514, damping_ratio = 0.01 }
hinges = [
  { name = "left", inboard = "left", outboard = "left" },
  { name = "right", inboard = "right", outboard = "right", kind = "cylindrical" },
]
"""
LATCH = """latch = {{ stiffness = {0}, outboard_stiffness = {1}, effective_inertia = {2}, damping_ratio = 0.01 }}
hinges ="""


def two_panels_with_latches():
    """Both lines latch within five seconds; the root line needs the stronger motor for it."""
    text = TWO_PANELS.replace("until = 2.0", "until = 5.1")
    text = text.replace('stowed = "1.6 N.m", deployed = "1.0 N.m"', 'stowed = "6 N.m", deployed = "4 N.m"')
    head, root, middle = text.split("hinges =")
    return head + LATCH.format(2500, 5000, 20) + root + LATCH.format(1800, 4000, 2) + middle


SCENES = {"smooth": TWO_PANELS, "one": ONE_PANEL, "two": two_panels_with_latches()}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Runs by scene and settings, each made once."""
    folder = tmp_path_factory.mktemp("scenes")

    @cache
    def solve(name, undamped=False, until=None, **settings):
        text = (
            SCENES[name].replace("damping_ratio = 0.01", "damping_ratio = 0.0") if undamped else SCENES[name]
        )
        path = folder / f"{name}_{undamped}.toml"
        path.write_text(text + ("\n[joint]\ndamping_ratio = 0.0\n" if undamped else ""), encoding="utf-8")
        scene = assemble(load_scene(path))
        options = Settings(**{"largest_step": scene.largest_step, **settings})
        outcome = run(scene.parts, scene.links, scene.hinge_lines, until or scene.until, options)
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
    reference = headline(*solved(name, tolerance=1e-6))
    at_default, tightened = (
        np.abs(headline(*solved(name, tolerance=tolerance)) / reference - 1.0) for tolerance in (1e-4, 1e-5)
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
