"""The latch as an event: a plastic impact in closed form, the lock that follows, and the spring latch beside it."""

import numpy as np
import pytest

from orchestrator.assembly import HingeLine, Part
from orchestrator.cosim.settings import Settings
from tests.references.closed_forms import pinned_pair_inertia
from tests.references.coupled import base, between, completed, rigid, turned
from tests.unit.components.hinge.hinge_cases import AXIS, at

MASS, ARM = (7.5558, 7.582), (1.0318, 0.7944)
ABOUT_HINGE, LENGTH = (9.6208, 6.2514), 1.855
RELATIVE_RATE = 2.234
REDUCED = pinned_pair_inertia(*ABOUT_HINGE, MASS[1], LENGTH, ARM[1])
TOGETHER = ABOUT_HINGE[0] + MASS[1] * LENGTH**2 + ABOUT_HINGE[1] + 2 * MASS[1] * LENGTH * ARM[1]
LEFT = 2.0 * REDUCED / 1e6  # twice the share of the rate that a lock of 1e6 kg m2 leaves
IMPULSES = 2e-7  # s, of the impulse that stills the joints and the one that latches


def pinned_pair(step, lead, latch="kinematic"):
    """Sheet 2.2: inboard panel pinned at HL1 and free, outboard panel `lead` before its straight position."""
    joint = {
        "translational_stiffness": (1e9, 1e9, 1e9),
        "translational_damping": (4e4, 4e4, 4e4),
        "rotational_stiffness": (0.0, 1e6, 1e6),
    }
    turn_1 = -0.5
    spin_1, spin_2 = np.array((0, turn_1, 0)), np.array((0, turn_1 + RELATIVE_RATE, 0))
    elbow = np.array((LENGTH, 0, 0))
    center_2 = ARM[1] * np.array((np.cos(lead), 0, np.sin(lead)))
    inertias = [
        (0.5, j - m * a * a, j - m * a * a + 0.4) for j, m, a in zip(ABOUT_HINGE, MASS, ARM, strict=True)
    ]
    parts = [
        base(root=(0, 0, 0)),
        rigid(
            "inner", MASS[0], inertias[0], {"root": (0, 0, 0), "tip": tuple(elbow)}, (ARM[0], 0, 0),
            initial_velocity=tuple(np.cross(spin_1, (ARM[0], 0, 0))), initial_angular_velocity=tuple(spin_1),
        ),
        rigid(
            "outer", MASS[1], inertias[1], {"root": (0, 0, 0)}, (ARM[1], 0, 0),
            initial_position=tuple(elbow), initial_orientation=turned(AXIS, -lead),
            initial_velocity=tuple(np.cross(spin_1, elbow) + np.cross(spin_2, center_2)),
            initial_angular_velocity=tuple(spin_2),
        ),
        Part("HL1", "hinge", {}, joint),
        Part("HL2", "hinge", {"latch": latch}, {**joint, "stowed_angle": -lead, "latch_stiffness": 2216.66}),
    ]  # fmt: skip
    links = [*between("HL1", "base.root", "inner.root"), *between("HL2", "inner.tip", "outer.root")]
    line = HingeLine("HL2", ("HL2",), "HL2", latches=True, kinematic=latch == "kinematic")
    settings = Settings(tolerance=1e-6, fixed_step=step)
    run = completed(1.15 * lead / RELATIVE_RATE + 3 * step, parts, links, [line], settings=settings)
    return run, at(run, run.events[0][0])


def kinetic_energy(run):
    return run.signal("inner", "kinetic_energy") + run.signal("outer", "kinetic_energy")


def momentum_about_pin(run):
    return (run.signal("inner", "angular_momentum") + run.signal("outer", "angular_momentum"))[:, 1]


