"""What runs tell of trolleys on rails: friction that is chosen to be smooth at rest holds nothing."""

import numpy as np
import pytest

import orchestrator as fanfold

MASS, SLOPE, TRANSITION = 2.0, np.radians(30.0), 0.02
PULL = MASS * 9.81 * np.sin(SLOPE)


def incline(friction, breakaway=1e-4, **header):
    """A block on an inclined rail."""
    scene = fanfold.Scene("incline", gravity=(0, 0, -9.81), **header)
    scene.base(points={"o": (0, 0, 0)})
    rigid = {"mass": MASS, "inertia": (0.01,) * 3, "points": {"c": (0.0, 0.0, 0.0)}}
    scene.body("block", rigid=rigid, place={"body": "base", "point": "o"})
    scene.connection(
        "rail", "rail", ports={"trolley": {"body": "block", "point": "c"}},
        structure={"normal": (np.sin(SLOPE), 0.0, np.cos(SLOPE))},
        parameters={
            "friction_force": friction, "stiction_velocity": TRANSITION, "normal_damping": 2e3,
            "breakaway_deflection": breakaway,
        },
    )  # fmt: skip
    return scene


def test_a_trolley_that_creeps_is_told():
    """Closed form: r (3 - r^2) / 2 of full friction is the pull, at r of the speed of full friction."""
    with pytest.warns(fanfold.FanfoldWarning, match="rail: .*12.5 mm/s .*W-creep") as told:
        found = fanfold.simulate(incline(12.0, 0.0, until="2 s"), estimate=False)
    r = found["rail", "sliding_speed"][-1] / TRANSITION
    assert 0.5 * r * (3.0 - r * r) == pytest.approx(PULL / 12.0, rel=1e-4)
    assert any("stiction_velocity (20 mm/s)" in str(one.message) for one in told)


@pytest.mark.parametrize(("friction", "breakaway"), [(6.0, 0.0), (6.0, 1e-4), (12.0, 1e-4)])
def test_a_trolley_that_slides_or_sticks_gives_no_warning(friction, breakaway, recwarn):
    """Its friction is full, or holds it."""
    found = fanfold.simulate(incline(friction, breakaway, until="0.5 s"), estimate=False)
    assert not [one for one in recwarn if "creeps" in str(one.message)]
    assert (found["rail", "sliding_speed"][-1] < 1e-6) == (friction > PULL)


def test_what_slides_has_no_start_at_rest():
    """Closed form: what friction leaves of the pull accelerates it. Regression: a search let it slide by 190 mm."""
    with pytest.raises(fanfold.FanfoldError, match="block") as told:
        fanfold.simulate(incline(6.0, until="0.1 s", preload=True), estimate=False)
    assert f"{(PULL - 6.0) / MASS:.2g} m/s2" in str(told.value)
