"""Static equilibrium: closed forms, the start of runs with preload, and work along quasi-static sweeps."""

import json
from math import atan2, pi, radians
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from orchestrator.analysis.equilibrium import Sweep, equilibrium, quasi_static
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.configuration import Configuration, configuration, lines_named
from orchestrator.assembly.statics.start import static_start
from orchestrator.cli.main import main
from orchestrator.cosim.master import Master
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from orchestrator.cosim.settings import Settings
from orchestrator.results.recorder import NoRecorder
from orchestrator.scene import SceneError, find_scene, load_scene
from tests.references.edits import edited

TWO_PANELS = (Path(__file__).parents[2] / "scenes" / "two_panels.toml").read_text(encoding="utf-8")
HARNESS = 'harness = { angle = ["0 deg", "60 deg", "90 deg"], resisting_torque = ["0.4 N.m", "0.1 N.m", "-0.1 N.m"] }\n'
ROOT_HINGE = 'hinges = [{ name = "root", inboard = "root", outboard = "root" }]'


def wing(folder, gravity=(0.0, 0.0, 0.0), extra=""):
    """The two panels with a harness on the root line."""
    carried = edited(ROOT_HINGE, ('"root" }]', '"root", harness = true }]'))
    pulled = ("until = 2.0", f"until = 2.0\ngravity = {list(gravity)}")
    text = edited(TWO_PANELS, pulled, (ROOT_HINGE, HARNESS + carried))
    path = folder / "wing.toml"
    path.write_text(text + extra, encoding="utf-8")
    return load_scene(path)


@pytest.mark.parametrize("rigid", [("all",), ()])
def test_preload_of_amos3_is_the_masters_own(rigid):
    """Rule: loads of an instant without friction, here, are the mean ones that a master starts from.

    About the lines, along y, the equilibrium counts what holds them, and the master has let go.
    """
    scene = load_scene(find_scene("amos3"))
    assembly = static_start(assemble(scene, rigid, ())).assembly
    network = Network(in_process(assembly.parts), assembly.links)
    Master(network, assembly.hinge_lines, NoRecorder(), Settings()).initialize(preload=True)
    mechanism, found = equilibrium(
        scene, rigid, (), configuration(scene), lines_named(scene, "all"), adjusted=True
    )
    for name, body in mechanism.bodies.items():
        if body.body is None:
            continue
        observed, at = network.by_name[name].observe(), network.by_name[name].observation_layout
        frame = body.position - body.axes @ body.body.data.center_of_mass
        np.testing.assert_allclose(frame, observed[at["frame_position"]], atol=1e-11)
        np.testing.assert_allclose(body.orientation, observed[at["frame_orientation"]], atol=1e-11)
        if body.modes:
            np.testing.assert_allclose(body.eta, observed[at["modal_coordinate"]], atol=1e-11)
    for name, loads in found.loads.items():
        participant = network.by_name[name]
        names = participant.observation_layout.scalar_names()
        observed = dict(zip(names, participant.observe(), strict=True))
        for key, (value, _) in loads.items():
            if key != "hinge_torque[2]":
                assert value == pytest.approx(observed[key], abs=1e-5)


def test_loops_press_80_newton_through_the_lines():
    """Data sheet (c): two strands of 40 N each compress their link body by 80 N; lines carry the sum of loops on them.

    HL1 and HL3 feel one loop, HL2 two: at rest 80, 160 and 80 N, against the net forces of the loops.
    """
    scene = load_scene(find_scene("amos3"))
    _, found = equilibrium(
        scene, ("all",), (), configuration(scene), lines_named(scene, "all"), adjusted=True
    )
    for loop in ("yoke_loop", "panel_loop"):
        loads = {name: value for name, (value, _) in found.loads[loop].items()}
        assert loads["tension_a"] == loads["tension_b"] == 40.0
        assert loads["axial_force"] == pytest.approx(80.0, rel=1e-12)
    radial = {
        name: loads["radial_force"][0] for name, loads in found.loads.items() if "radial_force" in loads
    }
    # motors bend the two hinges of a line to opposite sides by 2 N, which the loop's 80 N along them hides
    assert radial["hl1_hinge"] == pytest.approx(80.0, rel=1e-4)
    assert radial["hl2_left"] + radial["hl2_right"] == pytest.approx(160.0, rel=0.06)
    np.testing.assert_allclose(found.base_load, 0.0, atol=1e-7)  # internal loads leave nothing at the base


