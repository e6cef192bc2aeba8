"""Mistakes in scene files: each one a sentence that names file and key, all of them at once, none that is not one."""

import pytest

from orchestrator.scene import SceneError, find_scene, list_scenes
from tests.references.edits import edited
from tests.unit.scene.scene_cases import COMPLETE, HINGES, LATCH, SCENES, STOP, load_text, problems_of

BAD = {
    "mistyped key": (
        'motor = { stowed = "1.6 N.m"',
        'fricton_preload = 1\nmotor = { stowed = "1.6 N.m"',
        "root_line.fricton_preload: ",
    ),
    "mistyped key within": (
        "effective_inertia = 5",
        "efective_inertia = 5",
        "root_line.latch.efective_inertia: ",
    ),
    "steps without end": (
        "until = 2.0",
        'until = 2.0\nlargest_step = "1e-12 ms"',
        "scene.largest_step: …1e-07",
    ),
    "angles that hardly increase": (
        LATCH,
        LATCH + "harness = { angle = ['0 deg', '1e-308 deg'], resisting_torque = [1, 0] }\n",
        "hinge_line.root_line.harness: ",
    ),
    "mistyped table": ("[[damper]]", "[[dampr]]", "dampr: "),
    "unit without its dot": (
        LATCH,
        LATCH + 'friction_preload = "0.15 Nm"\n',
        "is '0.15 Nm'; write '0.15 N.m'",
    ),
    "degrees forgotten": (
        'aligned_angle = "180 deg"',
        "aligned_angle = 180",
        "middle_line.aligned_angle: …'180 deg'",
    ),
    "fifty turns": (
        '"180 deg"',
        '"18000 deg"',
        "'18000 deg'…62.8 rad",
    ),
    "pin in millimetres": (
        "[base]",
        "[friction]\npin_radius = 6\n[base]",
        "friction.pin_radius: …1 m",
    ),
    "pulley in millimetres": ('"30 mm"', "30", "pulley_1.radius: …1 m"),
    "stop behind": (
        LATCH,
        LATCH + "end_stop = { angle = '-5 deg', stiffness = 1e4 }\n",
        "hinge_line.root_line: ",
    ),
    "unknown key": ('name = "inner"', 'name = "inner"\ncolour = 1', "body.inner.colour: is not a known key"),
    "unknown table": ("[base]", "[bases]\n[base]", "bases: is not a known table"),
    "missing value": ('mass = "8 kg"\n', "", "body.inner.rigid.mass: is missing"),
    "missing table": ("[base]\npoints", "[joint]\npoints", "base: is missing"),
    "missing pulley": ("pulley_2 =", "# pulley_2 =", "ccl.loop.pulley_2: is missing"),
    "wrong type": ("until = 2.0", "until = true", "scene.until: "),
    "no number": ("until = 2.0", 'until = "soon"', "scene.until: is 'soon'; give a number"),
    "not finite": ("until = 2.0", "until = inf", "scene.until: "),
    "no vector": ("[0.8, 0.0, 0.0]", "[0.8, 0.0]", "body.inner.rigid.center_of_mass: is [0.8, 0.0]"),
    "wrong unit": ('"8 kg"', '"8 m"', "body.inner.rigid.mass: is '8 m'; give"),
    "wrong unit in a list": ('"770 mm"', '"770 N"', "body.outer.rigid.center_of_mass: is '770 N'"),
    "one table": ("[[damper]]", "[damper]", "damper: …[[damper]]"),
    "bad name": ('name = "two_panels"', 'name = "two panels"', "scene.name: is 'two panels'; a name"),
    "long name": (
        'name = "loop"',
        f'name = "l{"o" * 250}p"',
        f"ccl.l{'o' * 250}p.name: …252…200",
    ),
    "bad axis": ('axis = "+y"', 'axis = "up"', "hinge_line.root_line.axis: "),
    "negative mass": ('"8 kg"', '"-8 kg"', "body.inner.rigid.mass: "),
    "inertia, triangle": (
        "[0.9, 1.8, 2.7]",
        "[0.9, 1.8, 3.7]",
        "body.inner.rigid.inertia: principal moments",
    ),
    "inertia, shape": (
        "[0.9, 1.8, 2.7]",
        "[0.9, 1.8]",
        "body.inner.rigid.inertia: is [0.9, 1.8]; give three",
    ),
    "stiffness": ("stiffness = 2000", "stiffness = 0", "latch.stiffness: "),
    "soft side": ("stiffness = 2500", "stiffness = 9", "latch: "),
    "strand": ('"5 N/mm"', '"-5 N/mm"', "ccl.loop.strand_stiffness: "),
    "rising motor": ('"1.6 N.m"', '"0.6 N.m"', "hinge_line.root_line.motor: "),
    "hinge kind": (
        'kind = "cylindrical"',
        'kind = "ball"',
        "hinge_line.middle_line.hinges.middle_right.kind: ",
    ),
    "incomplete bushing": ('"cylindrical"', '"bushing"', "a bushing needs translational_stiffness"),
    "harness on no hinge": (
        LATCH,
        LATCH + "harness = { angle = ['0 deg', '57 deg'], resisting_torque = [1, 0] }\n",
        "hinge_line.root_line: ",
    ),
    "no hinges": (HINGES, "hinges = []", "hinge_line.root_line: "),
    "hinges as a table": (
        HINGES,
        "hinges = { root = ['root', 'root'] }",
        "name, inboard, outboard,",
    ),
    "angles": ('"180 deg"', '"-1 deg"', "latch_angle, by default aligned_angle"),
    "same name": ('name = "loop"', 'name = "root"', "root_line.hinges.root: "),
    "same body name": ('name = "outer"', 'name = "inner"', "body.inner: "),
    "unknown body": ('body = "outer"', 'body = "tail"', "ccl.loop.pulley_2: "),
    "unknown point": ('point = "left"', 'point = "top"', "ccl.loop.pulley_2: "),
    "unknown hinge": ('hinge = "root"', 'hinge = "axle"', "damper.damper.hinge: "),
    "unknown fidelity": ('name = "inner"', 'name = "inner"\nfidelity = "soft"', "fidelity: is 'soft'"),
    "unknown entry": (
        "[[damper]]",
        '[[body]]\nname = "x"\ncatalogue = "x"\n[[damper]]',
        "entry 'x'",
    ),
    "inline flexible": ('name = "inner"', 'name = "inner"\nfidelity = "flexible"', "body.inner"),
    "no source": ("[[damper]]", '[[body]]\nname = "x"\n[[damper]]', "body.x: give either a catalogue entry"),
    "same point twice": (
        'inboard = "tip_right"',
        'inboard = "tip_left"',
        "hinges.middle_right.inboard: ",
    ),
    "same body twice": ('body = "outer", point = "left"', 'body = "base", point = "root"', "base twice"),
    "disconnected": (
        'inboard = "inner"\noutboard',
        'inboard = "outer"\noutboard',
        "outer: ",
    ),
    "base outboard": ('outboard = "inner"', 'outboard = "base"', "the base"),
    "two inboard lines": (
        '[[hinge_line]]\nname = "middle_line"',
        '[[hinge_line]]\nname = "extra"\ninboard = "base"\noutboard = "inner"\naxis = "+y"\n'
        "aligned_angle = '1 rad'\n"
        'hinges = [{ name = "extra_hinge", inboard = "root", outboard = "tip_left" }]\n'
        '[[hinge_line]]\nname = "middle_line"',
        "hinge_line.extra.outboard: ",
    ),
    "hinges off the line": (
        "right = [0.0, -0.5, 0.0]",
        "right = [0.1, -0.5, 0.0]",
        "middle_right: its points",
    ),
    "overdamped joint": (
        "[base]",
        "[joint]\ndamping_ratio = 5\n[base]",
        "joint.damping_ratio: …1",
    ),
    "tolerance, high": (
        "until = 2.0",
        "until = 2.0\ntolerance = 1",
        "scene.tolerance: …0.1",
    ),
    "tolerance, low": (
        "until = 2.0",
        "until = 2.0\ntolerance = 1e-11",
        "scene.tolerance: …1e-10",
    ),
    "beyond the latch": (
        LATCH,
        LATCH + 'start_angle = "90.1 deg"\n',
        "hinge_line.root_line: …90.1 deg… 90 deg",
    ),
    "soft sides": (
        "outboard_stiffness = 2500",
        "inboard_stiffness = 9950, outboard_stiffness = 2500",
        "inboard_stiffness…outboard_stiffness…1997.99 N.m/rad…2000",
    ),
    "joint preset as a list": (
        'kind = "contact"',
        'kind = "contact"\npreset = ["revolute"]',
        "connection.stop.preset: ",
    ),
    "unknown component": (
        '"contact"',
        '"springy"',
        "connection.stop.kind: 'springy' is not a known component",
    ),
    "refused parameter": (
        '"1 mm"',
        '"-1 mm"',
        "connection.stop.parameters.reference_penetration: …1e-09 m",
    ),
    "buried contact": (
        'gap = "0 m"',
        'gap = "11 mm"',
        "connection.stop: …0.011 m…0.001 m",
    ),
    "unknown outboard body": (
        'outboard = "inner"',
        'outboard = "iner"',
        "root_line.outboard: ",
    ),
    "no TOML": ("[base]", "[base", "wing.toml: "),
    "a text without quotes": ('name = "two_panels"', "name = two panels", 'in quotes: name = "two panels"'),
}


