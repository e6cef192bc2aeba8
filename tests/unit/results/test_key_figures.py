"""Headline numbers against the closed forms of a made-up deployment."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from orchestrator.assembly import HingeLine
from orchestrator.cli.tables import headline_tables
from orchestrator.results.key_figures import (
    _given,
    headline,
    headline_rows,
    line_latch_torque,
)
from orchestrator.results.peaks import extremes, peak
from orchestrator.results.result import Result
from orchestrator.validity.travel import _bent
from tests.references import synthetic_result as reference
from tests.unit.scene.scene_cases import SCENES


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return Result.open(reference.write(tmp_path_factory.mktemp("summary") / "run.h5"))


@pytest.fixture(scope="module")
def found(result):
    return headline(result)


def test_latch_times_are_those_of_the_events(found):
    assert found.latch_times == {line.name: line.latch_time for line in reference.LINES}


def test_rates_at_latch_up_are_those_just_before(found):
    """Closed form: angle = latch_angle (t / t_latch)^2 up to the event, whatever rings after it."""
    assert found.latch_rates == pytest.approx(
        {line.name: line.latch_rate for line in reference.LINES}, rel=1e-9
    )
    assert found.latch_energies == {}  # its lines have no inertia


def test_identifiers_are_fixed_and_each_is_one_number(found):
    """Convention: scripts and targets rest on them; the numbers of JSON are by them."""
    names = [number.id for number in found.numbers()]
    assert len(set(names)) == len(names)
    assert {
        "latch_time.hl1", "latch_rate.hl1", "latch_torque_peak.hl3", "interface_force_peak.x", "interface_force_peak",
        "damper_torque_peak.damper", "tension_a_min.ccl", "tension_b_max.ccl", "motor_energy", "numerical_loss",
        "energy_residual",
    } <= set(names)  # fmt: skip
    told = json.loads(json.dumps(found.as_dict()))["numbers"]
    assert list(told) == names
    assert told["latch_time.hl2"] == {"value": 8.2, "unit": "s", "estimated_error": None}


@pytest.mark.parametrize("line", reference.LINES, ids=lambda line: line.name)
def test_latch_torque_peak_between_samples_is_the_true_one(found, line):
    bound = 3.0 / 128.0 * (line.frequency * reference.LARGEST_STEP) ** 4
    assert bound < 2e-5
    assert found.latch_torque_peaks[line.name] == pytest.approx(line.torque_peak, rel=bound)


def test_largest_sample_alone_would_be_worse_by_orders(result, found):
    errors = []
    for line, hinges in zip(reference.LINES, result.hinge_lines, strict=True):
        sample = np.max(np.abs(line_latch_torque(result, hinges)))
        error = abs(found.latch_torque_peaks[line.name] - line.torque_peak)
        errors.append(error / abs(sample - line.torque_peak))
    assert max(errors) < 0.02


def test_peak_at_a_discontinuity_is_the_sample_there(found):
    line = reference.LINES[0]
    expected = reference.DAMPER_COEFFICIENT * line.latch_rate
    assert found.torque_peaks == {"damper": {"damper_torque": pytest.approx(expected, rel=1e-12)}}


def test_cable_force_extremes(found):
    """Samples, not interpolants: a strand has a kink where it goes slack. The extremes lie within the sampling."""
    low, high = found.force_extremes["ccl"]["tension_a"]
    assert 30.0 <= low == pytest.approx(30.0, rel=1e-3)
    assert 70.0 >= high == pytest.approx(70.0, rel=1e-3)
    assert set(found.force_extremes["ccl"]) == {"tension_a", "tension_b", "axial_force", "lateral_force"}


def test_interface_loads_component_by_component(found):
    first = reference.LINES[0].torque_peak
    assert found.interface_torque_peaks[0] == 0.0
    assert found.interface_torque_peaks[1] >= first * (1.0 - 1e-6)
    assert found.interface_force_peaks[2] == pytest.approx(3.0, rel=1e-8)


def test_motor_energy_counts_until_the_last_latch(found):
    last = reference.LINES[-1].latch_time
    time = np.array([last])
    angles = [line.angle(time, time >= line.latch_time)[0] for line in reference.LINES]
    released = 2.0 * reference.MOTOR_TORQUE * sum(angles)
    assert found.motor_energy == pytest.approx(released, rel=1e-9)


def test_energy_residual_is_relative_to_the_energy_exchanged(found):
    """The accounts of the reference all grow, so what they gained up to the end is what was exchanged."""
    _, signals = reference.signals()
    gained = sum(
        s["dissipated_energy"].values[-1]
        for n, s in signals.items()
        if n != "scene" and "dissipated_energy" in s
    )
    assert found.energy_exchanged == pytest.approx(gained, rel=1e-9)
    assert found.numerical_dissipation == reference.NUMERICAL
    assert found.energy_residual == pytest.approx(reference.RESIDUAL / gained, rel=1e-6)
    assert found.warnings == ()


def test_headline_goes_through_json(found):
    assert json.loads(json.dumps(found.as_dict()))["latch_times"]["hl2"] == 8.2


def test_table_shows_every_number(found):
    console = Console(width=120, record=True)
    console.print(*headline_tables(found, every=True))
    text = console.export_text()
    assert "latch torque" in text
    assert "8.200000" in text


def test_round_off_reads_zero_and_absent_forces_are_left_out(found):
    """1e-9 N beside 200 N, minus zero, and the lateral force of a free loop."""
    forces = {"tension_a": (-0.0, 40.0), "lateral_force": (-0.0, -1e-12)}
    noisy = replace(found, interface_force_peaks=(200.0, 1.2e-9, 0.03), force_extremes={"loop": forces})
    shown = {(quantity, of): value for quantity, of, value, *_ in headline_rows(noisy)}
    assert [shown["interface force peak", axis] for axis in "xyz"] == ["200", "0", "0.03"]
    assert shown["strand A tension min", "loop"] == "0"
    assert not [key for key in shown if key[0].startswith("lateral")]


def test_motor_energy_says_until_when(found):
    def until(headline):
        return next(of for quantity, of, *_ in headline_rows(headline) if quantity == "motor work")

    assert until(found).endswith("latch-up")
    assert until(replace(found, latch_times={})) == "whole run"


def test_scene_without_anything_to_judge_gives_an_empty_headline(tmp_path):
    everything = tuple(reference.signals()[1])
    path = reference.write(tmp_path / "run.h5", leave_out=everything[:-1])
    found = headline(Result.open(path))
    assert found.interface_force_peaks == ()
    assert found.torque_peaks == {}
    assert found.energy_residual is None


def test_cubic_is_found_exactly_with_unequal_steps():
    time = np.array([0.0, 0.1, 0.5, 0.6, 1.1])
    low, high = extremes(time, 3.0 * time * (1.0 - time) ** 2)
    assert high.value == pytest.approx(4.0 / 9.0, rel=1e-12)
    assert high.time == pytest.approx(1.0 / 3.0, rel=1e-12)
    assert low.value == 0.0


@pytest.mark.filterwarnings("error")
def test_lines_and_parabolas_are_cubics_too():
    """Closed form, and a regression: NumPy spoke of invalid values."""
    time = np.arange(8.0)
    assert extremes(time, 5.0 * time - time**2)[1] == pytest.approx((2.5, 6.25), rel=1e-12)
    assert extremes(time, 3.0 - 2.0 * np.abs(time - 4.0))[1] == (4.0, 3.0)


@pytest.mark.parametrize("copies", [1, 2])
def test_no_interpolant_crosses_an_event(copies):
    time = np.sort(np.concatenate([np.linspace(0.0, 2.0, 21), [1.0] * (copies - 1)]))
    after = np.arange(time.size) >= 10 + copies
    low, high = extremes(time, np.where(after, 5.0, 0.0), [1.0])
    assert (low.value, high.value) == (0.0, 5.0)


def test_higher_of_two_humps_is_found_though_its_samples_are_lower():
    time = np.concatenate([np.arange(0.5, 1.55, 0.1), np.arange(1.65, 2.5, 0.1)])
    values = np.cos(2.0 * np.pi * time) * (1.0 + 0.05 * time)
    assert time[np.argmax(values)] == pytest.approx(1.0)
    assert extremes(time, values)[1] == pytest.approx((2.0, 1.1), rel=5e-3)


def test_latch_impulse_is_no_peak_between_samples():
    time = np.array([0.0, 0.2, 0.4, 0.6, 0.6 + 1e-7, 0.8, 1.0, 1.2, 1.4])
    values = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0])
    low, high = extremes(time, values, [0.6])
    assert (low.value, high.value) == (0.0, 1.0)


def test_few_samples_give_the_largest():
    low, high = extremes(np.array([0.0, 1.0]), np.array([2.0, 1.0]))
    assert (low.value, high.value) == (1.0, 2.0)


def test_jump_at_the_start_makes_no_peak():
    """Regression: no interpolant overshoots where loads jump from nothing in the first step of a run."""
    time = np.array([0.0, 1e-3, 2e-3, 3e-3, 4e-3])
    result = SimpleNamespace(time=time, events=[])
    assert peak(result, np.array([0.0, 1.6, 1.6, 1.59, 1.58])).value == pytest.approx(1.6, abs=2e-3)


def test_a_cubic_through_a_kink_makes_no_peak():
    """After a coarse step a fine one can have any slope; the cubic through both would overshoot sixtyfold."""
    time = np.array([0.0, 1.0, 2.0, 2.03, 2.06, 2.09])
    values = np.array([0.0, -11.0, 17.0, 3.0, 2.0, 1.0])
    assert extremes(time, values)[1] == (2.0, 17.0)


def test_what_rises_to_a_plateau_is_not_higher_than_that():
    """Regression: a torque that friction holds at 4 N.m was told as 4.25, from a cubic through the plateau's end."""
    values = np.array([0.0, 1.0, 3.0, 3.9, 4.0, 4.0, 4.0, 4.0, 0.5, -2.0])
    assert extremes(np.arange(10.0), values)[1].value == 4.0