def test_deflection_of_a_latch_is_torque_over_stiffness(tmp_path):
    """Closed form: the latched line turns on by (motor + harness) / (K + rates), about its deployed angle."""
    latch = 'latch = { kind = "spring", stiffness = 2000, effective_inertia = 5 }\n'
    text = edited(TWO_PANELS, ('motor = { stowed = "1.6 N.m"', latch + 'motor = { stowed = "1.6 N.m"'))
    path = tmp_path / "wing.toml"
    path.write_text(text, encoding="utf-8")
    scene = load_scene(path)
    target = configuration(scene, "deployed", latched="root_line")
    _, found = equilibrium(scene, (), (), target, ("middle_line",))
    rate = 0.6 / (0.5 * pi)
    assert found.angles["root_line"] - 0.5 * pi == pytest.approx(1.0 / (2000.0 + rate), rel=1e-6)
    assert found.holding_torques["middle_line"] == pytest.approx(-1.2, rel=1e-6)
    assert found.base_load[4] == pytest.approx(0.0, abs=1e-6)


CLAMPED = """
scene = {{ name = "beam", until = "1 s", gravity = [0, 0, -9.81] }}
base = {{ name = "wall", points = {{ p = [0, 0, 0] }} }}
joint = {{ axial_stiffness = {0}, radial_stiffness = {0}, cross_stiffness = {1} }}
[[body]]
name = "boom"
place = {{ body = "wall", point = "p" }}
[body.beam]
length = "2.5 m"
tube = {{ diameter = "20 mm", wall = "0.5 mm", youngs_modulus = "70 GPa", poisson_ratio = 0.3, density = 2700 }}
attachment_points = {{ root = 0, tip = "2.5 m" }}
[[connection]]
name = "clamp"
preset = "fixed"
axes = {{ x = [1, 0, 0], z = [0, 0, 1] }}
ports = {{ inboard = {{ body = "wall", point = "p" }}, outboard = {{ body = "boom", point = "root" }} }}
"""


@pytest.mark.parametrize(("translation", "rotation"), [(1e7, 1e5), (1e10, 1e9), (1e12, 1e11)])
def test_a_clamp_carries_the_weight_however_stiff(translation, rotation, tmp_path):
    """Closed form: m g, its lever, and nothing along the beam; 1e-12 of what a clamp does in a metre is rounding.

    A stiff clamp hardly moves, so its motion told the search that a beam half bent was at rest.
    """
    path = tmp_path / "beam.toml"
    path.write_text(CLAMPED.format(translation, rotation), encoding="utf-8")
    mechanism, found = equilibrium(load_scene(path), (), (), Configuration({}, ()), ())
    data = mechanism.bodies["boom"].body.data
    tip = mechanism.bodies["boom"].position[0]
    rounding = 1e-16 * translation
    assert found.base_load[2] == pytest.approx(-9.81 * data.mass, rel=1e-8, abs=rounding)
    assert found.base_load[4] == pytest.approx(9.81 * data.mass * tip, rel=1e-4, abs=rounding)
    assert found.base_load[:2] == pytest.approx([0.0, 0.0], abs=1e-7 + rounding)


