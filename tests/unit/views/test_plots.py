"""Figures: which are drawn, what is marked in them, and where the bodies are."""

from dataclasses import replace
from itertools import pairwise

import h5py
import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.text import Text
from mpl_toolkits.mplot3d.proj3d import proj_transform

from components import FanfoldError
from components.contract.roles import LOAD
from orchestrator.results.key_figures import headline
from orchestrator.results.parts import Meaning
from orchestrator.results.result import Result
from orchestrator.views import plots, space
from orchestrator.views import shapes as plot_shapes
from orchestrator.views.depth import back_to_front
from orchestrator.views.stress import _histories as stress_histories
from tests.references import synthetic_result as reference

EVERY_FIGURE = {
    "deployment_angles",
    "latch_torques",
    "closed_cable_loop_loads",
    "damper_loads",
    "interface_loads",
    "energy_balance",
    "steps",
    "shapes",
}


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return Result.open(reference.write(tmp_path_factory.mktemp("plots") / "run.h5"))


def test_every_figure_is_written_and_not_blank(result, tmp_path):
    before = dict(mpl.rcParams)
    written = plots.plot_all(result, tmp_path / "figures")
    assert {path.stem for path in written} == EVERY_FIGURE
    for path in written:
        assert imread(path)[..., :3].std() > 0.02
    assert dict(mpl.rcParams) == before


def test_formats_that_there_are_none_of_are_a_sentence(result, tmp_path):
    with pytest.raises(FanfoldError, match="png"):
        plots.plot_all(result, tmp_path, "pgn")


def test_figures_without_signals_are_skipped(tmp_path):
    bodies = tuple(reference.LENGTHS)
    path = reference.write(tmp_path / "run.h5", leave_out=("ccl", "damper", "base", "scene", *bodies))
    written = plots.plot_all(Result.open(path), tmp_path, format="svg")
    assert [path.name for path in written] == ["deployment_angles.svg", "latch_torques.svg"]


def test_close_ups_begin_before_the_latch_and_hold_the_true_peak(result):
    figure = plots.latch_torques(result)
    assert len(figure.axes) == 1 + len(reference.LINES)
    for axes, line in zip(figure.axes[1:], reference.LINES, strict=True):
        left, right = axes.get_xlim()
        assert left < line.latch_time < right < reference.END
        marked = axes.lines[1].get_ydata()
        assert abs(np.ravel(marked)[0]) == pytest.approx(line.torque_peak, rel=2e-5)


def test_curves_of_one_axes_differ_in_colour_and_in_line_style(result):
    lines = [line for line in plots.energy_balance(result).axes[1].lines if line.get_label()[0] != "_"]
    assert len(lines) == 7
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == 7
    assert len({line.get_linestyle() for line in lines[:4]}) == 4


def test_events_are_marked_with_the_name_of_the_line(result):
    axes = plots.deployment_angles(result).axes[0]
    assert [text.get_text() for text in axes.texts] == ["hl1", "hl2", "hl3"]
    left, right = axes.get_xlim()
    assert [left + text.xy[0] * (right - left) for text in axes.texts] == pytest.approx([6.0, 8.2, 9.7])


def test_axes_carry_units(result):
    assert plots.deployment_angles(result).axes[0].get_ylabel() == "hinge angle, deg"
    for name in ("damper_loads", "interface_loads", "closed_cable_loop_loads", "steps"):
        for axes in plots.draw_one(result, name).figure.axes:
            assert axes.get_xlabel() == "time, s"
            assert axes.get_ylabel()


def test_loads_of_a_kind_nobody_thought_of_are_drawn(result):
    """Roles alone decide: a signal in the role of a load has its figure, by the noun of its component."""
    loads = plots.loads_by_kind(result)
    assert loads["damper_loads"] == [("damper", "damper_torque")]
    catalogue = {**result._catalogue, "strut": {"thrust": Meaning("N", "Thrust of the strut", LOAD)}}
    signals = {(n, v): result.signal(n, v) for n in result.components for v in result.variables(n)}
    signals["strut", "thrust"] = np.sin(result.time)
    strange = replace(
        result, path=None, _catalogue=catalogue, _signals=signals, _nouns={"strut": "gas strut"}
    )
    (line,) = plots.draw_one(strange, "gas_strut_loads").figure.axes[0].lines[:1]
    np.testing.assert_array_equal(line.get_ydata(), np.sin(result.time))
    assert headline(strange).force_extremes["strut"]["thrust"] == pytest.approx((-1.0, 1.0), abs=1e-4)


