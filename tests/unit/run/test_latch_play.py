"""Latches with play: closed forms of a leaf that bounces between two springs, and measured curves with a loose part."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.assembly.assemble import assemble
from tests.references.closed_forms import bouncing
from tests.references.leaf import leaf_on_a_jamb
from tests.references.native_fmus import needs_native

INERTIA, STIFFNESS, PLAY, RATE, LATCH = 0.5, 300.0, 0.02, 0.4, 1.0
"""kg.m2, N.m/rad, rad either way, rad/s, rad."""
FREQUENCY = np.sqrt(STIFFNESS / INERTIA)


def leaf(damping_ratio=0.0, **latch):
    """A leaf without motor that turns at a rate into its latch."""
    scene = leaf_on_a_jamb("loose", INERTIA, until=1.5)
    common = {"stiffness": STIFFNESS, "effective_inertia": INERTIA, "damping_ratio": damping_ratio}
    scene.hinge_line(
        "HL", "base", "leaf", axis="+y", aligned_angle=f"{LATCH} rad", start_angle="0.9 rad", start_rate=RATE,
        hinges={"hinge": ("jamb", "root")}, latch={**common, **(latch or {"play": PLAY})},
    )  # fmt: skip
    return scene


def test_a_leaf_bounces_between_two_springs():
    """Closed form, at the default tolerance: angles at all rows, and the peak torque RATE sqrt(k J)."""
    found = fanfold.simulate(leaf(), estimate=False)
    latched = found.latch_times["HL"]
    rows = found.time > latched + 1e-6
    expected = LATCH + bouncing(found.time[rows] - latched, PLAY, RATE, FREQUENCY)
    assert np.abs(found["hinge", "angle"][rows] - expected).max() < 1e-5 * np.ptp(expected)
    peak = RATE * np.sqrt(STIFFNESS * INERTIA)
    assert found.headline.latch_torque_peaks["HL"] == pytest.approx(peak, rel=1e-4)
    assert found.headline.energy_residual < 1e-8


def test_damping_acts_beyond_the_play():
    """Closed form: each half cycle in a spring leaves exp(-pi z / sqrt(1 - z^2)) of the rate, the play all of it."""
    ratio = 0.1
    found = fanfold.simulate(leaf(ratio), estimate=False)
    depth = found["hinge", "angle"][:] - LATCH
    loose = (np.abs(depth) < 0.9 * PLAY) & (found.time > found.latch_times["HL"])
    rates = np.abs(found["hinge", "angular_rate"][:])[loose]
    bounces = np.cumsum(np.diff(np.flatnonzero(loose), prepend=np.flatnonzero(loose)[0]) > 1)
    assert bounces[-1] >= 4
    left = np.exp(-np.pi * ratio / np.sqrt(1.0 - ratio**2))
    assert rates == pytest.approx(RATE * left**bounces, rel=2e-4)


def test_a_measured_curve_without_torque_at_first_is_play():
    """Definition: between rigid bodies the latch has the play of the curve, as if it were stated."""
    toe = {"deflection": [-0.04, -PLAY, 0.0, PLAY, 0.05], "torque": [-6.0, 0.0, 0.0, 0.0, 9.0]}
    measured, stated = (
        next(part for part in assemble(scene.check()).parts if part.name == "hinge").structure
        for scene in (leaf(measured=toe), leaf())
    )
    assert measured == stated
    assert measured["latch_torque"] == (-STIFFNESS, 0.0, 0.0, STIFFNESS)


@needs_native
def test_native_and_python_agree():
    """Independent implementations, over 55 steps of 10 ms through both ends of the play."""
    native, python = (
        fanfold.simulate(
            leaf(0.05), estimate=False, step="10 ms", until=0.55, tolerance=1e-9, backend=backend
        )
        for backend in ("native", "python")
    )
    for name in ("angle", "latch_torque", "latch_energy", "potential_energy"):
        expected = python["hinge", name][:]
        assert native["hinge", name][:] == pytest.approx(
            expected, abs=1e-9 * max(np.abs(expected).max(), 1e-3)
        )


def test_a_play_of_a_radian_is_doubted():
    """Rule: it is a likely mistake of units, and no more than that. Regression: it ended with a traceback."""
    with pytest.warns(fanfold.FanfoldWarning, match=r"latch\.play.*0\.1 rad.*W-end-data"):
        fanfold.simulate(leaf(play="1 rad"), estimate=False)


@pytest.mark.parametrize(
    ("latch", "key"),
    [
        ({"play": PLAY, "kind": "kinematic"}, "a kinematic latch has no play"),
        ({"play": PLAY, "measured": {"deflection": [-1e-2, 1e-2], "torque": [-1.0, 1.0]}}, "leave out play"),
        (
            {"measured": {"deflection": [0.0, 1e-2, 2e-2], "torque": [0.0, 1.0, 1.0]}},
            "except where they are 0",
        ),
        ({"measured": {"deflection": [0.0, 1e-2], "torque": [0.0, 0.0]}}, "has no torque"),
    ],
)
def test_what_is_no_play_is_refused(latch, key):
    """Definition: a lock is not loose, and a curve rises outside of its play."""
    with pytest.raises(fanfold.FanfoldError, match=key):
        leaf(**latch)
