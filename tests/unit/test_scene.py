"""Scene files: sentences for bad input, start poses, latches by fidelity, line totals, units."""

from itertools import pairwise, product
from math import cos, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

from components import REGISTRY, rotation_matrix
from orchestrator.participant import InProcess
from orchestrator.scene import SceneError, assemble, find_scene, list_scenes, load_scene
from orchestrator.scene_connections import line_latch
from orchestrator.units import UNITS, to_si

SCENES = Path(__file__).parents[1] / "scenes"
TWO_PANELS = (SCENES / "two_panels.toml").read_text(encoding="utf-8")
BODIES = ("yoke", "panel1", "panel2")


def load_text(folder, text):
    path = folder / "wing.toml"
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def problems_of(folder, text):
    with pytest.raises(SceneError) as caught:
        load_text(folder, text)
    return caught.value.problems


def amos3():
    return load_scene(find_scene("amos3"))


def parts_of(assembly):
    return {part.name: part for part in assembly.parts}


DAMPER = '[[damper]]\nname = "damper"\nhinge = "root"\ndamping_coefficient = 2.0\n'
CCL = (
    '[[ccl]]\nname = "loop"\npreload = "40 N"\nstrand_stiffness = "5 N/mm"\n'
    'pulley_1 = { body = "base", point = "root", offset = [0.0, 0.6, 0.0], radius = "30 mm" }\n'
    'pulley_2 = { body = "outer", point = "left", offset = [0.0, 0.1, 0.0], radius = "30 mm" }\n'
)
LATCH = "latch = { stiffness = 2000, outboard_stiffness = 2500, effective_inertia = 5 }\n"
HINGES = 'hinges = [{ name = "root", inboard = "root", outboard = "root" }]'
STOP = (
    '[[connection]]\nname = "stop"\nkind = "contact"\nstructure = { normal = [1.0, 0.0, 0.0] }\n'
    'ports = { inboard = { body = "base", point = "root" }, outboard = { body = "inner", point = "tip_left" } }\n'
    'parameters = { gap = "0 m", reference_penetration = "1 mm" }\n'
)
COMPLETE = TWO_PANELS.replace(HINGES, LATCH + HINGES) + DAMPER + CCL + STOP

