"""Files of finite elements that change while a program goes on: what is computed is of the files as they are."""

from dataclasses import replace

import pytest

import orchestrator as fanfold
from components.imported.matrices import write_npz
from orchestrator.analysis.sampling.distributions import StudyError
from orchestrator.analysis.sampling.journal import Journal, journal_file
from tests.references.imports.frame_model import bar_frame, frame_data


def scene_of(path):
    """A body of a file on one hinge, opened by a spring."""
    scene = fanfold.Scene("changed", until=0.2)
    base = scene.base(points={"root": (0, 0, 0)})
    points = {"root": 1, "tip": 2}
    body = scene.body("p", **{"import": {"file": str(path), "attachment_points": points}})
    scene.hinge_line(
        "H", base, body, axis="+y", aligned_angle="90 deg", hinges={"h": "root"},
        motor={"stowed": "5 N.m", "deployed": "1 N.m"}, latch={"kind": "spring", "stiffness": 1e4},
    )  # fmt: skip
    return scene


def masses(path):
    return next(body.mass for body in fanfold.check_scene(scene_of(path)).bodies if body.name == "p")


def test_a_file_that_is_written_anew_is_read_anew(tmp_path):
    """Doubled mass: the same path in one session. Regression: what it was first stayed, in runs and in checks."""
    path, data = tmp_path / "p.npz", frame_data(bar_frame())
    write_npz(path, data)
    before = masses(path)
    write_npz(path, replace(data, mass=2.0 * data.mass))
    assert masses(path) == pytest.approx(2.0 * before, rel=1e-9)


def test_a_study_does_not_go_on_with_another_model(tmp_path):
    """Regression: samples of two models stood in one table, without a word."""
    path, study, data = tmp_path / "p.npz", tmp_path / "s.h5", frame_data(bar_frame())
    write_npz(path, data)
    asked = {"rigid": "all", "runs": 2, "until": 0.05, "tolerance": 1e-2}
    vary = {"hinge_line.H.friction_preload": "uniform(0.04, 0.06)"}
    whole = fanfold.study(scene_of(path), vary, **asked)
    Journal.begin(study, whole.asked).__exit__()
    write_npz(path, replace(data, mass=2.0 * data.mass))
    with pytest.raises(StudyError, match=r"p\.npz .*study"):
        fanfold.resume_study(study)
    write_npz(path, data)
    fanfold.resume_study(study)
    assert not journal_file(study).exists()