@pytest.mark.parametrize("across", [0.0, 0.5, 0.55, 2.0])
def test_hinges_that_bend_across_their_line_are_told(across):
    """Closed form: a turn about the line's own axis is none of it; one across it is told from 30 deg on."""
    axis = Rotation.from_rotvec([0.0, 0.0, 0.7]).apply([0.0, 1.0, 0.0])
    inboard = Rotation.from_rotvec(np.linspace([0.2, 0.1, 0.0], [0.9, -0.3, 0.4], 3))
    own = Rotation.from_rotvec(np.outer([0.0, 1.5, 3.0], inboard[0].inv().apply(axis)))
    bend = Rotation.from_rotvec(np.outer([0.0, across, 0.0], [0.0, 0.0, 1.0]))
    turns = {"inner": inboard, "outer": inboard * own * bend}
    own_axis = inboard[0].inv().apply(axis)
    tilted = np.degrees(np.arccos(np.clip(bend[1].apply(own_axis) @ own_axis, -1.0, 1.0)))
    line = HingeLine("HL", ("h",), "h", True, False, parts=("inner", "outer"), axis=tuple(axis))
    result = SimpleNamespace(
        events=[],
        hinge_lines=(line,),
        time=np.array([0.0, 1.0, 2.0]),
        has=lambda name, variable: name in turns and variable == "frame_orientation",
        signal=lambda name, variable: turns[name].as_quat(scalar_first=True),
    )
    sentences = list(_bent(result, line))
    assert (tilted > 30.0) == bool(sentences)
    assert all(f" {tilted:.0f} deg at 1 s" in one for one in sentences)


