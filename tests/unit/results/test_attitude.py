"""A spacecraft that turns over: its attitude is a rotation vector, which begins anew."""

import warnings

import pytest

import orchestrator as fanfold


@pytest.mark.parametrize(("torque", "told"), [(2.0, True), (1.0, False)])
def test_more_than_a_turn_is_told(torque, told):
    """Closed form: T t^2 / 2 J is 1.27 turns after 4 s under 2 N.m, and 0.64 under half of that."""
    scene = fanfold.Scene("turning", until="4 s")
    base = scene.base("craft", points={"middle": (0, 0, 0)}, free={"mass": 10.0, "inertia": (2, 2, 2)})
    law = [{"profile": "constant", "value": torque}]
    structure = {"direction": (0, 0, 1), "torque": law}
    scene.connection("wheel", "load", structure=structure, ports={"body": (base, "middle")})
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        run = fanfold.simulate(scene, estimate=False)
    assert any("W-attitude" in str(one.message) for one in heard) == told
    assert run["craft", "attitude_rate"][-1, 2] == pytest.approx(torque * 4.0 / 2.0, rel=1e-6)
