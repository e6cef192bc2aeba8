"""Figures: which are drawn, what is marked in them, and where the bodies are."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.image import imread

from orchestrator import plot_shapes, plots
from orchestrator.result import Result
from tests.references import synthetic_result as reference

EVERY_FIGURE = {
    "deployment_angles",
    "latch_torques",
    "cable_forces",
    "damper_torques",
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
    assert len(lines) == 6
    assert len({(line.get_color(), line.get_linestyle()) for line in lines}) == 6
    assert len({line.get_linestyle() for line in lines[:4]}) == 4


def test_events_are_marked_with_the_name_of_the_line(result):
    axes = plots.deployment_angles(result).axes[0]
    assert [text.get_text() for text in axes.texts] == ["hl1", "hl2", "hl3"]
    assert [text.xy[0] for text in axes.texts] == [6.0, 8.2, 9.7]


def test_axes_carry_units(result):
    assert plots.deployment_angles(result).axes[0].get_ylabel() == "hinge angle, deg"
    for draw in (plots.damper_torques, plots.interface_loads, plots.cable_forces, plots.steps):
        for axes in draw(result).axes:
            assert axes.get_xlabel() == "time, s"
            assert axes.get_ylabel()


def test_instants_run_from_folded_to_the_last_latch_up(result):
    times = result.time[plot_shapes.instants(result)]
    assert times.size == 6
    assert times[0] < 0.2
    assert times[-1] == reference.LINES[-1].latch_time


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