@pytest.mark.parametrize("step", [1e-4, 1e-3, 5e-3, 2e-2])
def test_kinematic_latch_is_a_plastic_event(step):
    """Reference: H about HL1 is kept; energy falls by J_eff w^2 / 2 = 3.82 J, to 1e-6 at every step size.

    Until then centrifugal moments, which go with the lead, change the rate by the order of the lead squared.
    """
    assert pytest.approx(1.5303, abs=5e-5) == REDUCED
    assert pytest.approx(3.82, abs=5e-3) == 0.5 * REDUCED * RELATIVE_RATE**2
    lead = 2e-3
    run, i = pinned_pair(step, lead)
    rate, energy, momentum = run.signal("HL2", "angular_rate"), kinetic_energy(run), momentum_about_pin(run)
    assert run.signal("HL2", "angle")[i] == pytest.approx(0.0, abs=IMPULSES * RELATIVE_RATE)
    assert rate[i] == pytest.approx(RELATIVE_RATE, rel=10 * lead**2)
    assert momentum[i + 1] == pytest.approx(momentum[i], rel=1e-6)
    drop = 0.5 * REDUCED * rate[i] ** 2
    assert energy[i] - energy[i + 1] == pytest.approx(drop, rel=1e-6)
    assert energy[i + 1] == pytest.approx(momentum[i] ** 2 / (2 * TOGETHER), rel=1e-6)
    assert run.signal("HL2", "dissipated_energy")[i + 1] == pytest.approx(drop, rel=LEFT)
    assert run.signal("HL2", "friction_energy")[-1] == 0.0


@pytest.mark.parametrize("step", [2e-3, 2e-2])
def test_kinematic_latch_after_a_swing(step):
    """Closed form: after the event both turn as one, with the energy H^2 / 2 I of the momentum before it.

    The lock takes J^2 / 2 I of its impulse; bushings ring with 5e-5 of the energy, which the event takes as well.
    Until the event the momentum is kept to the wrenches' iteration, 1e-8.
    """
    run, i = pinned_pair(step, 0.5)
    impulse, energy, momentum = (
        run.signal("HL2", "latch_impulse"),
        kinetic_energy(run),
        momentum_about_pin(run),
    )
    assert momentum[i] == pytest.approx(momentum[0], rel=1e-8)
    assert momentum[i + 1] == pytest.approx(momentum[i], rel=1e-6)
    assert energy[i + 1] == pytest.approx(momentum[i] ** 2 / (2 * TOGETHER), rel=1e-6)
    assert energy[i] - energy[i + 1] == pytest.approx(0.5 * impulse[i + 1] ** 2 / REDUCED, rel=1e-4)


def test_kinematic_latch_locks_from_the_event_on():
    """Definition of the lock: no relative rate and no drift, against the centripetal loads of the swing."""
    run, i = pinned_pair(1e-3, 2e-2)
    assert len(run.times) > i + 5
    assert np.abs(run.signal("HL2", "angular_rate")[i + 1 :]).max() < LEFT * RELATIVE_RATE
    assert np.abs(run.signal("HL2", "angle")[i + 1 :]).max() < IMPULSES * RELATIVE_RATE


def test_spring_latch_keeps_the_energy():
    """Conservation law: no damping, so the spring latch gives and takes; only the hinges' own damping is lost.

    To 1e-8, the iteration of the wrenches. The event itself takes nothing like the plastic 3.82 J.
    """
    run, i = pinned_pair(1e-3, 2e-3, "spring")
    total = (
        kinetic_energy(run) + run.signal("HL2", "potential_energy") + run.signal("HL1", "potential_energy")
    )
    lost = sum(
        run.signal(hinge, name)
        for hinge in ("HL1", "HL2")
        for name in ("dissipated_energy", "numerical_dissipation")
    )
    assert run.signal("HL2", "potential_energy")[i:].max() > 0.01
    assert total + lost == pytest.approx(total[0], rel=1e-8)
    assert total[i] - total[i + 1] < 1e-5 * 0.5 * REDUCED * RELATIVE_RATE**2