BAD = {
    "unknown key": ('name = "inner"', 'name = "inner"\ncolour = 1', "body.inner.colour: is not a known key"),
    "unknown table": ("[base]", "[bases]\n[base]", "bases: is not a known table"),
    "missing value": ('mass = "8 kg"\n', "", "body.inner.rigid.mass: is missing"),
    "missing table": ("[base]\npoints", "[joint]\npoints", "base: is missing"),
    "missing pulley": ("pulley_2 =", "# pulley_2 =", "ccl.loop.pulley_2: is missing"),
    "wrong type": ("until = 2.0", "until = true", "scene.until: is True; it must be a number of s"),
    "no number": ("until = 2.0", 'until = "soon"', "scene.until: is 'soon'; give a number"),
    "not finite": ("until = 2.0", "until = inf", "scene.until: is inf; it must be finite"),
    "no vector": ("[0.8, 0.0, 0.0]", "[0.8, 0.0]", "body.inner.rigid.center_of_mass: is [0.8, 0.0]"),
    "wrong unit": ('"8 kg"', '"8 m"', "body.inner.rigid.mass: is '8 m'; give"),
    "wrong unit in a list": ('"770 mm"', '"770 N"', "body.outer.rigid.center_of_mass: is '770 N'"),
    "one table": ("[[damper]]", "[damper]", "damper: is one table; write it as [[damper]]"),
    "bad name": ('name = "two_panels"', 'name = "two panels"', "scene.name: is 'two panels'; a name"),
    "bad axis": ('axis = "+y"', 'axis = "up"', "hinge_line.root_line.axis: is 'up'; it must be one of +x"),
    "negative mass": ('"8 kg"', '"-8 kg"', "body.inner.rigid.mass: is '-8 kg'; it must be positive"),
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
    "stiffness": ("stiffness = 2000", "stiffness = 0", "latch.stiffness: is 0; it must be positive"),
    "soft side": ("stiffness = 2500", "stiffness = 9", "latch: outboard_stiffness 9 N.m/rad is less than"),
    "strand": ('"5 N/mm"', '"-5 N/mm"', "ccl.loop.strand_stiffness: is '-5 N/mm'; it must be positive"),
    "rising motor": ('"1.6 N.m"', '"0.6 N.m"', "hinge_line.root_line.motor: the torque of a spring falls"),
    "hinge kind": (
        'kind = "cylindrical"',
        'kind = "ball"',
        "hinge_line.middle_line.hinges.middle_right.kind: is 'ball'; it must be 'revolute'",
    ),
    "incomplete bushing": ('"cylindrical"', '"bushing"', "a bushing needs translational_stiffness"),
    "harness on no hinge": (
        LATCH,
        LATCH + "harness = { angle = [0, 1], resisting_torque = [1, 0] }\n",
        "hinge_line.root_line: give a table harness and mark the hinges",
    ),
    "no hinges": (HINGES, "hinges = []", "hinge_line.root_line: a line needs at least one hinge"),
    "angles": ('"180 deg"', '"-1 deg"', "latch_angle, by default aligned_angle"),
    "same name": ('name = "loop"', 'name = "root"', "root_line.hinges.root: two components are named"),
    "same body name": ('name = "outer"', 'name = "inner"', "body.inner: two components are named 'inner'"),
    "unknown body": ('body = "outer"', 'body = "tail"', "ccl.loop.pulley_2: there is no body 'tail'"),
    "unknown point": ('point = "left"', 'point = "top"', "ccl.loop.pulley_2: outer has no point 'top'"),
    "unknown hinge": ('hinge = "root"', 'hinge = "axle"', "damper.damper.hinge: there is no hinge 'axle'"),
    "unknown fidelity": ('name = "inner"', 'name = "inner"\nfidelity = "soft"', "fidelity: is 'soft'"),
    "unknown entry": (
        "[[damper]]",
        '[[body]]\nname = "x"\ncatalogue = "x"\n[[damper]]',
        "no catalogue entry 'x'",
    ),
    "inline flexible": ('name = "inner"', 'name = "inner"\nfidelity = "flexible"', "only a body of the"),
    "no source": ("[[damper]]", '[[body]]\nname = "x"\n[[damper]]', "body.x: give either a catalogue entry"),
    "same point twice": (
        'inboard = "tip_right"',
        'inboard = "tip_left"',
        "hinges.middle_right.inboard: point tip_left of inner already carries hinge middle_left",
    ),
    "same body twice": ('body = "outer", point = "left"', 'body = "base", point = "root"', "to base twice"),
    "disconnected": (
        'inboard = "inner"\noutboard',
        'inboard = "outer"\noutboard',
        "outer: it is disconnected",
    ),
    "base outboard": ('outboard = "inner"', 'outboard = "base"', "base is the base"),
    "two inboard lines": (
        '[[hinge_line]]\nname = "middle_line"',
        '[[hinge_line]]\nname = "extra"\ninboard = "base"\noutboard = "inner"\naxis = "+y"\n'
        "aligned_angle = 1\n"
        'hinges = [{ name = "extra_hinge", inboard = "root", outboard = "tip_left" }]\n'
        '[[hinge_line]]\nname = "middle_line"',
        "hinge_line.extra.outboard: inner is that of another line already",
    ),
    "hinges off the line": (
        "right = [0.0, -0.5, 0.0]",
        "right = [0.1, -0.5, 0.0]",
        "middle_right: its points",
    ),
    "overdamped joint": (
        "[base]",
        "[joint]\ndamping_ratio = 5\n[base]",
        "joint.damping_ratio: is 5; it must be at most 1",
    ),
    "tolerance, high": (
        "until = 2.0",
        "until = 2.0\ntolerance = 1",
        "scene.tolerance: is 1; it must be at most 0.1",
    ),
    "tolerance, low": (
        "until = 2.0",
        "until = 2.0\ntolerance = 1e-11",
        "tolerance: is 1e-11; it must be at least 1e-10",
    ),
    "beyond the latch": (
        LATCH,
        LATCH + 'start_angle = "90.1 deg"\n',
        "hinge_line.root_line: start_angle 90.1 deg is beyond the latch angle 90 deg",
    ),
    "soft sides": (
        "outboard_stiffness = 2500",
        "inboard_stiffness = 9950, outboard_stiffness = 2500",
        "inboard_stiffness and outboard_stiffness in series are 1997.99 N.m/rad, less than the line's 2000",
    ),
    "unknown component": ('"contact"', '"springy"', "connection.stop.kind: there is no component 'springy'"),
    "refused parameter": (
        '"1 mm"',
        '"-1 mm"',
        "connection.stop.parameters.reference_penetration: is '-1 mm'; it must be at least 1e-09 m",
    ),
    "buried contact": (
        'gap = "0 m"',
        'gap = "11 mm"',
        "connection.stop: the contact starts 0.011 m deep, and its reference_penetration is 0.001 m; gap is",
    ),
    "unknown outboard body": (
        'outboard = "inner"',
        'outboard = "iner"',
        "root_line.outboard: there is no body 'iner'",
    ),
    "no TOML": ("[base]", "[base", "wing.toml: "),
}


