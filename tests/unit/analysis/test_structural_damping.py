"""Structural damping: what bodies, hinges and latches get, and the closed form of every assembled mode."""

import json
import re
from math import pi

import numpy as np
import pytest
from click.testing import CliRunner

from orchestrator.analysis.modes import mode_table
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.configuration import configuration, loaded, placed
from orchestrator.assembly.statics.linear_model import linearise, modal_damping, normal_modes
from orchestrator.cli.main import main
from orchestrator.scene import find_scene, load_scene
from tests.references.edits import edited
from tests.unit.scene.scene_cases import SCENES, TWO_PANELS, amos3_text, load_text, parts_of, problems_of

PANEL = SCENES / "structural_damping.toml"
RATIO, REFERENCE = 0.005, 2.0
TIME = RATIO / (pi * REFERENCE)
OWN = '{ ratio = 0.005, reference_frequency = "2 Hz" }'


def model_of(scene, how, latched="all", rigid=()):
    return linearise(how(scene, rigid, (), configuration(scene, "deployed", latched=latched)))


@pytest.mark.parametrize("latched", ["all", "none"])
@pytest.mark.parametrize("rigid", [(), ("panel",)])
def test_every_assembled_mode_gets_the_ratio_in_proportion_to_its_frequency(rigid, latched):
    """Closed form: C = (2 zeta / w_ref) K has the modes of K, mode j damped zeta f_j / f_ref, to differences' 1e-11."""
    model = model_of(load_scene(PANEL), placed, latched, rigid)
    modes = normal_modes(model)
    assert len(modes.frequencies) == (6 if rigid else 22)
    np.testing.assert_allclose(modal_damping(model, modes), RATIO * modes.frequencies / REFERENCE, rtol=1e-9)


@pytest.mark.parametrize("rigid", [(), ("panel1",), ("yoke", "panel1", "panel2")])
def test_a_whole_wing_gets_it_at_any_fidelity(tmp_path, rigid):
    """The same of AMOS-3 without loops and damper; motors and their preload are 1e-4 of its latch springs."""
    text = amos3_text()
    text = f"structural_damping = {OWN}\n" + text[: text.index("[[ccl]]")]
    model = model_of(load_text(tmp_path, text), loaded, rigid=rigid)
    modes = normal_modes(model)
    found = modal_damping(model, modes)[:8]
    np.testing.assert_allclose(found, RATIO * modes.frequencies[:8] / REFERENCE, rtol=2e-4)


def test_a_body_of_its_own_damps_by_its_share_of_the_strain_energy(tmp_path):
    """Closed form: phi' C phi = time x the body's part of phi' K phi, where nothing else is damped."""
    before, table, after = PANEL.read_text(encoding="utf-8").partition("[structural_damping]")
    assert table
    text = edited(
        before + after[after.index("[[hinge_line]]") :],
        ("modes = 10", f"modes = 10, structural_damping = {OWN}"),
        ("effective_inertia", "damping_ratio = 0, effective_inertia"),
    )
    model = model_of(load_text(tmp_path, text), placed)
    modes = normal_modes(model)
    rows = model.mechanism.rows["panel"]
    _, stiffness = model.mechanism.bodies["panel"].modal_matrices()
    strain = np.einsum("ik,ij,jk->k", modes.shapes[rows], stiffness, modes.shapes[rows])
    share = strain / modes.eigenvalues
    assert 0.2 < share[0] < 0.8  # the case is neither of the trivial ones
    expected = share * RATIO * modes.frequencies / REFERENCE
    np.testing.assert_allclose(modal_damping(model, modes), expected, rtol=1e-6, atol=1e-12)


def test_hinges_and_latches_take_it_in_place_of_their_own():
    """Damping over stiffness is the time 2 zeta / w_ref of each, of a measured latch that of the missing compliance."""
    for name, stiffness in ((str(PANEL), None), ("bepicolombo", 2939.0)):
        settings = ("structural_damping.ratio=0.5 %", "structural_damping.reference_frequency=2 Hz")
        parts = parts_of(assemble(load_scene(find_scene(name), (), settings)))
        hinges = [part for part in parts.values() if part.kind == "hinge"]
        for hinge in hinges:
            for kind in ("translational", "rotational"):
                damping = np.array(hinge.start[f"{kind}_damping"])
                np.testing.assert_allclose(damping, TIME * np.array(hinge.start[f"{kind}_stiffness"]))
            assert hinge.start["latch_damping"] == pytest.approx(TIME * hinge.start["latch_stiffness"])
        if stiffness is not None:
            found = sum(hinge.start["latch_damping"] for hinge in hinges)
            assert found == pytest.approx(TIME * stiffness, rel=1e-3)


def ratios(*settings):
    parts = parts_of(assemble(load_scene(PANEL, (), settings)))
    return parts["panel"].structure["modal"]


def test_what_a_body_says_itself_comes_first():
    """The scene's ratio, the body's own reference, the body's viscous ratio."""
    frequency = ratios()["frequency"] / (2.0 * pi)
    np.testing.assert_allclose(ratios()["damping_ratio"], RATIO * frequency / REFERENCE)
    own = "body.panel.structural_damping"
    found = ratios(f"{own}.ratio=0.01", f"{own}.reference_frequency=50 Hz")["damping_ratio"]
    np.testing.assert_allclose(found, 0.01 * frequency / 50.0)
    assert set(ratios("body.panel.damping_ratio=3 %")["damping_ratio"]) == {0.03}