def test_all_that_is_dissipated_has_a_cause(result):
    """Sum over causes against the total of all components, without what the scheme took."""
    causes = dict(plots.dissipated_by_cause(result))
    scheme = causes.pop("numerical loss")
    total = result.signal("scene", "dissipated_energy")
    np.testing.assert_allclose(sum(causes.values()), total - total[0], atol=1e-12)
    assert set(causes) == {
        "hinge friction",
        "hinge latch",
        "hinge damping",
        "body",
        "closed cable loop",
        "damper",
    }
    assert scheme.any()


def test_instants_run_from_folded_over_the_last_latch_up_to_the_end(result):
    times = result.time[plot_shapes.instants(result)]
    assert times.size == 6
    assert times[0] < 0.2
    assert list(times[-2:]) == [reference.LINES[-1].latch_time, reference.END]


def test_deformed_bodies_meet_where_they_are_hinged(result):
    rows = np.array([0, 400, result.time.size - 1])
    nodes = {n: plot_shapes.placed(result, n, body, rows) for n, body in result.geometry.items()}
    hinge_of_panel1 = nodes["panel1"][:, :5].mean(1)
    end_of_yoke = nodes["yoke"][:, -5:].mean(1)
    np.testing.assert_allclose(
        np.linalg.norm(hinge_of_panel1 - end_of_yoke, axis=1), reference.GAP, atol=1e-12
    )
    coordinates = result.signal("panel1", "modal_coordinate")[rows]
    tip = nodes["panel1"][:, -5:].mean(1) - hinge_of_panel1
    expected = np.hypot(reference.LENGTHS["panel1"], coordinates[:, 0])
    np.testing.assert_allclose(np.linalg.norm(tip, axis=1), expected, rtol=1e-12)


def test_base_without_motion_is_drawn_where_it_is(result):
    body = result.geometry["yoke"]
    np.testing.assert_array_equal(
        plot_shapes.placed(result, "base", body, np.array([0, 5]))[1], body.positions
    )


def test_close_up_marks_the_peak_of_the_lines_own_ringing(result, tmp_path):
    """A later and tenfold torque, after other lines latched: told of beside the whole run only."""
    path = reference.write(tmp_path / "later.h5")
    late = reference.LINES[-1].latch_time
    with h5py.File(path, "r+") as file:
        after = file["time"][:] > late
        for hinge in result.hinge_lines[0].hinges:
            if "latch_torque" in file["signals"][hinge]:
                file["signals"][hinge]["latch_torque"][after] = 10.0 * reference.LINES[0].torque_peak
    figure = plots.latch_torques(Result.open(path))
    line, axes = reference.LINES[0], figure.axes[1]
    assert abs(np.ravel(axes.lines[1].get_ydata())[0]) == pytest.approx(line.torque_peak, rel=2e-5)
    assert line.latch_time <= np.ravel(axes.lines[1].get_xdata())[0] < axes.get_xlim()[1]
    assert axes.get_xlim()[1] <= reference.LINES[1].latch_time
    assert max(map(abs, axes.get_ylim())) < 1.5 * line.torque_peak
    texts = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert texts[0].startswith("hl1, largest")
    assert texts[1:] == ["hl2", "hl3"]


def test_labels_of_close_events_stand_side_by_side(result):
    """Lines that latch 29 ms apart had one label over three marks, on top of the curves."""
    near = [(8.0, "a", "x"), (8.01, "b", "x"), (8.029, "c", "x"), (12.0, "d", "x")]
    figure = plots.deployment_angles(replace(result, events=near))
    axes = figure.axes[0]
    figure.draw_without_rendering()
    assert [text.get_text() for text in axes.texts] == ["a", "b", "c", "d"]
    boxes = [Text.get_window_extent(text) for text in axes.texts]  # without their leaders
    assert all(left.x1 <= right.x0 for left, right in pairwise(boxes))
    assert all(box.y0 > axes.get_window_extent().y1 for box in boxes)


