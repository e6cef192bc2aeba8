"""Linear models at rest: exact derivatives, closed forms of oscillators and pendulums, clamped finite elements."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest

from components import REGISTRY, left_product
from components.body import Body
from components.flexible.reduction import fixed_interface_frequencies
from orchestrator.assembly import Part
from orchestrator.assembly.assemble import assemble
from orchestrator.assembly.statics.configuration import configuration, loaded, placed
from orchestrator.assembly.statics.connection_at_rest import Connection, at_rest
from orchestrator.assembly.statics.linear_model import linearise, modal_damping, normal_modes
from orchestrator.assembly.statics.mechanism import Mechanism
from orchestrator.assembly.statics.placed_body import PlacedBody
from orchestrator.scene import SceneError, find_scene, load_scene
from tests.references import catalogue
from tests.references.closed_forms import two_inertia_frequency
from tests.references.coupled import between, rigid, turned
from tests.references.edits import edited

RATE = 180.0 / pi
"""N.m/rad in 1 N.m/deg"""
CLAMP = (
    'kind = "bushing", translational_stiffness = [1e12, 1e12, 1e12], '
    "rotational_stiffness = [1e12, 1e12, 1e12]"
)
PANEL = """
[scene]
name = "panel"
until = 1.0
gravity = [0.0, 0.0, GRAVITY]
[base]
points = { root = [0.0, 0.0, 0.0] }
[joint]
axial_stiffness = 1e12
radial_stiffness = 1e12
cross_stiffness = 1e12
damping_ratio = 0.0
[[body]]
name = "panel"
[body.rigid]
mass = 7.5
center_of_mass = [0.8, 0.0, 0.0]
inertia = [0.8, 1.4, 2.1]
points = { root = [0.0, 0.0, 0.0] }
[[hinge_line]]
name = "line"
inboard = "base"
outboard = "panel"
axis = "+y"
aligned_angle = "90 deg"
latch = { stiffness = 4000, kind = "spring", damping_ratio = 0.02, effective_inertia = 6.2 }
hinges = [{ name = "hinge", inboard = "root", outboard = "root" }]
"""
INERTIA = 1.4 + 7.5 * 0.8**2


def panel(folder, gravity=0.0):
    path = folder / "panel.toml"
    text = edited(PANEL, ("GRAVITY", str(gravity)))
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def deformed_body():
    """The example body turned and bent: rotations of 1e-3 at its ports, whose cube is round-off."""
    structure = Body.example().structure
    start = {"initial_orientation": turned((0.6, 0.0, 0.8), 0.7), "initial_position": (1.0, -2.0, 0.5)}
    body = PlacedBody(Part("body", "body", structure, start))
    largest = np.abs(body.body.rotation).max() or np.abs(body.body.translation).max()
    body.eta = 1e-3 / largest * np.array([1.0, -0.5, 0.3, 0.8])
    return body


def small_rotation(after, before):
    w, x, y, z = before
    turn = left_product(tuple(after)) @ np.array((w, -x, -y, -z))
    return 2.0 * turn[1:] * np.sign(turn[0])


def differences(body, function, step=1e-6):
    """Central differences of a function of a placed body by its coordinates; columns are coordinates."""
    columns = []
    at = (body.position, body.orientation, body.eta)
    for k in range(body.size):
        ends = []
        for sign in (1.0, -1.0):
            change = np.zeros(body.size)
            change[k] = sign * step
            body.move(change)
            ends.append(function())
            body.position, body.orientation, body.eta = at
        columns.append((ends, k))
    return columns


def test_port_motions_have_the_derivatives_of_the_body_component():
    """Independent: differences of the outputs of the component that runs; 1e-6 steps of poses of 1 m leave 1e-9."""
    body = deformed_body()
    reference = body.motions()
    for (plus, minus), k in differences(body, body.motions):
        for port in range(len(body.ports)):
            expected = np.concatenate(
                (
                    plus[port, :3] - minus[port, :3],
                    small_rotation(plus[port, 3:7], minus[port, 3:7]),
                )
            )
            np.testing.assert_allclose(body.port_jacobian(port)[:, k], expected / 2e-6, atol=2e-8)
    np.testing.assert_array_equal(body.motions(), reference)


def test_held_wrenches_have_the_geometric_stiffness_of_the_body_component():
    """Independent: differences of the component's own rates of momentum under wrenches held in world axes."""
    body = deformed_body()
    wrenches = np.random.default_rng(3).normal(0.0, 20.0, (len(body.ports), 6))
    stiffness = body.stiffness(wrenches)
    scale = np.abs(body.modal_matrices()[1]).max()
    for (plus, minus), k in differences(body, lambda: body.forces(wrenches), 1e-5):
        expected = -(plus - minus) / 2e-5
        # round-off of the modal forces and the third derivative of 20 N.m over 1e-5, both below 1e-7
        np.testing.assert_allclose(stiffness[:, k], expected, atol=1e-7 + 1e-9 * scale)