MISTAKES = {
    "no reference": (
        "[structural_damping]\nratio = 0.01",
        "structural_damping.reference_frequency: is missing",
    ),
    "no ratio": (
        '[structural_damping]\nreference_frequency = "1 Hz"',
        "structural_damping.ratio: is missing",
    ),
    "zero reference": (
        "[structural_damping]\nratio = 0.01\nreference_frequency = 0",
        "structural_damping.reference_frequency: ",
    ),
    "negative reference": (
        '[structural_damping]\nratio = 0.01\nreference_frequency = "-1 Hz"',
        "structural_damping.reference_frequency: ",
    ),
    "reference near zero": (
        "[structural_damping]\nratio = 0.01\nreference_frequency = 1e-9",
        "structural_damping.reference_frequency: ",
    ),
    "per cent without the sign": (
        "[structural_damping]\nratio = 5\nreference_frequency = 1",
        "structural_damping.ratio: ",
    ),
    "negative ratio": (
        "[structural_damping]\nratio = -0.01\nreference_frequency = 1",
        "structural_damping.ratio: ",
    ),
    "unknown key": (
        "[structural_damping]\nratio = 0.01\nreference_frequency = 1\nfrequency = 1",
        "structural_damping.frequency: is not a known key",
    ),
    "a number": ("structural_damping = 0.01", "structural_damping: "),
    "a list": ("[[structural_damping]]\nratio = 0.01", "structural_damping: is "),
}


@pytest.mark.parametrize("kind", MISTAKES)
def test_mistakes_are_sentences(tmp_path, kind):
    """One mistake is one sentence with file and key."""
    text, sentence = MISTAKES[kind]
    found = problems_of(tmp_path, f"{text}\n{TWO_PANELS}")
    assert len(found) == 1
    assert found[0].startswith(f"wing.toml: {sentence}"), found


def test_a_rigid_body_and_two_answers_are_refused(tmp_path):
    """Nonsense of one body, named with the body."""
    table = f"structural_damping = {OWN}"
    found = problems_of(tmp_path, edited(TWO_PANELS, ('name = "inner"', f'name = "inner"\n{table}')))
    (problem,) = found
    assert problem.startswith("wing.toml: body.inner: ")
    assert "structural_damping" in problem
    both = f"modes = 10, damping_ratio = 0.01, {table}"
    twice = edited(PANEL.read_text(encoding="utf-8"), ("modes = 10", both))
    found = problems_of(tmp_path, twice)
    (problem,) = found
    assert problem.startswith("wing.toml: body.panel: ")
    assert "damping_ratio" in problem


def test_loops_follow_where_their_strands_are_given_the_same_time():
    """README: strand_damping = strand_stiffness x ratio / (pi f_ref); without, the in-plane mode gets less."""
    time = 0.005 / (pi * 1.5)
    settings = [
        f"ccl.{name}.strand_damping={time * k}" for name, k in (("yoke_loop", 5367), ("panel_loop", 3476))
    ]
    model = model_of(load_scene(find_scene("amos3"), ("structural_damping",), settings), loaded)
    modes = normal_modes(model)
    found = modal_damping(model, modes)[:2] / (0.005 * modes.frequencies[:2] / 1.5)
    np.testing.assert_allclose(
        found, 1.0, atol=5e-4
    )  # motors' springs and the stiffness of preload have none
    alone = model_of(load_scene(find_scene("amos3"), ("structural_damping",)), loaded)
    assert modal_damping(alone, modes)[1] < 0.7 * modal_damping(model, modes)[1]


@pytest.mark.parametrize(
    ("name", "variants"),
    [("amos3", ()), ("bepicolombo", ()), ("arabsat", ("phase2",))],
)
def test_variants_of_the_built_in_wings_are_in_the_measured_range(name, variants):
    """0.1 to 1 % in the first three modes, as measured arrays have; of the first, what the README says without."""
    scene = load_scene(find_scene(name), ("structural_damping", *variants))
    model = model_of(scene, loaded)
    listed = mode_table(model, normal_modes(model), 3)
    assert all(0.001 < mode.damping_ratio < 0.0102 for mode in listed)
    for mode in listed:
        assert 0.99 < sum(mode.damping_shares.values()) <= 1.0 + 1e-9
    if name == "amos3":
        plain = model_of(load_scene(find_scene(name)), loaded)
        assert mode_table(plain, normal_modes(plain), 1)[0].damping_ratio == pytest.approx(4.2e-4, abs=5e-6)


def test_command_says_what_damps_and_by_which_rule():
    """Interface: the table's last lines, and the same in JSON."""
    arguments = ["analyse", "modes", str(PANEL), "--configuration", "deployed", "--latched", "none"]
    text = CliRunner().invoke(main, arguments).stdout
    assert re.search(r"mode 1 .*panel 49 ?%", text)
    assert "structural damping: 0.5 % at 2 Hz" in text
    content = json.loads(CliRunner().invoke(main, [*arguments, "--json"]).stdout)
    assert content["structural_damping"] == {"ratio": 0.005, "reference_frequency_hz": 2.0}
    assert content["modes"][0]["damping_share"]["panel"] == pytest.approx(0.49, abs=0.005)
