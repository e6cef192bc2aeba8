"""Bodies that held lines join to the base: loads, weight and mass on the spacecraft are theirs as well."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.run.run import RunError

YOKE, PANEL = 5.0, 8.0
GRAVITY = (0.5, -9.0, 2.0)


def wing(base, held, gravity=(0.0, 0.0, 0.0)):
    """A yoke at 35 deg, held on a base or by its line, and a panel whose motor opens it."""
    scene = fanfold.Scene("held", until=1.0, tolerance=1e-5, gravity=gravity)
    ground = scene.base("sc", **{"points": {"root": (0.6, 0.1, 0.2)}, **base})
    bodies = []
    for name, mass in (("yoke", YOKE), ("panel", PANEL)):
        rigid = {
            "mass": mass,
            "center_of_mass": (0.5, 0.03, 0.01),
            "inertia": (0.4, 1.1, 1.3),
            "points": {"in": (0, 0, 0), "out": (1.0, 0.0, 0.0)},
        }
        bodies.append(scene.body(name, rigid=rigid))
    root = {"start_angle": "35 deg", "held": held}
    for name, inboard, outboard, point, more in (
        ("H1", ground, bodies[0], "root", root),
        ("H2", bodies[0], bodies[1], "out", {"motor": {"stowed": "2 N.m", "deployed": "1 N.m"}}),
    ):  # fmt: skip
        scene.hinge_line(
            name, inboard=inboard, outboard=outboard, axis="+y", aligned_angle="180 deg",
            hinges=[{"name": name.lower(), "inboard": point, "outboard": "in"}], **more,
        )  # fmt: skip
    return scene


FREE = {"free": {"mass": 60.0, "inertia": (9.0, 11.0, 8.0), "center_of_mass": (0.0, 0.1, 0.0)}}


def test_the_spacecraft_takes_up_the_impulse_of_its_interface_loads():
    """Momentum: what the interface force adds up to is that of the spacecraft alone, whose mass is known."""
    with pytest.warns(fanfold.FanfoldWarning, match="180 deg.*W-no-end"):
        result = fanfold.simulate(wing(FREE, held=True), estimate=False)
    time, force = result.time, result.signal("sc", "interface_force")
    turn, rate = result.signal("sc", "frame_orientation"), result.signal("sc", "attitude_rate")
    axes = np.array([_axes(q) for q in turn])
    impulse = np.trapezoid(np.einsum("nij,nj->ni", axes, force), time, axis=0)
    center = np.array(FREE["free"]["center_of_mass"])
    origin = result.signal("sc", "frame_position")
    velocity = np.gradient(origin, time, axis=0)[-2] + axes[-2] @ np.cross(rate[-2], center)
    # trapezoids over some hundred steps, and a velocity by central differences
    assert impulse == pytest.approx(FREE["free"]["mass"] * velocity, rel=5e-3, abs=5e-3)


def _axes(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_a_ground_bears_the_weight_of_all():
    """Statics: the weight of the yoke and of the panel, in the analysis and in a run from rest."""
    scene = wing({}, held=True, gravity=GRAVITY)
    found = fanfold.equilibrium(scene, hold="all")
    assert found.base_load[:3] == pytest.approx((YOKE + PANEL) * np.array(GRAVITY), rel=1e-9)
    loose = fanfold.equilibrium(wing({}, held=False, gravity=GRAVITY), hold="all")
    # the held line turns by the load over the stiffness that holds it there
    torque = np.array(loose.base_load[3:])
    assert found.base_load[3:] == pytest.approx(torque, abs=1e-3 * np.linalg.norm(torque))


@pytest.mark.parametrize("base", [{}, FREE], ids=["ground", "free"])
def test_what_a_linear_appendage_weighs(base):
    """Independent way: the same line, not held in the scene but by the analysis, carries the same mass."""
    kept = {"points": ["root"], "angles": {"H2": 0.7}, "as_posed": True}
    (found,) = fanfold.appendage(wing(base, held=True), **kept)
    (same,) = fanfold.appendage(wing(base, held=False), hold=["H1"], **kept)
    np.testing.assert_allclose(found.rigid_mass, same.rigid_mass, rtol=1e-9, atol=1e-9)
    assert found.mass == pytest.approx(YOKE + PANEL, rel=1e-12)


def test_a_response_at_low_frequency_is_that_of_the_whole_mass():
    """Closed form: far below all resonances the interface force is mass times acceleration."""
    found = fanfold.frequency_response(
        wing(FREE, held=True), as_posed=True, excite="y", along="y", low=1e-3, high=2e-3
    )
    magnitude = np.abs(found.responses[0].values[0])
    assert magnitude == pytest.approx(YOKE + PANEL, rel=1e-3)


def test_a_driven_base_refuses_what_it_would_carry(tmp_path):
    with pytest.raises(RunError, match=r"sc .*fixed"):
        fanfold.export(wing({}, held=True), tmp_path, as_one=True, driven_base=True)