# mistakes that leave other tables without what they name: those are told as well
FOLLOWED = {
    "missing table", "no hinges", "hinges as a table", "same body name",
    "unknown entry", "disconnected", "base outboard", "two inboard lines",
}  # fmt: skip


@pytest.mark.parametrize("kind", BAD)
def test_bad_input_is_a_sentence_that_names_file_and_key(tmp_path, kind):
    """One mistake is one problem, but where others follow from it."""
    old, new, sentence = BAD[kind]
    found = problems_of(tmp_path, edited(COMPLETE, (old, new), count=1))
    assert any(all(part in problem for part in sentence.split("…")) for problem in found), found
    assert all(problem.startswith("wing.toml: ") for problem in found)
    assert len(found) == 1 or {kind} <= FOLLOWED, found


def test_all_problems_are_reported_at_once(tmp_path):
    kinds = ("wrong unit", "wrong unit in a list", "rising motor", "bad axis", "unknown body", "not finite")
    text = COMPLETE
    for kind in kinds:
        text = edited(text, BAD[kind][:2], count=1)
    found = problems_of(tmp_path, text)
    for _, _, sentence in (BAD[kind] for kind in kinds):
        assert any(all(part in problem for part in sentence.split("…")) for problem in found), sentence
    assert len(found) == len(kinds)


