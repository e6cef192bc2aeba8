"""Effective inertia of a line: values of data sheets, and closed forms."""

import pytest

from orchestrator.assembly.assemble import assemble
from orchestrator.scene import SceneError, find_scene, load_scene
from tests.unit.scene.scene_cases import LATCH, TWO_PANELS, load_text, parts_of

SHEET = {
    ("workbench", "HL"): 6.2514,
    ("amos3", "HL1"): 115.3,
    ("amos3", "HL2"): 1.895,
    ("amos3", "HL3"): 0.921,
}


@pytest.mark.parametrize(("name", "line"), SHEET)
def test_that_of_the_data_sheets(name, line):
    """Worked out by hand for the sheets, to the digits they have."""
    scene = load_scene(find_scene(name))
    (found,) = [one for one in scene.hinge_lines if one.name == line]
    assert scene.effective_inertia(found) == pytest.approx(SHEET[name, line], rel=5e-4)


def test_two_free_bodies(tmp_path):
    """Closed form: J1 J2 / (J1 + J2) about the line for two bodies whose centres of mass are on it."""
    text = TWO_PANELS.replace("center_of_mass = [0.8, 0.0, 0.0]", "center_of_mass = [0.0, 0.0, 0.0]")
    text = text.replace("points = { root = [0.0, 0.0, 0.0] }\n", "points = { root = [0.0, 0.0, 0.0] }\n"
                        "free = { mass = 100, center_of_mass = [0, 0, 0], inertia = [30, 40, 50] }\n")  # fmt: skip
    text = (
        text[: text.index('[[body]]\nname = "outer"')]
        + text[text.index("[[hinge_line]]") : text.rindex("[[hinge_line]]")]
    )
    scene = load_text(tmp_path, text)
    assert scene.effective_inertia(scene.hinge_lines[0]) == pytest.approx(40 * 1.8 / 41.8, rel=1e-12)


def test_a_latch_without_one_is_damped_by_it(tmp_path):
    """2 zeta sqrt(k J): the damping of the same scene with the computed inertia written down."""
    bare = LATCH.replace(", effective_inertia = 5", "")
    text = TWO_PANELS.replace("hinges = [", bare + "hinges = [", 1)
    scene = load_text(tmp_path, text)
    inertia = scene.effective_inertia(scene.hinge_lines[0])
    part = parts_of(assemble(scene))["root"]
    assert part.start["latch_damping"] == pytest.approx(2 * 0.02 * (2000 * inertia) ** 0.5)


def test_masses_too_unlike_to_tell_it_are_told(tmp_path):
    """Found by the benchmark of mutated scenes: it was a LinAlgError."""
    text = TWO_PANELS.replace("inertia = [0.8, 1.6, 2.4]", "inertia = [1e29, 1e29, 1e29]")
    scene = load_text(tmp_path, text)
    with pytest.raises(SceneError, match=r"middle_line.latch.effective_inertia: "):
        scene.effective_inertia(scene.hinge_lines[1])
