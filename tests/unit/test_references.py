"""The references themselves: published numbers, limits, and identities they must obey."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from components.flexible.modal import ModalData
from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references import closed_forms, relative_motion
from tests.references import nodal_flexible_body as nodal
from tests.references.coupled import base, between, completed, rigid, turned
from tests.references.free_rotor import free_rotor

INERTIA, START = np.array([1.0, 2.0, 3.0]), np.array([1.0, 0.01, 1.0])


def made_up_body(damping=0.0):
    rng = np.random.default_rng(2)
    arms = rng.standard_normal((6, 3))
    masses = rng.uniform(0.5, 1.5, 6)
    arms -= masses @ arms / masses.sum()
    shapes = 0.2 * rng.standard_normal((6, 3, 2))
    return nodal.NodalBody(masses, arms, shapes, 0.1 * shapes, np.array([6.0, 15.0]), np.full(2, damping))


def made_up_motion():
    quaternion = np.roll(Rotation.from_rotvec((0.3, -0.8, 0.5)).as_quat(), 1)
    return nodal.Motion(
        np.array([0.1, 0.2, 0.3]), quaternion, np.array([0.3, -0.2]), np.array([0.4, -0.1, 0.2]),
        np.array([1.0, -0.7, 0.9]), np.array([0.5, 0.8]),
    )  # fmt: skip


def test_nodal_body_of_general_shapes_keeps_momentum_and_energy():
    """Conservation laws, for shapes that are neither orthogonal to rigid motions nor to each other.

    Integrated to 1e-11, so the totals of 1 s hold to 1e-9.
    """
    body, start = made_up_body(), made_up_motion()
    before = nodal.momenta_and_energy(body, start)
    after = nodal.momenta_and_energy(body, nodal.integrate(body, [], start, 1.0))
    assert after[0] == pytest.approx(before[0], abs=1e-9)
    assert after[1] == pytest.approx(before[1], abs=1e-9)
    assert after[2] == pytest.approx(before[2], abs=1e-9)


def test_nodal_generalised_load_has_the_power_of_the_load():
    """Virtual power: force and torque on a port moved by finite differences along the velocities."""
    body, motion = made_up_body(), made_up_motion()
    load = nodal.PortLoad(3, (0.1, -0.2, 0.3), (1.0, -2.0, 0.7), (0.4, 0.5, -0.9))

    def port(t):
        a = Rotation.from_quat(np.roll(motion.orientation, -1)) * Rotation.from_rotvec(t * motion.spin)
        eta = motion.eta + t * motion.rate
        turn = body.turns[3] @ eta
        arm = body.arms[3] + body.shapes[3] @ eta + np.array(load.offset) + np.cross(turn, load.offset)
        return motion.position + t * motion.velocity + a.apply(arm), a * Rotation.from_rotvec(turn)

    h = 1e-5
    (x0, a0), (x1, a1) = port(-h), port(h)
    power = np.dot(load.force, x1 - x0) + np.dot(load.torque, (a1 * a0.inv()).as_rotvec())
    velocities = np.concatenate((motion.velocity, motion.spin, motion.rate))
    assert nodal.generalised_load(body, motion, load) @ velocities == pytest.approx(power / (2 * h), rel=1e-8)


def test_nodal_mass_matrix_gives_the_kinetic_energy():
    """Definition: v^T M v / 2 is the sum of m v^2 / 2, and without deformation its corners are mass and inertia."""
    body, motion = made_up_body(), made_up_motion()
    v = np.concatenate((motion.velocity, motion.spin, motion.rate))
    strain = 0.5 * np.sum((body.frequency * motion.eta) ** 2)
    matrix = nodal.mass_matrix(body, motion)
    assert 0.5 * v @ matrix @ v + strain == pytest.approx(
        nodal.momenta_and_energy(body, motion)[2], rel=1e-13
    )
    still = nodal.Motion(
        np.zeros(3), np.array([1.0, 0, 0, 0]), np.zeros(2), np.zeros(3), np.zeros(3), np.zeros(2)
    )
    matrix = nodal.mass_matrix(body, still)
    assert matrix[:3, :3] == pytest.approx(np.eye(3) * body.masses.sum())
    inertia = sum(
        m * (s @ s * np.eye(3) - np.outer(s, s)) for m, s in zip(body.masses, body.arms, strict=True)
    )
    assert matrix[3:6, 3:6] == pytest.approx(inertia)


def test_nodal_motion_survives_packing():
    """Identity: pack and unpack."""
    motion = made_up_motion()
    again = nodal.unpack(motion.pack(), 2)
    assert all(np.array_equal(getattr(motion, n), getattr(again, n)) for n in motion.__dataclass_fields__)


@pytest.mark.parametrize("size", [1e-6, 0.9e-4, 1.1e-4, 0.7, 2.5])
def test_left_jacobian(size):
    """Definition by finite differences of the exponential map."""
    v, rate = size * np.array([0.6, -0.64, 0.48]), np.array([0.3, 0.5, -0.4])
    h = 1e-6
    step = Rotation.from_rotvec(v + h * rate) * Rotation.from_rotvec(v - h * rate).inv()
    assert nodal.left_jacobian(v) @ rate == pytest.approx(step.as_rotvec() / (2 * h), abs=1e-9)


def test_free_rotor_has_the_published_constants():
    """Reference: k^2, period and w(10 s), to the digits given."""
    rotor = free_rotor(INERTIA, START)
    assert rotor.parameter == pytest.approx(0.333355555, abs=6e-10)
    assert rotor.period == pytest.approx(6.93560682, abs=6e-9)
    assert rotor.angular_velocity(0.0) == pytest.approx(START, abs=1e-14)
    assert rotor.angular_velocity(10.0) == pytest.approx((-0.92490028, 0.38034125, 0.97560930), abs=6e-9)


@pytest.mark.parametrize("time", [0.0, 1.3, 7.7])
def test_free_rotor_obeys_eulers_equations(time):
    """Euler's equations I w' = I w x w by central differences; round-off over h plus h^2."""
    rotor, h = free_rotor(INERTIA, START), 1e-4
    rate = (rotor.angular_velocity(time + h) - rotor.angular_velocity(time - h)) / (2 * h)
    w = rotor.angular_velocity(time)
    assert INERTIA * rate == pytest.approx(np.cross(INERTIA * w, w), abs=1e-7)


def test_free_rotor_refuses_other_cases():
    """The formulas hold for rotation about the third axis only."""
    with pytest.raises(ValueError, match="third axis"):
        free_rotor(INERTIA, np.array([1.0, 0.0, 0.01]))


def test_closed_forms_have_the_published_numbers():
    """Benchmarks 1, 2, 5 and 15, to the digits given."""
    assert closed_forms.spring_driven(6.2514, 0.27693, 8.3198, np.pi) == pytest.approx(
        (4.27132, 1.370585), abs=5e-6
    )
    assert closed_forms.spring_driven(6.2514, 0.27693, 8.3198, np.pi / 2).time == pytest.approx(
        2.96760, abs=5e-6
    )
    assert closed_forms.spring_driven_angle(6.2514, 0.27693, 8.3198, 4.2713158) == pytest.approx(
        np.pi, abs=1e-6
    )
    assert closed_forms.two_inertia_frequency(
        2 * 19.344 * 180 / np.pi, 6.466666667, 6.466666667
    ) == pytest.approx(4.167200, abs=5e-7)
    assert closed_forms.coulomb_stop(6.2514, 0.5, 1.0) == pytest.approx((12.5028, 6.2514), abs=1e-12)
    assert closed_forms.pinned_pair_inertia(9.6208, 6.2514, 7.582, 1.855, 0.7944) == pytest.approx(
        1.5303, abs=5e-5
    )


def test_pinned_pair_inertia_without_an_arm():
    """Limit: a second body balanced about the joint feels the first one's inertia with its mass at the tip."""
    first, second = 9.0 + 7.0 * 1.8**2, 6.0
    assert closed_forms.pinned_pair_inertia(9.0, second, 7.0, 1.8, 0.0) == pytest.approx(
        first * second / (first + second)
    )


