"""Derivatives of slender bodies in stiff joints, whose rounding is beyond that of their loads."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from fmus import native_library

RELEASE = "connection.second.parameters.release_time"
POINTS = {
    "inner": {
        "root": (0.01, 0.02, 0.03),
        "bolt": (0.38, 0.99, -0.46),
        "tip": (2.26, 0, 0),
        "far": (1.8, 0, 0),
    },
    "outer": {"root": (0.01, 0.02, -0.03), "bolt": (2.18, -0.01, 0.02)},
}


def folded(release):
    """Two tubes of 2.3 m on a light spacecraft, ten thousand times harder to turn across than along, on two bolts."""
    scene = fanfold.Scene("folded", until="0.84 s", preload=True)
    free = {"mass": 60, "center_of_mass": (-0.2, 0.1, 0.05), "inertia": (9, 11, 13)}
    base = scene.base("base", points={"root": (0.45, 0.27, -0.37), "bolt": (0.65, 1.24, 1.13)}, free=free)
    scene.joint(axial_stiffness=2e8, radial_stiffness=5e8, cross_stiffness=2e6)
    inner, outer = (
        scene.body(
            name,
            rigid={
                "mass": mass, "center_of_mass": (1.15, 0.01, 0.014), "inertia": tilted(*turn), "points": POINTS[name],
            },
        )
        for name, mass, turn in (("inner", 3.4, (0.007, -0.06)), ("outer", 3.9, (-0.014, -0.036)))
    )  # fmt: skip
    latch = {"kind": "spring", "stiffness": 300, "effective_inertia": 2.0}
    lines = (
        ("root", base, inner, (0.313, 0.912, -0.265), "90 deg", (3.7, 2.5), "root"),
        ("middle", inner, outer, (-0.274, -0.882, 0.383), "180 deg", (1.8, 1.2), "tip"),
    )
    for name, inboard, outboard, axis, angle, (stowed, deployed), point in lines:
        scene.hinge_line(
            name, inboard, outboard, axis=axis, aligned_angle=angle, latch=latch,
            motor={"stowed": stowed, "deployed": deployed}, hinges={f"{name}_hinge": (point, "root")},
        )  # fmt: skip
    held = {"translational_stiffness": (1e7,) * 3, "translational_damping": (100.0,) * 3}
    bolts = (
        ("first", (base, "bolt"), (inner, "far"), 0.3),
        ("second", (inner, "bolt"), (outer, "bolt"), release),
    )
    for name, inboard, outboard, time in bolts:
        scene.connection(
            name, kind="hold_down", structure={"axis": (0, 0, 1)}, parameters={**held, "release_time": time},
            ports={"inboard": inboard, "outboard": outboard},
        )  # fmt: skip
    return scene


def tilted(about_y, about_z):
    """Moments and products of inertia of a tube that lies askew."""
    axes = Rotation.from_euler("yz", (about_y, about_z)).as_matrix()
    found = axes @ np.diag((1.5e-4, 1.48, 1.48)) @ axes.T
    return (*np.diag(found), found[0, 1], found[0, 2], found[1, 2])


@pytest.mark.skipif(native_library() is None, reason="the reference is made of native FMUs")
def test_slender_bodies_are_replayed_through_a_release():
    """Independent: central differences of runs.

    Regression: corrections of 1e-7 N were not taken for rounding, though all residuals were.
    """
    found = fanfold.gradients(folded(0.8), [RELEASE], tolerance=1e-4, verify=False)
    early, late = (fanfold.simulate(folded(at), tolerance=1e-6, estimate=False) for at in (0.795, 0.805))
    k = found.names.index("unlatched_angle.middle")
    angles = [run["middle_hinge", "angle"][-1] for run in (early, late)]
    assert found.derivatives[k, 0] == pytest.approx((angles[1] - angles[0]) / 0.01, rel=2e-2)
