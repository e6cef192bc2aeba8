"""A stiff hinge coordinate that the step does not resolve: damped as the scheme's closed form, never pumped."""

import numpy as np
import pytest

from orchestrator.assembly import Part
from orchestrator.cosim.settings import Settings
from tests.references.coupled import base, between, completed, rigid

STEP = 0.01
MASS = 2.0


def total_energy(run):
    return run.signal("body", "kinetic_energy") + run.signal("hinge", "potential_energy")


def ringing_body(angle, steps):
    """A body of 2 kg that starts at 1 m/s along the line of a hinge of w h = angle at h = 10 ms."""
    stiffness = MASS * (angle / STEP) ** 2
    parts = [
        base(p=(0, 0, 0)),
        rigid("body", MASS, (1.0, 1.0, 1.0), {"p": (0, 0, 0)}, initial_velocity=(0, 1.0, 0)),
        Part("hinge", "hinge", {}, {"translational_stiffness": (stiffness, 0, 0)}),
    ]
    settings = Settings(step_plan=[steps])
    return completed(sum(steps), parts, between("hinge", "base.p", "body.p"), settings=settings)


def test_stiff_coordinates_are_damped_as_documented():
    """Closed form of the scheme: amplitude 0.64 per step at infinite stiffness, damping ratio 5e-5 at w h = 0.1.

    At infinite stiffness increments obey 0.8 d' = -s + 0.2 d + 0.1 p, p' = 2 d' - p: roots of modulus 0.642
    and 0.606. A finite one moves d' by (p - d') / (0.4 (w h)^2), and p' by twice that. Both documented numbers
    are rounded.
    """
    free = np.array([[1 - 1 / 0.8, 0.25, 0.125], [-1 / 0.8, 0.25, 0.125], [-2 / 0.8, 0.5, 0.25 - 1]])
    assert np.abs(np.linalg.eigvals(free)).max() == pytest.approx(0.64, abs=5e-3)
    run = ringing_body(1e3, [STEP] * 30)
    end_rate = run.signal("body", "linear_momentum")[:, 1] / MASS
    place = run.signal("body", "frame_position")[:, 1]
    states = np.array((place, np.diff(place, prepend=-STEP), STEP * end_rate)).T
    size = np.maximum(np.abs(states[1:]).max(1), np.abs(states[:-1]).max(1))
    rest = np.abs(states[1:] - states[:-1] @ free.T).max(1)
    assert np.all(rest < 2.0 * 2.0 / 0.4 / 1e3**2 * size)
    energy = total_energy(ringing_body(0.1, [STEP] * 630))
    # after 10 whole periods of 2 pi / 0.1 steps
    assert np.log(energy[0] / energy[628]) / (2 * 62.8) == pytest.approx(5e-5, abs=0.5e-5)


@pytest.mark.parametrize("angle", [0.3, 3.0, 300.0])
def test_a_stiff_coordinate_is_passive_at_a_constant_step(angle):
    """Passivity: the energy stays below its start plus what the start remembers, and falls.

    The memory of the inertial terms holds at most k (h v)^2 / 8, that is (w h)^2 / 4 of the kinetic energy.
    """
    energy = total_energy(ringing_body(angle, [STEP] * 100))
    assert energy[0] == pytest.approx(1.0)
    assert energy.max() <= 1.0 + 0.25 * angle**2
    assert energy[-1] < 1.0


@pytest.mark.parametrize("angle", [3.0, 30.0, 300.0])
@pytest.mark.parametrize("seed", [0, 1])
def test_step_control_does_not_pump_a_stiff_coordinate(angle, seed):
    """Stability under changes of step as the control makes them: down by up to 8, up by 2 after two steps.

    Remembered rates are kept, so a change may add some of the memory: the bound is twice that of a constant
    step. Damping wins in the end. (Changes by 8 up and down in turn would not be survived.)
    """
    random, level, since, steps = np.random.default_rng(seed), 0, 0, []
    for _ in range(120):
        since += 1
        if level < 12 and random.random() < 0.25:
            level, since = min(12, level + int(random.integers(1, 7))), 0
        elif since >= 2 and level > 0:
            level, since = max(0, level - int(random.integers(1, 3))), 0
        steps.append(STEP * 2 ** (-level / 2))
    energy = total_energy(ringing_body(angle, steps))
    assert energy.max() <= 2.0 * (1.0 + 0.25 * angle**2)
    assert energy[-1] < 1.0