def test_problems_of_different_tables_do_not_hide_each_other(tmp_path):
    """Also what needs other tables: references, components, where bodies stand."""
    kinds = (
        "not finite",
        "unknown hinge",
        "unknown component",
        "strand",
        "hinges off the line",
        "overdamped joint",
    )
    text = COMPLETE + edited(STOP, ('"stop"', '"rest"'), ('"1 mm"', '"-1 mm"'))
    for kind in kinds:
        text = edited(text, BAD[kind][:2], count=1)
    found = problems_of(tmp_path, text)
    for sentence in (
        *(BAD[kind][2] for kind in kinds),
        "connection.rest.parameters.reference_penetration: ",
    ):
        assert any(all(part in problem for part in sentence.split("…")) for problem in found), sentence
    assert len(found) == len(kinds) + 1


def test_places_and_hinges_of_tables_with_other_problems_are_still_checked(tmp_path):
    """A line with a bad axis still names its bodies, and its hinges still carry the damper."""
    changes = (
        ('axis = "-y"', 'axis = "down"'),
        ('hinge = "root"', 'hinge = "middle_left"'),
        ('outboard = "left"', 'outboard = "port"'),
        ('"5 N/mm"', '"5 N"'),
        ('point = "left"', 'point = "top"'),
    )
    found = problems_of(tmp_path, edited(COMPLETE, *changes))
    assert len(found) == 4
    for words in (
        "axis: is 'down'",
        "'port'",
        "strand_stiffness",
        "'top'",
    ):
        assert any(words in problem for problem in found), words