def test_hanging_pair_stands_against_its_motor(tmp_path):
    """Closed form: m g a cos = motor torque where the root line is free; the middle line is held.

    With both bodies one, r the centre of mass from the root and g along -z: m g x_c = T(phi), x_c from the root.
    """
    scene = wing(tmp_path, gravity=(0.0, 0.0, -9.80665))
    angle = 0.5 * pi + 0.5 * pi  # along -z from the root, where gravity holds it
    start = Configuration({"root_line": angle, "middle_line": 2.0}, ())
    mechanism, found = equilibrium(scene, (), (), start, ("middle_line",))
    bodies = [mechanism.bodies[name] for name in ("inner", "outer")]
    center = sum(b.body.data.mass * b.position for b in bodies) / 15.5
    phi = found.angles["root_line"]
    motor = 1.6 - 0.6 / (0.5 * pi) * phi
    harness = found.loads["root"]["harness_torque"][0]
    # positive opening turns about +y, which the weight does by -x_c * -m g
    assert motor + harness + 15.5 * 9.80665 * center[0] == pytest.approx(0.0, abs=1e-5)
    assert found.base_load[2] == pytest.approx(-15.5 * 9.80665, rel=1e-9)
    assert abs(atan2(center[0], -center[2])) < 0.1


def test_swept_line_is_held_against_motor_and_harness(tmp_path):
    """Closed form: the torque to hold is minus the sum of the line's own torques, at every angle of the sweep."""
    scene = wing(tmp_path)
    sweep = (Sweep("root_line", 0.0, 0.5 * pi), Sweep("middle_line", 0.0, pi))
    found = quasi_static(scene, (), (), configuration(scene), (), sweep, 6)
    assert [round(np.rad2deg(one.angles["middle_line"])) for one in found] == [0, 30, 60, 90, 120, 150, 180]
    for one in found:
        phi = one.angles["root_line"]
        harness = one.loads["root"]["harness_torque"][0]
        motor = 1.6 - 0.6 / (0.5 * pi) * phi
        # the middle line's motor acts within the wing and leaves nothing at the root; round-off of 1e7 N.m/rad
        assert one.holding_torques["root_line"] == pytest.approx(-(motor + harness), abs=1e-6)
        own = 2.0 - 0.8 / pi * one.angles["middle_line"]
        assert one.holding_torques["middle_line"] == pytest.approx(-own, abs=1e-6)


def test_work_of_a_sweep_is_the_change_of_energy():
    """Conservation: along equilibria the holding torque is the derivative of the stored energy, cables included.

    Simpson's rule over 2 steps of 0.3 rad of a torque that is all but linear misses 2e-8, and 2^4
    times that over 2 steps of twice the size.
    """
    scene = load_scene(find_scene("amos3"))
    names = [line.name for line in scene.hinge_lines]
    target = Configuration(dict.fromkeys(names, 0.0), ())
    found = quasi_static(scene, ("all",), (), target, (), [Sweep("HL1", 0.0, 0.6)], 2)
    torque = np.array([one.holding_torques["HL1"] for one in found])
    weights = np.array([1, 4, 1]) * (found[-1].angles["HL1"] - found[0].angles["HL1"]) / 6
    change = energy_of(found[-1], scene) - energy_of(found[0], scene)
    assert abs(change) > 4.0
    assert weights @ torque == pytest.approx(change, rel=1e-7)


def energy_of(found, scene):
    """Stored energy (J) of motors, harnesses, strands and joints, from angles, tensions and loads by themselves."""
    total = 0.0
    for line in scene.hinge_lines:
        phi = found.angles[line.name]
        if line.motor is not None:
            way = line.deployed_angle - line.stowed_angle
            stowed, deployed = line.motor.stowed, line.motor.deployed
            total -= stowed * phi - 0.5 * (stowed - deployed) / way * phi**2
        if line.harness is not None:  # linear over its whole table
            (a0, a1), (r0, r1) = line.harness.angle[:2], line.harness.resisting_torque[:2]
            total += r0 * (phi - a0) + 0.5 * (r1 - r0) / (a1 - a0) * (phi - a0) ** 2
        for hinge in line.hinges:
            joint = {name: value for name, (value, _) in found.loads[hinge.name].items()}
            total += 0.5 * joint["bending_moment"] ** 2 / scene.joint.cross_stiffness
            total += 0.5 * joint["radial_force"] ** 2 / scene.joint.radial_stiffness
            total += 0.5 * joint["axial_force"] ** 2 / scene.joint.axial_stiffness
    for loop in scene.loops:
        for strand in ("tension_a", "tension_b"):
            total += 0.5 * found.loads[loop.name][strand][0] ** 2 / loop.strand_stiffness
    return total