def test_stiction_overrun_is_the_integral():
    """Quadrature of J w / T(w) over the rise of friction, minus that of constant friction."""
    ratio = (np.arange(100000) + 0.5) / 100000
    integral = np.mean(ratio / (1.5 * ratio - 0.5 * ratio**3) - ratio)
    expected = 2.0 * 0.03**2 / 0.7 * integral
    assert closed_forms.stiction_overrun(2.0, 0.7, 0.03) == pytest.approx(expected, rel=1e-8)


def test_work_and_resultant_of_known_wrenches():
    """Arithmetic: a force along a way, a torque over a turn, a pair of forces about a point."""
    before = np.concatenate((relative_motion.port_motion(), relative_motion.port_motion((2, 0, 0))))
    after = np.concatenate(
        (relative_motion.port_motion((0.5, 0, 0)), relative_motion.port_motion((2, 0, 0), (0, 0, 0.3)))
    )
    outputs = np.array([4.0, 0, 0, 0, 0, 0, -4.0, 2.0, 0, 0, 0, 5.0])
    assert relative_motion.work(outputs, before, after, 2) == pytest.approx(4.0 * 0.5 + 5.0 * 0.3)
    assert relative_motion.resultant(outputs, before, after, 2, (1.0, 0, 0)) == pytest.approx(
        (0, 2, 0, 0, 0, 7)
    )