@pytest.mark.parametrize(("old", "new", "sentence"), BAD.values(), ids=BAD)
def test_bad_input_is_a_sentence_that_names_file_and_key(tmp_path, old, new, sentence):
    assert old in COMPLETE
    found = problems_of(tmp_path, COMPLETE.replace(old, new, 1))
    assert any(sentence in problem for problem in found), found
    assert all(problem.startswith("wing.toml: ") for problem in found)


def test_all_problems_are_reported_at_once(tmp_path):
    kinds = ("wrong unit", "wrong unit in a list", "rising motor", "bad axis", "unknown body", "not finite")
    text = COMPLETE
    for kind in kinds:
        text = text.replace(*BAD[kind][:2], 1)
    found = problems_of(tmp_path, text)
    for kind in kinds:
        assert any(BAD[kind][2] in problem for problem in found), kind
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
    text = COMPLETE + STOP.replace('"stop"', '"rest"').replace('"1 mm"', '"-1 mm"')
    for kind in kinds:
        text = text.replace(*BAD[kind][:2], 1)
    found = problems_of(tmp_path, text)
    for sentence in (
        *(BAD[kind][2] for kind in kinds),
        "connection.rest.parameters.reference_penetration: is '-1 mm'",
    ):
        assert any(sentence in problem for problem in found), sentence
    assert len(found) == len(kinds) + 1


def test_places_and_hinges_of_tables_with_other_problems_are_still_checked(tmp_path):
    """A line with a bad axis still names its bodies, and its hinges still carry the damper."""
    text = COMPLETE.replace('axis = "-y"', 'axis = "down"').replace('hinge = "root"', 'hinge = "middle_left"')
    text = text.replace('outboard = "left"', 'outboard = "port"').replace('"5 N/mm"', '"5 N"')
    found = problems_of(tmp_path, text.replace('point = "left"', 'point = "top"'))
    assert len(found) == 4
    for words in (
        "axis: is 'down'",
        "outer has no point 'port'",
        "strand_stiffness",
        "outer has no point 'top'",
    ):
        assert any(words in problem for problem in found), words


def test_a_misspelt_body_of_a_line_is_one_problem(tmp_path):
    """Two hinges, a damper and every body further out depend on it."""
    text = COMPLETE.replace('hinge = "root"', 'hinge = "middle_left"')
    for old, new in (('outboard = "outer"', 'outboard = "outr"'), ('inboard = "inner"', 'inboard = "iner"')):
        assert len(problems_of(tmp_path, text.replace(old, new, 1))) == 1
    assert len(problems_of(tmp_path, text.replace(*BAD["unknown outboard body"][:2], 1))) == 1