@pytest.mark.filterwarnings("ignore:.*W-no-end")  # nothing stops it
@pytest.mark.filterwarnings("ignore:.*root_line.*W-bent")  # said by the headline
def test_a_run_whose_hinges_bend_says_so():
    """A panel on one hinge without stiffness across it, weighed down: line, angle and time in a sentence."""
    scene = fanfold.load(SCENES / "two_panels.toml").with_settings(
        {"joint.cross_stiffness": 0.5, "scene.gravity": [0.0, 3.0, 0.0], "hinge_line.middle_line.held": True}
    )
    found = fanfold.simulate(scene, until="1.5 s", tolerance=1e-3, estimate=False, refine=False)
    (sentence,) = [told for told in found.warnings if "W-bent" in told]
    assert "root_line" in sentence


def test_motor_energy_is_what_was_given_whatever_an_event_sets():
    """Regression: 1.8 J given before a motor failed were told as none. Between rows of one instant nothing moves."""
    time = np.array([0.0, 1.0, 2.0, 2.0 + 1e-7, 3.0, 4.0])
    energy = np.array([0.0, 1.0, 1.8, 0.0, 0.0, 0.0])
    assert _given(time, energy, 4.0) == pytest.approx(1.8)
    assert _given(time, energy, 1.5) == pytest.approx(1.4)
