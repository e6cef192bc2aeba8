"""How surely does the wing latch in time? Motor torques and friction are drawn at random."""

import numpy as np

import orchestrator as fanfold

COUNT = 8
wing = fanfold.load("amos3", settings={"scene.until": "20 s", "scene.tolerance": 1e-3})


def last_latch_up(seed):
    """Time (s) at which the last line of a wing latches that is drawn at random, infinite where one does not."""
    draw = np.random.default_rng(seed)
    factor = draw.normal(1.0, 0.03)
    drawn = wing.with_settings(
        {
            "friction.coefficient": draw.uniform(0.05, 0.15),
            "hinge_line.HL1.motor": {"stowed": 1.648 * factor, "deployed": 1.048 * factor},
        }
    )
    latched = fanfold.simulate(drawn, rigid="all", estimate=False).latch_times
    return max(latched.values()) if len(latched) == len(wing.hinge_lines) else np.inf


times = np.array([last_latch_up(seed) for seed in range(COUNT)])
print(f"last latch-up at {times.mean():.2f} s, between {times.min():.2f} and {times.max():.2f} s")
