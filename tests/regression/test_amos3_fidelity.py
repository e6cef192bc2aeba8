"""AMOS-3 in orbit, rigid against full-flexible (Bagnoli 2007, chapter 4): what its author found, and how far we are."""

import numpy as np
import pytest

from orchestrator.results.key_figures import latch_times, line_latch_torque

from .scene_runs import RUNS as STICKING
from .scene_runs import THESIS as RUNS

pytestmark = pytest.mark.slow

RIGID = ("all",)
FLEXIBLE = tuple(f"body.{name}.fidelity=flexible" for name in ("yoke", "panel1", "panel2"))
TREND = 1e-3
"""Tolerance of runs that show a trend: peaks within 0.5 %."""


def own_peak(result, name):
    """Largest latch torque of a line between its own latch-up and the next one (N.m)."""
    times = latch_times(result)
    end = min((t for t in times.values() if t > times[name]), default=result.time[-1])
    (line,) = (line for line in result.hinge_lines if line.name == name)
    shown = (result.time >= times[name]) & (result.time < end)
    return float(np.abs(line_latch_torque(result, line)[shown]).max())


def latch_frequency(result, name):
    """Frequency of a latch torque from its half periods in the second after latch-up (Hz)."""
    (line,) = (line for line in result.hinge_lines if line.name == name)
    start = latch_times(result)[name]
    shown = (result.time > start) & (result.time < start + 1.0)
    time, torque = result.time[shown], line_latch_torque(result, line)[shown]
    crossings = time[1:][np.diff(np.sign(torque)) != 0]
    return 0.5 / float(np.median(np.diff(crossings[1:])))


def ringing(result, axis, start, end):
    """Root mean square of an interface torque about its slow course (N.m)."""
    shown = (result.time > start) & (result.time < end)
    time, torque = result.time[shown], result.signal("spacecraft", "interface_torque")[shown, axis]
    return float(
        np.sqrt(np.mean((torque - np.polyval(np.polyfit(time - start, torque, 6), time - start)) ** 2))
    )


def test_latch_torques_compare_as_in_the_thesis():
    """Section 4.2.2: HL2 and HL3 close, HL1 higher with flexible bodies, by about 20 % there.

    By 47 % here, and by 17 % once the spring of the rigid wing is tuned to the first frequency of the flexible one.
    """
    rigid, flexible = (RUNS.result("amos3", rigid=r, tolerance=TREND) for r in (RIGID, ()))
    ratio = {name: own_peak(flexible, name) / own_peak(rigid, name) for name in ("HL1", "HL2", "HL3")}
    assert ratio["HL3"] == pytest.approx(1.0, abs=0.03)
    assert ratio["HL2"] == pytest.approx(1.0, abs=0.15)
    assert ratio["HL1"] == pytest.approx(1.47, abs=0.05)
    tuned = RUNS.result("amos3", "tuned_hl1", rigid=RIGID, tolerance=TREND)
    assert own_peak(flexible, "HL1") / own_peak(tuned, "HL1") == pytest.approx(1.2, abs=0.05)


def test_cable_forces_are_close():
    """Section 4.2.3: equal in both models."""
    rigid, flexible = (RUNS("amos3", rigid=r, tolerance=TREND).headline.force_extremes for r in (RIGID, ()))
    for loop, forces in rigid.items():
        for variable in ("tension_a", "tension_b"):
            assert flexible[loop][variable][1] == pytest.approx(forces[variable][1], rel=0.05)


def test_damper_stops_with_a_kinematic_latch_and_oscillates_with_a_spring():
    """Section 4.2.4."""
    largest = {}
    for name, layers in {"kinematic": (), "spring": ("spring_latch",)}.items():
        result = RUNS.result("amos3", *layers, tolerance=TREND)
        torque = result.signal("damper", "damper_torque")
        after = torque[result.time > latch_times(result)["HL1"] + 0.01]
        largest[name] = np.abs(after).max() / np.abs(torque).max()
    assert largest["kinematic"] < 1e-3
    assert largest["spring"] > 0.05


def test_preload_removes_the_initial_ringing():
    """Section 4.2.5: without it the flexible yoke rings for the first seconds."""
    with_preload = RUNS.result("amos3", tolerance=TREND)
    without = RUNS.result("amos3", "without_preload", tolerance=TREND, until=4.0)
    for axis in (0, 2):
        assert ringing(with_preload, axis, 0.0, 4.0) < 0.05 * ringing(without, axis, 0.0, 4.0)


def test_transverse_sadm_torque_shows_only_with_flexible_bodies():
    """Section 4.2.6. Pulleys beside the centre line twist a rigid wing too (2 N.m); on the line they do not.

    The flexible wing shows it from the first latch-up on, at 8.1 s.
    """
    rigid, flexible = (
        RUNS("amos3", "central_loops", settings=s, tolerance=TREND, until=end).headline.interface_torque_peaks
        for s, end in (((), None), (FLEXIBLE, 9.0))
    )
    iteration = 1e-6  # what an iteration leaves, of the largest torque
    assert max(rigid[0], rigid[2]) < iteration * rigid[1]
    assert min(flexible[0], flexible[2]) > 0.5


GROUND = 11.0
"""s; behind HL2, which ends the swing of HL3; the hybrid wing only needs the second after HL3 at 9.74 s."""


@pytest.mark.thorough
def test_ground_rig_hybrid_and_rigid_agree_on_hl3():
    """Section 4.3.1: HL3 peaks close, frequencies differ; later than in orbit, because of the air."""
    rigid = RUNS.result("amos3-ground", rigid=RIGID, until=GROUND)
    hybrid = RUNS.result("amos3-ground", rigid=("yoke",), until=10.85, tolerance=TREND)
    assert own_peak(hybrid, "HL3") == pytest.approx(own_peak(rigid, "HL3"), rel=0.1)
    assert latch_times(hybrid)["HL3"] == pytest.approx(latch_times(rigid)["HL3"], rel=0.02)
    assert latch_times(rigid)["HL3"] > 7.4 * 1.2
    frequencies = [latch_frequency(result, "HL3") for result in (rigid, hybrid)]
    assert frequencies[1] < 0.95 * frequencies[0]


LATCH_TIMES = {"HL3": 9.8530, "HL2": 10.9885}
PEAK = 20.284
"""s and N.m, ground rig, rigid, friction sticks; Fanfold, 2026-11-28, tolerance 1e-6: a change must be meant."""


def test_ground_rig_key_figures_stay():
    """Regression."""
    found = STICKING("amos3-ground", rigid=RIGID, until=GROUND)
    times = found.headline.latch_times
    assert {name: times[name] for name in LATCH_TIMES} == pytest.approx(LATCH_TIMES, rel=1e-3)
    assert own_peak(STICKING.result("amos3-ground", rigid=RIGID, until=GROUND), "HL3") == pytest.approx(
        PEAK, rel=5e-3
    )
    assert found.headline.energy_residual < 1e-4
