"""What tells two runs from each other, and that comparisons of different scenes say so."""

import json
from dataclasses import replace

import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.cli.main import main
from orchestrator.results.differences import differences, distinctions, scene_note
from orchestrator.results.result import Result
from orchestrator.views.comparison import draw_comparison
from tests.references import synthetic_result as reference

TREE = {
    "scene": {"name": "wing", "description": "a"},
    "body": [{"name": "yoke", "mass": 2}],
    "joint": {"k": 1e6},
}


def told(result, scene="wing", flexible=(), tree=TREE, **settings):
    known = {"scene": scene, "flexible": json.dumps(flexible), "scene_tree": json.dumps(tree), **settings}
    return replace(result, provenance=known)


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return Result.open(reference.write(tmp_path_factory.mktemp("differences") / "run.h5"))


def test_fidelities_settings_and_values_differ(result):
    other = {**TREE, "scene": {"name": "wing", "description": "b"}, "body": [{"name": "yoke", "mass": 3}]}
    a = told(result, tolerance="0.001", order="4")
    b = told(result, flexible=["yoke"], tree=other, tolerance="0.0001", order="4")
    assert differences(a, b) == [
        ("flexible", "none", "yoke"), ("tolerance", "0.001", "0.0001"), ("body.yoke.mass", "2", "3"),
    ]  # fmt: skip
    assert distinctions(a, b) == (
        "flexible none, tolerance 0.001, 1 more",
        "flexible yoke, tolerance 0.0001, 1 more",
    )
    assert distinctions(a, a) == ("", "")


def test_different_scenes_are_told(result):
    a, b = told(result), told(result, scene="other")
    assert scene_note(a, told(result, flexible=["yoke"])) == ""
    assert all(name in scene_note(a, b) for name in ("'wing'", "'other'"))
    fewer = replace(a, hinge_lines=a.hinge_lines[:2])
    assert all(names in scene_note(a, fewer) for names in ("hl1, hl2, hl3", "hl1, hl2"))
    with pytest.warns(fanfold.FanfoldWarning, match="W-different-scenes"):
        fanfold.compare(a, b)


def test_the_command_warns(tmp_path):
    """It gave a table of ratios of two different wings without a word."""
    others = tuple(name for name in reference.signals()[1] if name != "damper")  # one overlay
    plain = Result.open(reference.write(tmp_path / "plain.h5", leave_out=others))
    paths = []
    for scene in ("wing", "other"):
        one = told(plain, scene=scene)
        paths.append(str(fanfold.Result.of(one).save(tmp_path / f"{scene}.h5").path))
    run = CliRunner().invoke(main, ["compare", *paths, "--output", str(tmp_path / "out")])
    assert run.exit_code == 0
    assert "W-different-scenes" in run.stderr


def test_legends_say_what_differs_and_empty_panels_are_left_out(result):
    """Legends said the file names only; a lateral force of nothing took a quarter of the page."""
    a, b = told(result), told(result, flexible=["yoke"])
    drawings = {drawing.name: drawing.figure for drawing in draw_comparison(a, b)}
    legend = [text.get_text() for text in drawings["angles"].legends[0].get_texts()]
    assert ["flexible none" in legend[0], "flexible yoke" in legend[1]] == [True, True]
    for figure in drawings.values():
        for axes in figure.axes:
            if axes.get_visible():
                assert max(abs(line.get_ydata()).max() for line in axes.lines) > 0.0