@pytest.mark.parametrize("kind", ["hinge", "ccl", "eddy_current_damper"])
def test_tangents_of_relative_connections_equal_plain_differences(kind):
    """Independent: the first port's columns by objectivity against differences of the wrenches themselves."""
    example = REGISTRY[kind].example()
    random = np.random.default_rng(5)
    motions = {}
    for k, port in enumerate(example.ports):
        motion = np.zeros(13)
        motion[:3] = 0.4 * k + random.normal(0.0, 0.01, 3)
        motion[3:7] = turned((0.0, -1.0, 0.0), 0.1 * k + 0.02)
        motions[port.name] = motion
    start = {"translational_stiffness": (3e3, 5e3, 4e3), "rotational_stiffness": (0.0, 200.0, 300.0)}
    start |= {"translational_damping": (3.0, 2.0, 1.0), "rotational_damping": (0.5, 0.2, 0.3)}
    start = {k: v for k, v in start.items() if k in example.parameter_layout}
    connection = Connection(Part("connection", kind, example.structure, start), motions)
    bent = connection.motions
    bent[1, :3] += (0.003, -0.002, 0.004)
    connection.put(bent)
    for found, of_rates in ((connection.stiffness(), False), (connection.damping(), True)):
        expected = connection._differences(connection.motions, of_rates, 0)
        # round-off of 2e3 N over steps of 1e-5, and the third derivative over its square
        np.testing.assert_allclose(found, expected, atol=2e-7 + 1e-9 * np.abs(expected).max())


def test_friction_is_left_out_and_a_kinematic_latch_is_its_lock():
    """Definition: an endpoint hinge with the lock's stiffness, no latch damping, no friction."""
    assembly = assemble(load_scene(find_scene("amos3")), (), ())
    hinge = next(part for part in assembly.parts if part.name == "hl3_left")
    assert hinge.structure["latch"] == "kinematic"
    resting = at_rest(hinge)
    assert resting.structure["latch"] == "spring"
    assert resting.structure["wrench_mode"] == "endpoint"
    assert resting.start["latch_stiffness"] == 1e8
    assert all(resting.start[name] == 0.0 for name in resting.start if name.startswith("friction"))


@pytest.mark.parametrize(("rate", "expected"), [(10.0, 2.99620), (19.344, 4.167200)])
def test_two_free_bodies_on_a_latch(rate, expected):
    """Closed form and Bagnoli A.2.3: f = sqrt(K (1/J1 + 1/J2)) / 2 pi with two springs; six free motions."""
    j1, j2 = 6.6971, 1.0 / (1.0 / 3.23333 - 1.0 / 6.6971)
    points = {"left": (0.0, 0.5, 0.0), "right": (0.0, -0.5, 0.0)}
    bodies = [rigid("one", 5.0, (4.0, j1, 5.0), points), rigid("two", 4.0, (3.0, j2, 4.0), points)]
    start = {"translational_stiffness": (1e8,) * 3, "latch_stiffness": rate * RATE}
    hinges = [Part(name, "hinge", {"axis": (0.0, 1.0, 0.0), "latch": "spring"}, start) for name in points]
    links = [link for name in points for link in between(name, f"one.{name}", f"two.{name}")]
    mechanism = Mechanism([*bodies, *hinges], links)
    mechanism.command("latch_command", 1.0, points)
    modes = normal_modes(linearise(mechanism))
    assert int(modes.is_free.sum()) == 6
    frequency = modes.frequencies[~modes.is_free][0]
    assert frequency == pytest.approx(two_inertia_frequency(2.0 * rate * RATE, j1, j2), rel=1e-9)
    assert frequency == pytest.approx(
        expected, abs=1e-5
    )  # as printed in the source, J1 J2/(J1+J2) to six figures


def test_rigid_motions_of_a_free_assembly_meet_no_stiffness():
    """Conservation: unloaded connections between bodies resist no common motion, nor does their damping."""
    scene = load_scene(find_scene("amos3"))
    free = scene.base.model_validate(
        {
            "name": "spacecraft",
            "points": scene.base.points,
            "free": {"mass": 1500.0, "inertia": [900.0, 1500.0, 1200.0]},
        }
    )
    model = linearise(placed(replace(scene, base=free, loops=()), (), (), configuration(scene, "deployed")))
    motion = model.mechanism.rigid_motion(model.origin)
    for matrix in (model.stiffness, model.damping):
        scale = np.sqrt(np.abs(np.diag(matrix)))
        # motors leave 2 N.m of unbalanced torque, whose moments turn with the bodies
        loose = 4.0 if matrix is model.stiffness else 0.0
        assert np.abs(matrix @ motion).max() < loose + 1e-12 * scale.max() ** 2
    model = linearise(loaded(replace(scene, base=free), ("all",), (), configuration(scene, "deployed")))
    assert int(normal_modes(model).is_free.sum()) == 6


