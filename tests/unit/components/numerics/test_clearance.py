"""Spring and damper beyond a clearance: the balance of energy of any step, order 4, and the bushing without play."""

import numpy as np
import pytest

from components.numerics.clearance import Clearance
from components.numerics.fourth_order_correction import stiff_load
from components.numerics.stiff_coordinate import Memory, StepMotion

STIFFNESS, DAMPING = 300.0, 2.0


def motions_of(start, end, moment, h=0.1, memory=None):
    memory = memory or Memory(0.3, 0.2, 0.4)
    return [StepMotion(a, b, h, memory, m) for a, b, m in zip(start, end, moment, strict=True)]


@pytest.mark.parametrize("is_paired", [False, True])
@pytest.mark.parametrize("members", [(0,), (0, 1)])
def test_work_is_the_change_of_energy_and_heat(members, is_paired):
    """Conservation, to round-off: steps within, across and through a clearance; heat is never negative."""
    rng, law = np.random.default_rng(3), Clearance(members, 0.5, STIFFNESS, DAMPING)
    size = len(members)
    for start, end, moment in rng.uniform(-1.0, 1.0, (200, 3, size)) * rng.choice([0.01, 1.0], (200, 1, 1)):
        loads = law.loads(motions_of(start, end, moment if is_paired else 0.0 * moment), is_paired=is_paired)
        work = sum(
            load.force * d + load.slope * m for load, d, m in zip(loads, end - start, moment, strict=True)
        )
        stored = law.potential(end) - law.potential(start)
        heat, numerical = (sum(getattr(load, name) for load in loads) for name in ("heat", "numerical"))
        assert work + stored + heat + numerical == pytest.approx(0.0, abs=1e-11 * STIFFNESS)
        assert heat >= -1e-15


@pytest.mark.parametrize("is_paired", [False, True])
def test_without_play_it_is_the_bushing(is_paired):
    """Limit: a clearance of 1e-13 changes loads by as much, times the stiffness over the size of the coordinates."""
    motions = motions_of((0.3, -0.2), (0.31, -0.19), (1e-3, -2e-3))
    own = Clearance((0, 1), 1e-13, STIFFNESS, DAMPING).loads(motions, is_paired=is_paired)
    plain = [stiff_load(STIFFNESS, DAMPING, m, is_paired=is_paired) for m in motions]
    assert np.array(own) == pytest.approx(np.array(plain), abs=1e-9)


def test_loads_along_a_curved_path_are_of_order_four():
    """Definition: mean and first moment of the force along an arc beyond a round clearance, against Gauss' rule.

    Halving a step leaves 1/16 of the mean's error, and 1/8 of that of the first moment, which itself goes with h.
    """
    law = Clearance((0, 1), 0.5, STIFFNESS, 0.0)
    nodes, weights = np.polynomial.legendre.leggauss(12)

    def errors(h):
        def place(s):
            t = 0.5 * h * s
            return np.array(
                [(0.8 + 0.3 * t) * np.cos(2.0 * t + 0.4), (0.8 + 0.3 * t) * np.sin(2.0 * t + 0.4)]
            )

        path = place(nodes)
        start, end = place(-1.0), place(1.0)
        motions = motions_of(start, end, start + end - path @ weights, h, Memory(0.0, 0.0))
        loads = law.loads(motions, is_paired=True)
        force = np.array([law.force(q, (0.0, 0.0)) for q in path.T]).T
        mean, first = 0.5 * force @ weights, 1.5 * (force * nodes) @ weights
        return [
            np.abs(np.array([getattr(load, name) for load in loads]) - exact).max()
            for name, exact in (("force", mean), ("slope", first))
        ]

    rates = np.log2(np.array(errors(0.1)) / errors(0.05))
    assert rates[0] > 3.9
    assert rates[1] > 2.9