def test_what_has_no_equilibrium_is_refused(tmp_path):
    """A mechanism without springs has no unique equilibrium; one that its motors drive away none near."""
    text = TWO_PANELS
    for line in ("1.6 N.m", "2.0 N.m"):
        start = text.index(f'motor = {{ stowed = "{line}"')
        text = text[:start] + text[text.index("\n", start) + 1 :]
    path = tmp_path / "loose.toml"
    path.write_text(text, encoding="utf-8")
    loose = load_scene(path)
    with pytest.raises(SceneError, match=r"2 motions .*hold: root_line,middle_line"):
        equilibrium(loose, (), (), configuration(loose), ())
    scene = wing(tmp_path)
    with pytest.raises(SceneError, match="hold: middle_line,root_line"):
        equilibrium(scene, (), (), configuration(scene), ("middle_line",))


def test_command(tmp_path):
    """Interface: JSON of one equilibrium and of a sweep, and sentences; tables are below."""
    arguments = ["analyse", "equilibrium", "amos3", "--rigid", "all"]
    result = CliRunner().invoke(main, [*arguments, "--preload", "--json"])
    assert result.exit_code == 0, result.output
    (one,) = json.loads(result.stdout)["equilibria"]
    assert one["loads"]["yoke_loop"]["axial_force_n"] == pytest.approx(80.0)
    assert set(one["holding_torques_nm"]) == {"HL1", "HL2", "HL3"}
    sweep = ["workbench", "--rigid", "all", "--sweep", "HL=0deg:1.570796rad", "--steps", "3"]
    result = CliRunner().invoke(main, ["analyse", "equilibrium", *sweep, "--json"])
    assert [round(one["angles_rad"]["HL"], 6) for one in json.loads(result.stdout)["equilibria"]] == [
        0.0,
        0.523599,
        1.047197,
        1.570796,
    ]
    for extra, words in (
        (["--sweep", "HL1=0deg"], "HL1=0deg:90deg"),
        (["--sweep", "HL1=1deg:1deg"], "two angles"),
        (["--sweep", "HL1=0deg:1deg,HL1=0deg:2deg"], "HL1 "),
        (["--sweep", "HL1=0deg:90"], "'90'"),
        (["--sweep", "HL1=0deg:90deg", "--preload"], "--preload"),
        (["--steps", "3"], "--steps"),
        (["--hold", ""], "--hold"),
        (["--hold", "HL5"], "'HL5'"),
        (["--latched", "HL1", "--hold", "HL1"], "held"),
        (["--hold", "none"], "near"),
    ):
        refused = CliRunner().invoke(main, [*arguments, *extra])
        assert refused.exit_code in (1, 2)
        assert isinstance(refused.exception, SystemExit)
        assert words in refused.stderr


def test_a_sweep_goes_through_slack_cables_with_its_drive():
    """Conservation along phase 2 of ARABSAT, whose free lines follow the swept one by loops with a slack strand.

    The drive goes with the line that it turns, and shares its torque with what holds the line by their stiffnesses,
    2e4 and 1e7 N.m/rad. The work of both is the change of the stored energy. By the trapezoidal rule: over 30 deg
    the torque of 1.4 N.m bends by 4e-4 N.m, over 3 deg by 1/100 of that, of which the rule misses a twelfth: 2e-7.
    Less than 3 deg the search does in one step, not in halves.
    """
    scene = load_scene(find_scene("arabsat"), ("phase2",))
    way = radians(3.0)
    found = quasi_static(scene, ("all",), (), configuration(scene), (), [Sweep("HL1", 0.0, way)], 1)
    held, driven = (
        [one.holding_torques["HL1"] for one in found],
        [one.loads["sadm"]["drive_torque"][0] for one in found],
    )
    assert driven == pytest.approx([torque * 2e4 / 1e7 for torque in held], rel=1e-6)
    assert found[1].loads["yoke_loop"]["tension_a"][0] == 0.0
    change = energy_of(found[1], scene) - energy_of(found[0], scene)
    assert change < -0.06
    assert 0.5 * way * sum(held + driven) == pytest.approx(change, rel=5e-7)