@pytest.mark.parametrize("gravity", [-9.80665, 9.80665])
def test_pendulum(tmp_path, gravity):
    """Closed form: f = sqrt(m g a / J) / 2 pi when hanging, the same as a growth rate when standing.

    All of it is geometric stiffness of the weight on the hinge, which stretches by 7.5 g / 1e12 m.
    """
    scene = panel(tmp_path, gravity)
    target = configuration(scene, angles={"line": pi})  # the panel hangs along -z
    modes = normal_modes(linearise(loaded(scene, (), (), target)))
    expected = sqrt(7.5 * abs(gravity) * 0.8 / INERTIA) / (2.0 * pi)
    assert modes.frequencies[0] == pytest.approx(expected if gravity < 0.0 else -expected, rel=1e-6)


def test_latched_panel_and_its_damping(tmp_path):
    """Closed form: f = sqrt(K / J) / 2 pi; the latch damps by 2 zeta sqrt(K J_eff), J_eff of the scene."""
    scene = panel(tmp_path)
    model = linearise(placed(scene, (), (), configuration(scene, "deployed")))
    modes = normal_modes(model)
    assert modes.frequencies[0] == pytest.approx(sqrt(4000.0 / INERTIA) / (2.0 * pi), rel=1e-7)
    damping = 2.0 * 0.02 * sqrt(4000.0 * 6.2)
    assert modal_damping(model, modes)[0] == pytest.approx(damping / (2.0 * sqrt(4000.0 * INERTIA)), rel=1e-7)


def without_torques(scene):
    lines = tuple(
        line.model_copy(
            update={
                "motor": None,
                "harness": None,
                "hinges": tuple(h.model_copy(update={"harness": False}) for h in line.hinges),
            }
        )
        for line in scene.hinge_lines
    )
    return replace(scene, hinge_lines=lines, loops=(), dampers=())


def test_deployed_rigid_wing_against_the_planar_chain():
    """Closed form: three rigid links on three springs, absolute angles, M_ij = sum of m c c and J; sheet (c)."""
    stiff = ("joint.axial_stiffness=1e11", "joint.radial_stiffness=1e11", "joint.cross_stiffness=1e9")
    scene = without_torques(load_scene(find_scene("amos3"), (), stiff))
    model = linearise(placed(scene, ("all",), (), configuration(scene, "deployed")))
    modes = normal_modes(model)
    data = {b.name: b.body.data for b in model.mechanism.bodies.values() if b.body is not None}
    mass = np.array([data[n].mass for n in ("yoke", "panel1", "panel2")])
    center = np.array([data[n].center_of_mass[0] for n in ("yoke", "panel1", "panel2")])
    inertia = np.array([data[n].inertia[1, 1] for n in ("yoke", "panel1", "panel2")])
    yoke, panel1 = data["yoke"], data["panel1"]
    length = [
        yoke.point_positions[yoke.point_names.index("hl2_left")][0],
        panel1.point_positions[panel1.point_names.index("hl3_left")][0],
    ]
    arms = np.array([[center[0], 0, 0], [length[0], center[1], 0], [length[0], length[1], center[2]]])
    matrix = np.diag(inertia) + (arms.T * mass) @ arms
    opening = np.array([[1.0, 0, 0], [-1, 1, 0], [0, -1, 1]])
    stiffness = opening.T @ np.diag([2500.0, 1800.0, 2074.0]) @ opening
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(matrix, stiffness)).real)) / (2.0 * pi)
    planar = [f for f, s in zip(modes.frequencies, modes.shapes.T, strict=True) if out_of_plane(model, s)]
    # compliance of joints: m w^2 / k = 18 * 28^2 / 1e11
    np.testing.assert_allclose(planar[:3], expected, rtol=1e-6)


def out_of_plane(model, shape):
    """Whether a mode turns the bodies about y more than about x and z."""
    rows = [r for n, r in model.mechanism.rows.items() if n != model.mechanism.base]
    turns = np.array([shape[r][3:6] for r in rows])
    return np.abs(turns[:, 1]).max() > 10.0 * np.abs(turns[:, [0, 2]]).max()


def asymmetry(model):
    """Largest entry of K - K^T over the root of its diagonal entries."""
    k = model.stiffness[np.ix_(model.free_rows, model.free_rows)]
    scale = np.sqrt(np.abs(np.diag(k))) + np.finfo(float).tiny
    return np.abs((k - k.T) / np.outer(scale, scale)).max()