def test_coupled_scene_of_a_known_motion():
    """Closed form: a body on a soft spring along the hinge line swings with cos w t; records are by name."""
    parts = [
        base(p=(0, 0, 0)),
        rigid("body", 2.0, (1, 1, 1), {"p": (0, 0, 0)}, initial_position=(0, 0.1, 0)),
        Part("hinge", "hinge", {}, {"translational_stiffness": (8.0, 0, 0)}),
    ]
    run = completed(1.0, parts, between("hinge", "base.p", "body.p"), settings=Settings(fixed_step=2e-3))
    place = run.signal("body", "frame_position")[:, 1]
    # 5/24 (w h)^2 of the frequency, times the angle of 2 rad
    assert place == pytest.approx(
        0.1 * np.cos(2.0 * np.array(run.times)), abs=0.1 * 2 * 5 / 24 * (2 * 2e-3) ** 2
    )
    assert run.scene("step_size")[-1] == pytest.approx(2e-3)
    assert Rotation.from_quat(np.roll(turned((0, 0, 1), 0.4), -1)).as_rotvec() == pytest.approx((0, 0, 0.4))


def test_modal_data_of_all_masses_feeds_the_nodal_body():
    """Definition: shapes are mass-orthonormal and orthogonal to rigid motions.

    So M(q) of the undeformed nodal body is block diagonal with a unit block.
    """
    rng = np.random.default_rng(7)
    masses, places = rng.uniform(0.5, 1.5, 7), rng.standard_normal((7, 3))
    data = ModalData.from_point_masses(
        masses, places, rng.standard_normal((21, 3)), np.array([1.0, 2.0, 3.0]), {str(i): i for i in range(7)}
    )
    body = nodal.NodalBody(
        masses,
        places - data.center_of_mass,
        data.translation,
        data.rotation,
        data.frequency,
        data.damping_ratio,
    )
    still = nodal.Motion(
        np.zeros(3), np.array([1.0, 0, 0, 0]), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    )
    matrix = nodal.mass_matrix(body, still)
    assert matrix[6:, 6:] == pytest.approx(np.eye(3), abs=1e-13)
    assert matrix[:6, 6:] == pytest.approx(np.zeros((6, 3)), abs=1e-13)
    assert data.keep_modes([0, 2]).translation == pytest.approx(data.translation[:, :, [0, 2]])
