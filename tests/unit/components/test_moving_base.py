"""Moving base: ports follow the laws, inertia loads and work are those of closed forms and of another solution."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from components.contract.ports import MOTION_SIZE
from components.moving_base import MovingBase
from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import between, completed, rigid

ARM, MASS, INERTIA = 0.4, 3.0, 0.2


def moving(**structure):
    """A base with one port at the pivot's side."""
    return Part(
        "base", "moving_base", {"ports": [{"name": "point", "position": (0.0, 0.0, 0.0)}], **structure}, {}
    )


def mounted(stiffness, turning, until, h, arm, body=None, joint=None, **structure):
    """A body on a port of a moving base."""
    joint = {
        "translational_stiffness": (stiffness,) * 3, "rotational_stiffness": turning, **(joint or {})
    }  # fmt: skip
    parts = [
        moving(**structure),
        rigid("body", MASS, (INERTIA,) * 3, {"point": (0, 0, 0)}, arm, **(body or {})),
        Part("joint", "hinge", {"axis": (0, 1, 0)}, joint),
    ]
    links = between("joint", "base.point", "body.point")
    return completed(until, parts, links, settings=Settings(fixed_step=h, order=4))


def closes(run, tolerance):
    """Whether the balance of energy stays closed to a part of what was supplied."""
    return np.ptp(run.scene("energy_residual")) < tolerance * np.abs(run.scene("supplied_energy")).max()


def test_a_pendulum_on_a_shaken_base():
    """Independent solution: (I + m l^2) q'' = -m l (g sin q + s'' cos q), by DOP853.

    The joint gives by m g / k = 3e-6 m.
    """
    amplitude, frequency, until, gravity = 0.05, 1.5, 1.0, 9.81
    w = 2 * np.pi * frequency
    law = [{"profile": "harmonic", "amplitude": amplitude, "frequency": frequency, "phase": np.pi / 2}]

    def pendulum(t, y):
        push = -amplitude * w * w * np.cos(w * t)
        turn = MASS * ARM * (gravity * np.sin(y[0]) + push * np.cos(y[0]))
        return (y[1], -turn / (INERTIA + MASS * ARM**2))

    reference = solve_ivp(pendulum, (0, until), (0.0, 0.0), method="DOP853", rtol=1e-11, atol=1e-12)
    structure = {"translation": law, "translation_axis": (1, 0, 0)}
    start = {"gravity": (0, 0, -gravity), "initial_position": (amplitude, 0, 0)}
    run = mounted(1e7, (0.0, 1e5, 1e5), until, 2e-3, (0, 0, -ARM), start, **structure)
    # about y, what swings to +x turns to -q
    assert run.signal("joint", "angle")[-1] == pytest.approx(-reference.y[0, -1], abs=1e-5)
    assert closes(run, 1e-6)


def test_a_body_that_is_spun_up():
    """Closed form: m r w^2 inwards on the body, and (I + m r^2) w^2 / 2 supplied.

    The joint gives by m w^2 / k = 5e-4 of the arm; half critically damped, its ringing has died out in 0.5 s.
    """
    rate, duration, until, give = 4.0, 0.5, 1.0, MASS * 16.0 / 1e5
    structure = {
        "rotation": [{"profile": "spin_up", "duration": duration, "rate": rate}],
        "rotation_axis": (0, 0, 2),
    }
    damping = {"translational_damping": (548.0,) * 3, "rotational_damping": (45.0,) * 3}
    run = mounted(1e5, (1e4,) * 3, until, 4e-3, (ARM, 0, 0), joint=damping, **structure)
    radius = ARM / (1.0 - give)
    force = run.signal("base", "interface_force")[-1]
    pull = MASS * radius * rate**2
    # the last row's mean is told in axes that have turned on by w h / 2
    assert force == pytest.approx((pull, 0, 0), abs=(rate * 4e-3) ** 2 * pull)
    energy = 0.5 * (INERTIA + MASS * radius**2) * rate**2 + 0.5 * pull**2 / 1e5
    supplied = run.signal("base", "supplied_energy")[-1] - run.signal("joint", "dissipated_energy")[-1]
    assert supplied == pytest.approx(energy, rel=1e-4)
    assert run.signal("base", "turn")[-1] == pytest.approx(rate * (until - 0.5 * duration), rel=1e-12)
    assert closes(run, 1e-5)