def test_what_only_just_holds_is_accepted(tmp_path):
    """Bounds are inclusive; ten reference penetrations, sides rounded to a part in a thousand, a start at the latch."""
    changes = (
        ('gap = "0 m"', 'gap = "10 mm"'),
        ("outboard_stiffness = 2500", "inboard_stiffness = 9995, outboard_stiffness = 2500"),
        ("until = 2.0", "until = 2.0\ntolerance = 0.1"),
        (LATCH, LATCH + 'start_angle = "90 deg"\n'),
    )
    for old, new in changes:
        assert old in COMPLETE
        load_text(tmp_path, COMPLETE.replace(old, new, 1))
    beyond = COMPLETE.replace(LATCH, LATCH + 'held = true\nstart_angle = "91 deg"\n', 1)
    assert load_text(tmp_path, beyond).hinge_lines[0].held


def test_a_sound_scene_has_no_problems(tmp_path):
    scene = load_text(tmp_path, COMPLETE)
    assert [body.name for body in scene.bodies] == ["inner", "outer"]


def test_named_scenes_are_found_and_unknown_ones_named():
    assert "amos3" in list_scenes()
    assert find_scene("amos3").is_file()
    assert find_scene(str(SCENES / "two_panels.toml")) == SCENES / "two_panels.toml"
    with pytest.raises(SceneError, match=r"no scene and no file 'amos4'; scenes are .*amos3"):
        find_scene("amos4")


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (2, "m", 2.0),
        ("30 mm", "m", 0.03),
        ("90 deg", "rad", pi / 2),
        ("-90 deg", "rad", -pi / 2),
        ("10 N.m/deg", "N.m/rad", 1800 / pi),
        ("28.76 N.m.s/rad", "N.m.s/rad", 28.76),
        ("2e6 N/m", "N/m", 2e6),
        ("5 %", "1", 0.05),
        ("0.1", "1", 0.1),
    ],
)
def test_quantities_are_converted_to_si(value, unit, expected):
    assert to_si(value, unit) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("unit", UNITS)
def test_every_unit_accepts_itself_and_refuses_others(unit):
    assert to_si(f"3 {unit}", unit) == 3.0
    with pytest.raises(ValueError, match="give a number, a space and the unit"):
        to_si("3 furlong", unit)


def test_units_are_those_of_the_components():
    used = {
        q.unit
        for kind in ("hinge", "ccl", "eddy_current_damper")
        for q in REGISTRY[kind].example().parameter_layout.quantities
    }
    assert used - set(UNITS) == set()


def planar_angles(phi):
    """Absolute angles of the data sheet: a1 = phi1, a2 = a1 + pi - phi2, a3 = a2 - pi + phi3."""
    yoke = phi[0]
    panel1 = yoke + pi - phi[1]
    return yoke, panel1, panel1 - pi + phi[2]