def told(arguments):
    """The tables of a command in a narrow terminal, which cuts nothing off."""
    result = CliRunner().invoke(main, arguments, env={"COLUMNS": "80"})
    assert result.exit_code == 0, result.output
    assert max(map(len, result.stdout.splitlines())) <= 80
    assert "\u2026" not in result.stdout
    return result.stdout


def test_examples_of_the_help_fit_80_columns():
    """Both commands of the help run as they are printed; an end of the sweep has three torques and four tensions."""
    shown = CliRunner().invoke(main, ["analyse", "equilibrium", "--help"]).stdout
    lines = shown[shown.index("Examples:") :].replace("\\\n", "").splitlines()[1:]
    one, sweep = (line.split()[1:] for line in lines if line.strip())
    assert one[:2] == sweep[:2] == ["analyse", "equilibrium"]
    assert "static equilibrium" in told(one)
    swept = told(sweep)
    assert "quasi-static sweep" in swept
    rows = [
        words for line in swept.splitlines() if (words := line.split())[:3] == ["90.00", "180.00", "180.00"]
    ]
    assert sum(len(words) - 3 for words in rows) == 7


def test_tables_leave_out_what_is_none():
    """Round-off (1e-10 N at the base, beside 80 N of the loops) is no load."""
    shown = told(["analyse", "equilibrium", "amos3", "--rigid", "all"])
    assert "base" not in shown
    assert "loads" in shown


PENDULUM = """
scene = {{ name = "arm", until = "1 s", gravity = [9.81, 0, 0] }}
base = {{ name = "wall", points = {{ p = [0, 0, 0] }} }}
[[body]]
name = "arm"
place = {{ body = "wall", point = "p" }}
rigid = {{ mass = 2, center_of_mass = [0.6, 0, 0], inertia = [0.02, 0.3, 0.31], points = {{ r = [0, 0, 0] }} }}
[[connection]]
name = "joint"
preset = "{preset}"
axes = {{ x = [0, 1, 0] }}
ports = {{ inboard = {{ body = "wall", point = "p" }}, outboard = {{ body = "arm", point = "r" }} }}
"""


@pytest.mark.parametrize("preset", ["revolute", "spherical"])
def test_a_pendulum_in_a_joint_by_its_preset_has_its_frequency(preset, tmp_path):
    """Closed form: sqrt(m g a / I). Regression: refused, as a joint that carries nothing yet gives no stiffness.

    As posed that stays so, and is told. About its own axis an arm in a ball joint is free.
    """
    path = tmp_path / "arm.toml"
    path.write_text(PENDULUM.format(preset=preset), encoding="utf-8")
    if preset == "spherical":
        with pytest.raises(SceneError, match="1 motion "):
            fanfold.modes(path)
        return
    found = fanfold.modes(path)
    lever, about = 2.0 * 9.81 * 0.6, 0.3 + 2.0 * 0.6**2
    assert 2.0 * pi * found.frequencies[0] == pytest.approx((lever / about) ** 0.5, rel=1e-4)
    with pytest.warns(
        fanfold.FanfoldWarning, match=r"as posed, 19\.6 N .* 1 rigid-body modes, and 0 in equilibrium"
    ):
        assert 2.0 * pi * fanfold.modes(path, as_posed=True).frequencies[0] > 100.0