def test_a_free_body_is_not_felt():
    """Definition: on a joint without stiffness a body stays at rest while the base turns and moves beneath it."""
    law = [{"profile": "step5", "duration": 0.2, "change": 1.0}]
    run = mounted(0.0, (0.0,) * 3, 0.2, 5e-3, (ARM, 0, 0), translation=law, rotation=law, pivot=(1, 0, 0))
    assert run.signal("body", "kinetic_energy")[-1] == 0.0
    assert run.signal("base", "supplied_energy")[-1] == 0.0
    assert run.signal("joint", "angle")[-1] == pytest.approx(0.0, abs=1e-12)


def test_ports_follow_the_laws():
    """Definition and independent rotations: poses after steps, rates by differences, moments by a fine quadrature."""
    base, h = MovingBase.example(), 0.02
    u = np.zeros(base.input_layout.size)
    x = base.initial(None, u)
    for _ in range(4):
        x = base.step(None, x, u, h)
    t, names = 4 * h, [port.name for port in base.ports]
    turning, along = np.array((0.0, 0.6, 0.8)), np.array((1.0, 0.0, 1.0)) / np.sqrt(2)
    frame = Rotation.from_quat((0.5, 0.5, -0.5, 0.5), scalar_first=True)
    origin = np.array((0.3, -0.2, 0.5))
    arms = {"hinge": (0, 0, 0), "pulley": (0, 0.6, 0), "drag": (0.3, -0.2, 0.1)}
    places = {name: origin + frame.apply(arm) for name, arm in arms.items()}
    pivot, rate, duration = origin + frame.apply((0.1, 0.2, -0.1)), 0.4, 0.05

    def angle(time):
        risen = min(time, duration)
        wave = rate / duration * (duration / (2 * np.pi)) ** 2 * (np.cos(2 * np.pi * risen / duration) - 1)
        return rate / duration * risen**2 / 2 + wave + rate * max(time - duration, 0.0)

    def place(name, time):
        shift = 0.02 * np.sin(4 * np.pi * time) * along
        return pivot + shift + Rotation.from_rotvec(angle(time) * turning).apply(places[name] - pivot)

    y, z = base.outputs(None, x, u), base.observe(None, x, u)
    found = Rotation.from_quat(z[base.observation_layout["frame_orientation"]], scalar_first=True)
    assert (found * (Rotation.from_rotvec(angle(t) * turning) * frame).inv()).magnitude() < 1e-12
    assert z[base.observation_layout["frame_position"]] == pytest.approx(place("hinge", t), abs=1e-12)
    for number, name in enumerate(names):
        motion = y[MOTION_SIZE * number : MOTION_SIZE * (number + 1)]
        assert motion[:3] == pytest.approx(place(name, t), abs=1e-12)
        difference = (place(name, t + 1e-5) - place(name, t - 1e-5)) / 2e-5
        assert motion[7:10] == pytest.approx(difference, abs=1e-8)
        assert motion[10:] == pytest.approx(rate * turning, abs=1e-12)
        times = np.linspace(t - h, t, 2001)
        p1 = 2 * (times - t) / h + 1
        speeds = np.gradient(np.array([place(name, time) for time in times]), times, axis=0)
        moment = y[base.output_layout[f"{name}.velocity_moment"]]
        assert moment == pytest.approx(np.trapezoid(p1[:, None] * speeds, times, axis=0), abs=1e-9)