def test_a_misspelt_body_of_a_line_is_one_problem(tmp_path):
    """Two hinges, a damper and every body further out depend on it."""
    text = edited(COMPLETE, ('hinge = "root"', 'hinge = "middle_left"'))
    for old, new in (('outboard = "outer"', 'outboard = "outr"'), ('inboard = "inner"', 'inboard = "iner"')):
        assert len(problems_of(tmp_path, edited(text, (old, new), count=1))) == 1
    assert len(problems_of(tmp_path, edited(text, BAD["unknown outboard body"][:2], count=1))) == 1


def test_what_only_just_holds_is_accepted(tmp_path):
    """Bounds are inclusive; ten reference penetrations, sides rounded to a part in a thousand, a start at the latch."""
    changes = (
        ('gap = "0 m"', 'gap = "10 mm"'),
        ("outboard_stiffness = 2500", "inboard_stiffness = 9995, outboard_stiffness = 2500"),
        ("until = 2.0", "until = 2.0\ntolerance = 0.1"),
        (LATCH, LATCH + 'start_angle = "90 deg"\n'),
    )
    for old, new in changes:
        load_text(tmp_path, edited(COMPLETE, (old, new), count=1))
    beyond = edited(COMPLETE, (LATCH, LATCH + 'held = true\nstart_angle = "91 deg"\n'), count=1)
    assert load_text(tmp_path, beyond).hinge_lines[0].held


def test_a_sound_scene_has_no_problems(tmp_path):
    scene = load_text(tmp_path, COMPLETE)
    assert [body.name for body in scene.bodies] == ["inner", "outer"]


def test_named_scenes_are_found_and_unknown_ones_named():
    assert "amos3" in list_scenes()
    assert find_scene("amos3").is_file()
    assert find_scene(str(SCENES / "two_panels.toml")) == SCENES / "two_panels.toml"
    with pytest.raises(SceneError, match=r"'amos4'.*amos3"):
        find_scene("amos4")


@pytest.mark.parametrize(
    ("table", "mistyped"),
    [("[[hinge_line]]", "[[hingeline]]"), ("[[damper]]", "[[dampr]]"), ("[base]", "[bas]")],
)
def test_a_mistyped_table_is_a_single_problem(tmp_path, table, mistyped):
    """Regression: [[hingeline]] gave 27 problems, 26 of which followed from the first; others are still found."""
    text = COMPLETE.replace(table, mistyped)
    (problem,) = problems_of(tmp_path, text)
    name = table.strip("[]")
    assert f"{name}" in problem
    assert len(problems_of(tmp_path, text.replace("until = 2.0", "until = true"))) == 2


def test_points_of_an_open_hinge_are_named_with_their_coordinates(tmp_path):
    """Both points: which of them is wrong nobody knows."""
    problems = problems_of(
        tmp_path, edited(COMPLETE, ("tip_left = [1.6, 0.5, 0.0]", "tip_left = [1.55, 0.5, 0.0]"))
    )
    (problem,) = (
        one for one in problems if ("apart" in one and "middle_left" in one) or "middle_right" in one
    )
    assert "(1.6, -0.5, 0) m" in problem or "(1.55, 0.5, 0) m" in problem
    assert "(0, " in problem