@pytest.mark.parametrize("degrees", [(0, 0, 0), (30, 100, 130), (90, 180, 180)], ids=str)
def test_start_poses_are_those_of_the_planar_angles(tmp_path, degrees):
    text = find_scene("amos3").read_text(encoding="utf-8")
    for name, angle in zip(("HL1", "HL2", "HL3"), degrees, strict=True):
        angles = f'name = "{name}"\nstowed_angle = "{angle} deg"\nlatch_angle = "181 deg"'
        text = text.replace(f'[[hinge_line]]\nname = "{name}"', f"[[hinge_line]]\n{angles}")
    parts = parts_of(assemble(load_text(tmp_path, text), rigid={"all"}))
    root = np.zeros(3)
    for body, a, length in zip(
        BODIES, planar_angles([radians(d) for d in degrees]), (0.95, 1.61, 0), strict=True
    ):
        along = np.array([sin(a), 0.0, cos(a)])  # along +z at a = 0, along +x at a = 90 degrees
        turn = rotation_matrix(parts[body].start["initial_orientation"])
        np.testing.assert_allclose(turn @ [1.0, 0.0, 0.0], along, atol=1e-12)
        np.testing.assert_allclose(turn @ [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(parts[body].start["initial_position"], root, atol=1e-12)
        root = root + length * along


def test_hinges_read_their_stowed_angle_and_meet_at_the_start():
    scene = amos3()
    assembly = assemble(scene, rigid={"all"})
    parts = parts_of(assembly)
    running = {}
    for part in assembly.parts:
        if part.kind in ("fixed_base", "body"):
            running[part.name] = InProcess(part.name, REGISTRY[part.kind](**part.structure), part.start)
            running[part.name].initialize(0.0)
            running[part.name].read()
    for name in (hinge for line in assembly.hinge_lines for hinge in line.hinges):
        hinge = InProcess(name, REGISTRY["hinge"](**parts[name].structure), parts[name].start)
        for link in assembly.links:
            if link.connection[0] == name:
                body = running[link.body[0]]
                for quantity in ("position", "orientation"):
                    from_body = body.output_layout[f"{link.body[1]}.{quantity}"]
                    hinge.inputs[hinge.input_layout[f"{link.connection[1]}.{quantity}"]] = body.outputs[
                        from_body
                    ]
        hinge.initialize(0.0)
        seen = dict(zip(hinge.observation_layout.scalar_names(), hinge.observe(), strict=True))
        assert seen["angle"] == pytest.approx(0.0, abs=1e-12)
        assert seen["radial_force"] < 1e-6
        assert seen["axial_force"] == pytest.approx(0.0, abs=1e-6)


def series(line, side):
    """What is missing to the line stiffness where only one side is modelled."""
    return 1.0 / (1.0 / line - 1.0 / side)


EXPECTED_LATCHES = {
    "HL1": {(True, False): 2500.0, (True, True): None},
    "HL2": {
        (False, False): 1800.0,
        (True, False): series(1800.0, 3180.5),
        (False, True): series(1800.0, 4147.8),
        (True, True): None,
    },
    "HL3": {
        (False, False): 2074.0,
        (True, False): series(2074.0, 4147.8),
        (False, True): series(2074.0, 4147.8),
        (True, True): None,
    },
}


@pytest.mark.parametrize("flexible", list(product((False, True), repeat=3)), ids=str)
def test_latch_of_every_line_at_every_fidelity(flexible):
    scene = amos3()
    sides = [True, *flexible]  # the fixed base counts as flexible
    for line, pair in zip(scene.hinge_lines, pairwise(sides), strict=True):
        expected = EXPECTED_LATCHES[line.name][pair]
        latch = line_latch(scene, line, dict(zip(BODIES, flexible, strict=True)), "mean")
        assert latch.kind == ("kinematic" if expected is None else "spring")
        assert latch.stiffness == pytest.approx(expected or 0.0)
        endpoint = line_latch(scene, line, dict(zip(BODIES, flexible, strict=True)), "endpoint")
        assert endpoint.kind == "spring"
        assert endpoint.stiffness == pytest.approx(expected or line.latch.stiffness)
        assert endpoint.damping == pytest.approx(
            2 * 0.02 * sqrt(endpoint.stiffness * line.latch.effective_inertia)
        )


def test_latch_of_a_free_base_follows_the_same_rule(tmp_path):
    free = '[base.free]\nmass = "1500 kg"\ninertia = [1500.0, 1500.0, 1500.0]\n[joint]'
    text = find_scene("amos3").read_text(encoding="utf-8").replace("[joint]", free)
    scene = load_text(tmp_path, text)
    assert line_latch(scene, scene.hinge_lines[0], dict.fromkeys(BODIES, True), "mean").kind == "kinematic"


def test_hinges_share_the_totals_of_their_line():
    scene = amos3()
    parts = parts_of(assemble(scene, rigid={"all"}))
    left, right = parts["hl2_left"], parts["hl2_right"]
    wind_up = pi * 1.591 / (1.591 - 0.937)
    for hinge in (left, right):
        stiffness = hinge.start["motor_stiffness"]
        assert 2 * stiffness * hinge.start["motor_wind_up"] == pytest.approx(1.591)
        assert 2 * stiffness * (hinge.start["motor_wind_up"] - pi) == pytest.approx(0.937)
        assert hinge.start["motor_wind_up"] == pytest.approx(wind_up)
        assert 2 * hinge.start["friction_preload"] == pytest.approx(0.05)
        assert 2 * hinge.start["latch_stiffness"] == pytest.approx(1800.0)
        assert hinge.start["friction_coefficient"] == 0.10  # acts on each hinge's own reaction
    assert left.structure["harness_torque"] == (-0.15, 0.08)  # resists when stowed, on the +y side only
    assert "harness_torque" not in right.structure


def test_kinds_of_hinge_are_settings_of_the_six_stiffnesses():
    parts = parts_of(assemble(amos3(), rigid={"all"}))
    revolute, cylindrical = parts["hl2_left"].start, parts["hl2_right"].start
    assert revolute["translational_stiffness"] == (2e6, 5e6, 5e6)
    assert cylindrical["translational_stiffness"] == (0.0, 5e6, 5e6)
    assert revolute["rotational_stiffness"] == (0.0, 2e4, 2e4)
    assert revolute["rotational_damping"][1] == pytest.approx(2 * 0.05 * 2e4 / (2 * pi * 184))


def test_stiffnesses_of_a_hinge_can_be_overridden(tmp_path):
    override = 'kind = "spherical", translational_stiffness = ["1 N/mm", 2, 3]'
    parts = parts_of(assemble(load_text(tmp_path, COMPLETE.replace('kind = "cylindrical"', override))))
    assert parts["middle_right"].start["translational_stiffness"] == (1000.0, 2.0, 3.0)
    assert parts["middle_right"].start["rotational_stiffness"] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
def test_stiction_velocity_is_raised_beside_a_flexible_body(mode):
    parts = parts_of(assemble(amos3(), rigid={"yoke", "panel1"}, wrench_mode=mode))
    assert parts["hl2_left"].start["stiction_velocity"] == 0.0167
    assert parts["hl3_left"].start["stiction_velocity"] == pytest.approx(0.167)
    assert parts["hl3_left"].start["latch_automatic"] == (mode == "endpoint")


@pytest.mark.parametrize(
    ("rigid", "flexible", "sentence"),
    [
        ({"wing"}, set(), "there is no body 'wing'; bodies are inner, outer"),
        ({"inner"}, {"inner"}, "body.inner: it cannot be both rigid and flexible"),
        (set(), {"inner"}, "only a body of the catalogue can be flexible"),
    ],
)
def test_impossible_fidelities_are_sentences(tmp_path, rigid, flexible, sentence):
    with pytest.raises(SceneError, match=sentence):
        assemble(load_text(tmp_path, TWO_PANELS), rigid, flexible)


def test_fidelity_flags_override_the_scene():
    scene = amos3()
    text = assemble(scene, rigid={"yoke", "panel1"})
    modes = {p.name: len(p.structure["modal"]["frequency"]) for p in text.parts if p.kind == "body"}
    assert modes == {"yoke": 0, "panel1": 0, "panel2": 16}
    assert text.geometry["panel2"].shapes.shape[2] == 16


def test_modes_can_be_switched_off(tmp_path):
    text = find_scene("amos3").read_text(encoding="utf-8")
    text = text.replace('"amos3_panel2",', '"amos3_panel2", modes_off = [0], damping_ratio = "2 %",')
    parts = parts_of(assemble(load_text(tmp_path, text), rigid={"yoke", "panel1"}))
    modal = parts["panel2"].structure["modal"]
    assert len(modal["frequency"]) == 15
    assert set(modal["damping_ratio"]) == {0.02}


@pytest.mark.parametrize("mode", ["mean", "endpoint"])
@pytest.mark.parametrize("source", ["amos3", "two_panels", "two_panels_free"])
def test_every_part_is_a_component_with_possible_parameters_and_every_port_is_linked_once(source, mode):
    path = find_scene(source) if source == "amos3" else SCENES / f"{source}.toml"
    assembly = assemble(load_scene(path), rigid={"all"}, wrench_mode=mode)
    linked = [end for link in assembly.links for end in (link.body, link.connection)]
    ports = []
    for part in assembly.parts:
        component = REGISTRY[part.kind](**part.structure)
        InProcess(part.name, component, part.start)
        ports += [(part.name, port.name) for port in component.ports]
    assert sorted(linked) == sorted(ports)


def test_a_free_base_is_a_rigid_body_of_the_same_name():
    assembly = assemble(load_scene(SCENES / "two_panels_free.toml"))
    base = parts_of(assembly)[assembly.base]
    assert base.kind == "body"
    assert base.structure["modal"]["mass"] == 1500.0