def test_tangent_at_a_loaded_equilibrium_is_symmetric():
    """Conservative forces: a Hessian, with preload of cables, motors against latches and bent bodies; round-off."""
    scene = load_scene(find_scene("amos3"))
    for fidelity in (("all",), ()):
        model = linearise(loaded(scene, fidelity, (), configuration(scene, "deployed")))
        assert asymmetry(model) < 1e-8
        assert max(model.unbalanced) < 1e-5
    bare = without_torques(scene)
    assert asymmetry(linearise(placed(bare, ("all",), (), configuration(bare, "deployed")))) < 1e-10


def test_tangent_of_a_whole_wing_against_differences_of_its_forces():
    """Independent: generalised forces of the moved wing, preloaded, rigid and flexible bodies in one.

    Scaled by diagonal entries: round-off of 1e8 N.m/rad locks over steps of 1e-6 is 1e-8, the step's square less.
    """
    scene = load_scene(find_scene("amos3"))
    mechanism = loaded(scene, ("yoke",), (), configuration(scene, "deployed"))
    model = linearise(mechanism)
    scale = np.sqrt(np.abs(np.diag(model.stiffness)))
    for k in model.free_rows:
        step = np.zeros(mechanism.size)
        step[k] = min(1e-6, 1e-3 / scale[k])
        mechanism.move(step)
        plus = mechanism.forces()
        mechanism.move(-2.0 * step)
        minus = mechanism.forces()
        mechanism.move(step)
        difference = -(plus - minus) / (2.0 * step[k])
        np.testing.assert_allclose((model.stiffness[:, k] - difference) / (scale * scale[k]), 0.0, atol=1e-5)


def test_flexible_panel_on_a_locked_hinge_has_its_fixed_interface_frequencies(tmp_path):
    """Independent: finite elements with clamped points; fixed-interface modes are exact in a reduced body.

    Bushings of 1e12 N/m are 1e6 times stiffer than the arms in their plane, which shifts frequencies by 2e-6.
    """
    text = """
    [scene]
    name = "clamped"
    until = 1.0
    [base]
    points = { left = [0.0, 0.565, 0.0], right = [0.0, -0.565, 0.0] }
    [[body]]
    name = "panel"
    catalogue = "workbench_panel"
    [[hinge_line]]
    name = "line"
    inboard = "base"
    outboard = "panel"
    axis = "+y"
    aligned_angle = "90 deg"
    latch = { kind = "kinematic", stiffness = 4000, effective_inertia = 6.2 }
    hinges = [
      { name = "left", inboard = "left", outboard = "hl_left", JOINT },
      { name = "right", inboard = "right", outboard = "hl_right", JOINT },
    ]
    """
    path = tmp_path / "clamped.toml"
    path.write_text(edited(text, ("JOINT", CLAMP)), encoding="utf-8")
    scene = load_scene(path)
    modes = normal_modes(linearise(placed(scene, (), (), configuration(scene, "deployed"))))
    elements = catalogue.entry("workbench_panel").finite_elements()
    expected = fixed_interface_frequencies(elements, ("hl_left", "hl_right"), 6) / (2.0 * pi)
    np.testing.assert_allclose(modes.frequencies[:6], expected, rtol=1e-5)


def test_loops_keep_their_preload_where_the_lines_turn_together():
    """Kinematics: pulleys of 60 and 30 mm over 90 and 180 degrees leave the strands as they were."""
    scene = load_scene(find_scene("amos3"))
    mechanism = placed(scene, ("all",), (), configuration(scene, "deployed"))
    observed = mechanism.connections["yoke_loop"].observe()
    assert observed["tension_a"] == pytest.approx(40.0, abs=1e-6)
    apart = placed(scene, ("all",), (), configuration(scene, "deployed", {"HL1": 0.5 * pi - 0.01}))
    observed = apart.connections["yoke_loop"].observe()
    # pulley 1 turned back by 0.01 rad takes r1 * 0.01 from strand a and gives it to strand b
    assert observed["tension_b"] - observed["tension_a"] == pytest.approx(2 * 5367 * 0.06 * 0.01, rel=1e-3)


def test_what_a_configuration_refuses():
    """Sentences that name the line."""
    scene = load_scene(find_scene("amos3"))
    for angles, latched, words in (({"HL9": 0.0}, None, "HL9"), ({}, ("HL1", "HLX"), "HLX")):
        with pytest.raises(SceneError, match=words):
            configuration(scene, "deployed", angles, latched)
    unlatched = replace(
        scene, hinge_lines=tuple(k.model_copy(update={"latch": None}) for k in scene.hinge_lines)
    )
    with pytest.raises(SceneError, match="no latch"):
        configuration(unlatched, latched="HL1")