def test_labels_of_stress_histories_stand_side_by_side():
    """Regression: the names of lines that latch together were printed over each other."""
    time, marks = np.linspace(0.0, 20.0, 50), {"HL4": 12.0, "HL3": 12.02, "HL2": 12.7}
    figure = stress_histories("panel", time, np.ones((50, 2)), np.array([3, 4]), marks)
    figure.draw_without_rendering()
    boxes = [Text.get_window_extent(text) for text in figure.axes[0].texts]
    assert len(boxes) == 3
    assert all(left.x1 <= right.x0 for left, right in pairwise(boxes))


def test_angles_are_named_by_line(result):
    handles = plots.deployment_angles(result).axes[0].get_legend_handles_labels()[1]
    assert handles == ["hl1", "hl2", "hl3"]


def test_a_close_up_shows_the_peak_of_a_line_beside_which_another_latches(result):
    """The close-up ended where the next line latched 20 ms later and ringed its own edge as the peak."""
    near = [(8.22 if name == "hl3" else time, name, text) for time, name, text in result.events]
    line = reference.LINES[1]
    axes = plots.latch_torques(replace(result, events=near)).axes[2]
    low, high = axes.get_xlim()
    assert high - low > 3.0 * np.pi / line.frequency  # several swings
    told = axes.get_legend_handles_labels()[1][1].split()
    assert float(told[2]) == pytest.approx(-line.torque_peak, rel=1e-3)


def test_a_line_that_nothing_keeps_is_marked_in_the_angles(result):
    """Its deployed angle is drawn where it went beyond; here hl3, which turns by half a turn."""
    loose = [replace(one, deployed_angle=2.0 if one.name == "hl3" else None) for one in result.hinge_lines]
    axes = plots.deployment_angles(replace(result, hinge_lines=tuple(loose))).axes[0]
    assert f"deployed at {np.rad2deg(2.0):g} deg" in axes.get_legend_handles_labels()[1]


def test_interrupted_runs_say_so_in_every_title(result):
    stopped = replace(result, complete=False)
    for drawing in plots.draw_all(stopped):
        assert drawing.figure.get_suptitle().endswith("; interrupted at t = 14 s")
    assert all("interrupted" not in d.figure.get_suptitle() for d in plots.draw_all(result))


def test_everything_fits_into_the_axes(result):
    """Independent: matplotlib's own projection of the corners of every body, in parts of the square it draws in."""
    structure = plot_shapes.Structure(result, plot_shapes.instants(result))
    for axes in plot_shapes.shapes(result).axes:
        size = axes.get_position(original=True).size * axes.figure.get_size_inches()
        corners = np.concatenate([nodes.reshape(-1, 3) for nodes in structure._nodes.values()])
        x, y, _ = proj_transform(*corners.T, axes.get_proj())
        inches = np.array([np.abs(x).max(), np.abs(y).max()]) / axes.viewLim.width * 2.0 * size.min()
        assert np.all(inches < size - 0.5)
        assert np.any(inches > 0.6 * (size - space._MARGINS))


PLATE = np.array([[x, y, 0.0] for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0)])
RIGHT, UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, np.cos(1.0), np.sin(1.0)])


def test_stacked_plates_are_drawn_from_the_back_whatever_their_middles():
    """Closed form: of parallel plates the one on the viewer's side is in front, though its middle lies deeper."""
    towards = np.cross(RIGHT, UP)
    shifted = PLATE + np.array([0.0, 0.5 * np.sign(-towards[1]), 0.01 * np.sign(towards[2])])
    assert np.mean(shifted @ towards) < np.mean(PLATE @ towards)
    assert back_to_front({"front": shifted, "back": PLATE}, RIGHT, UP) == ["back", "front"]
    assert back_to_front({"back": PLATE, "front": shifted}, RIGHT, UP) == ["back", "front"]


def test_a_beam_has_no_plane_and_goes_by_the_plate():
    beam = np.array([[0.5, 0.5, -0.1], [1.5, 0.5, -0.1]])
    below = np.sign(np.cross(RIGHT, UP)[2])
    first = "beam" if below > 0.0 else "plate"
    assert back_to_front({"plate": PLATE, "beam": beam}, RIGHT, UP)[0] == first
