"""Derivatives through a trolley that is braked to rest, against a closed form."""

import pytest

import orchestrator as fanfold
from tests.references.native_fmus import needs_native
from tests.unit.run.test_rails import MASS, PULL, incline

FRICTION, BRAKED, AT = 6.0, 25.0, 2.0


@needs_native
def test_a_replay_comes_to_rest():
    """Closed form: work of the weight over the way s = a t^2 / 2 + (a t)^2 / 2 b, a = (W - F) / m, b = (B - W) / m.

    The last 20 mm/s of 3.8 m/s go under less than full friction. Regression: matrices from one side of the kink in
    friction threw wrenches on the other to and fro, and no run with another value could follow.
    """
    scene = incline(FRICTION, until="3 s")
    scene.event("brake", time=f"{AT} s", set={"rail": {"friction_force": BRAKED}})
    key = "connection.rail.parameters.friction_force"
    found = fanfold.gradients(scene, [key], verify=False)
    row = dict(zip(found.names, found.derivatives[:, 0], strict=True))["energy_exchanged"]
    a, b = (PULL - FRICTION) / MASS, (BRAKED - PULL) / MASS
    assert row == pytest.approx(-PULL / MASS * (0.5 * AT**2 + a * AT**2 / b), rel=5e-3)
