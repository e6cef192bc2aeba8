"""Native connections move as in process, in regimes that examples do not reach; derivatives against differences.

Observations agree to 1e-9 of the iteration's tolerance. Differences of 1e-7 m or rad err by their rounding, and by the
curvature of a law: that of friction over the slide of a step, which is 3 mm here, and that of play over its 10 mm.
"""

import pytest

from tests.references.coupled import Part, base, rigid
from tests.references.native_fmus import native_errors, needs_native
from tests.unit.components import test_drive as drive
from tests.unit.components import test_hold_down as hold_down
from tests.unit.components import test_rail as rail
from tests.unit.components import test_suspension as suspension
from tests.unit.components.hinge import test_sticking as sticking

BOLT = {"start": {"initial_velocity": (0.2, -0.4, 1.0)}, "translational_damping": (40.0,) * 3}
MOTION = {"start_angle": 0.1, "end_angle": 0.9, "damping": 3.0}
SLIDING = {"initial_velocity": (0.3, -0.4, 0.1), "initial_angular_velocity": (0.1, 0.3, -0.2)}
PULLED = {"initial_velocity": (0.3, -0.4, 0.1), "gravity": (0.4, 0.2, 0.0)}
SOFT = {
    "normal_stiffness": 100.0, "normal_damping": 1.0, "rotational_stiffness": 1.0, "rotational_damping": 0.01
}  # fmt: skip
"""A guidance beside which friction shows."""
SWING = sticking.rotor(0.2, 0.3, rotational_stiffness=(5.0, 1e5, 1e5)), sticking.LINKS
LOOSE = {
    "translational_stiffness": (3e3, 5e3, 5e3), "translational_damping": (20.0, 30.0, 30.0),
    "rotational_stiffness": (7e3, 9e3, 9e3), "rotational_damping": (10.0, 4.0, 4.0), "friction_coefficient": 0.1,
    "axial_clearance": 0.01, "radial_clearance": 0.01, "twist_clearance": 0.01, "cross_clearance": 0.01,
}  # fmt: skip
KNOCKING = (
    [
        base(p=(0, 0, 0)),
        rigid("rotor", 7.0, (7.0, 6.0, 8.0), {"p": (0, 0, 0)}, initial_velocity=(0.2, 0.5, -0.3),
              initial_angular_velocity=(0.5, 0.6, -0.4)),
        Part("hinge", "hinge", {}, LOOSE),
    ],
    sticking.LINKS,
)  # fmt: skip
"""Through all four clearances: each is at its end from 0.025 s on."""
CASES = {
    "held": ("bolt", 0.05, hold_down.scene((1, 2, 2), **BOLT), 0.01, 2, 1e-8),
    "to be released": ("bolt", 0.05, hold_down.scene((1, 2, 2), **BOLT, release_time=0.055), 0.01, 2, None),
    "released": ("bolt", 0.2, hold_down.scene((1, 2, 2), **BOLT, release_time=0.055), 0.01, 2, None),
    **{
        profile: ("drive", 0.8, drive.scene(profile, **MOTION, start_time=0.1, duration=0.5), 0.02, 2, 1e-8)
        for profile in drive.PEAK_RATE
    },
    "commanded": ("drive", 0.8, drive.scene("commanded", **MOTION, duration=0.2), 0.02, 2, 1e-8),
    "slack and taut": (
        "spring", 0.6, suspension.scene((0.1, 0.0, 0.4), (0.6, 0.3, 0.0), stiffness=400.0, damping=5.0), 0.01, 2, 1e-7
    ),
    **{
        f"slides below {transition} m/s, order {order}": (
            "rail", 0.03, rail.scene(
                (1.0, 2.0, 3.0), start=SLIDING, friction_force=3.0, **SOFT, stiction_velocity=transition
            ), 0.01, order, 1e-4
        )
        for transition in (1e-3, 0.3, 0.9) for order in (2, 4)
    },
    **{
        f"sticks within {breakaway} m, order {order}": (
            "rail", 0.3, rail.scene(
                (1.0, 2.0, 3.0), start=PULLED, friction_force=1.0, **SOFT, stiction_velocity=0.3,
                breakaway_deflection=breakaway,
            ), 0.01, order, 1e-4
        )
        for breakaway in (1e-2, 0.3) for order in (2, 4)
    },
    "slides about a line": ("hinge", 0.5, SWING, 0.02, 2, 1e-9),
    "sticks about a line": ("hinge", 4.0, SWING, 0.02, 2, 1e-9),
    **{f"knocks, order {order}": ("hinge", 0.04, KNOCKING, 0.005, order, 1e-5) for order in (2, 4)},
}  # fmt: skip
"""Connection, end (s), scene, step (s), order, error of derivatives (none just before and after an event)."""


@needs_native
@pytest.mark.parametrize("case", CASES)
def test_a_native_fmu_moves_as_in_process(case):
    name, until, scene, h, order, derivatives = CASES[case]
    observed, derivative = native_errors(name, until, *scene, h, order)
    assert observed < (1e-6 if name == "hinge" else 1e-8)
    assert derivatives is None or derivative < derivatives
