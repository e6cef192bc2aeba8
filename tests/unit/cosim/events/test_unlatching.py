"""Latches that let go and engage again: closed forms of constant torques, the energy in a latch, all masters."""

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.results.identifiers import unit_of
from tests.references.leaf import leaf_on_a_jamb
from tests.references.native_fmus import needs_native
from tests.unit.run.as_one.host import Host

INERTIA, TORQUE, STIFFNESS, LATCH = 0.5, 0.4, 300.0, 1.0
"""kg.m2 about the line, N.m, N.m/rad, rad."""
GONE, READY = 3.0, 4.0
"""s: when the latch is opened and the motor pulls back, when it is ready and the motor pushes again."""


def door(kind="spring", events=True):
    """A leaf that a constant torque opens against a latch; two events fold it back and open it again."""
    scene = leaf_on_a_jamb("door", INERTIA, until="7 s", tolerance=1e-5)
    scene.hinge_line(
        "HL", "base", "leaf", axis="+y", aligned_angle=f"{LATCH} rad", hinges={"hinge": ("jamb", "root")},
        motor={"stowed": TORQUE, "deployed": TORQUE},
        latch={"kind": kind, "stiffness": STIFFNESS, "effective_inertia": INERTIA, "damping_ratio": 0.6},
    )  # fmt: skip
    if events:
        back, forth = ({"motor_constant_torque": way * TORQUE} for way in (-1, 1))
        scene.event("restow", time=GONE, set={"HL": {"unlatch_command": 1, **back}})
        scene.event("again", time=READY, set={"HL": {"unlatch_command": 0, **forth}})
    return scene


@pytest.fixture(scope="module")
def restowed():
    return fanfold.simulate(door(), estimate=False)


def test_latch_times_are_closed_forms(restowed):
    """Constant torques: t^2 = 2 J a / T to the latch; folded back for a second from the deflected latch, and back."""
    first = np.sqrt(2.0 * INERTIA * LATCH / TORQUE)
    deflected, thrown = TORQUE / STIFFNESS, READY - GONE
    acceleration = TORQUE / INERTIA
    way = 0.5 * acceleration * thrown**2 - deflected  # to the latch, from where the motor pushes again
    rate = acceleration * thrown
    later = (rate + np.sqrt(rate**2 + 2.0 * acceleration * way)) / acceleration
    events = {text: time for time, _, text in restowed.events if text.startswith("HL ")}
    assert restowed.latch_times["HL"] == pytest.approx(first, rel=1e-5)
    assert events["HL unlatched"] == GONE
    assert events["HL latch-up"] == pytest.approx(READY + later, rel=1e-5)
    found = restowed.headline.unlatchings["HL"]
    assert (found.time, found.again) == (GONE, events["HL latch-up"])
    assert restowed.headline.not_opened == {}


def test_requirements_know_its_numbers(restowed):
    """Definition: identifiers of all headline numbers may stand in requirements, in their units."""
    numbers = list(restowed.headline.numbers())
    assert {"unlatch_time.HL", "last_latch_time.HL"} <= {number.id for number in numbers}
    assert {number.id: unit_of(number.id) for number in numbers} == {n.id: n.unit for n in numbers}


def test_what_a_latch_stores_becomes_heat(restowed):
    """Statics: a latch under a torque T stores T^2 / (2 k); the balance of energy closes."""
    rows = [
        np.searchsorted(restowed.time, GONE - 1e-3),
        np.searchsorted(restowed.time, GONE + 1e-6, side="right"),
    ]
    before, after = restowed["hinge", "latch_energy"][:][rows]
    assert after - before == pytest.approx(0.5 * TORQUE**2 / STIFFNESS, rel=1e-6)
    assert restowed["hinge", "latch_torque"][rows[1]] == 0.0
    assert restowed.headline.energy_residual < 1e-5


def test_locks_let_go_as_springs_do(restowed):
    """Limit: a lock between rigid bodies does not deflect, so the way back to it is T / k longer."""
    found = fanfold.simulate(door("kinematic"), estimate=False).headline.unlatchings["HL"]
    later = TORQUE / STIFFNESS / (TORQUE / INERTIA * np.sqrt(2.0))  # over the rate at the latch
    assert found.time == GONE
    assert found.again - restowed.headline.unlatchings["HL"].again == pytest.approx(later, rel=0.02)


def test_explicit_masters_open_latches(restowed):
    """Independent: end-point wrenches over steps of 1 ms, up to the way back."""
    found = fanfold.simulate(door(), estimate=False, master="gauss-seidel", step="1 ms", until=READY)
    assert found.headline.unlatchings["HL"].again is None
    rows = np.searchsorted(restowed.time, READY)
    assert found["hinge", "angle"][-1] == pytest.approx(restowed["hinge", "angle"][rows], abs=2e-3)


@needs_native
def test_a_host_opens_and_closes_the_latch_of_a_wing(tmp_path):
    """Independent: the wing as one FMU under commands and torques of a host, and the run with events."""
    (path,) = fanfold.export(door(events=False), tmp_path, as_one=True)
    expected = fanfold.simulate(door(), estimate=False, tolerance=1e-5)
    host = Host(path).start().to(GONE, 0.5)
    assert host["HL.latched"] == 1.0
    host["HL.unlatch_command"], host["hinge.motor_constant_torque"] = 1.0, -TORQUE
    host.to(READY, 0.5)
    assert host["HL.latched"] == 0.0
    host["HL.unlatch_command"], host["hinge.motor_constant_torque"] = 0.0, TORQUE
    host.to(7.0, 0.5)
    assert host["HL.latched"] == 1.0
    assert host["HL.latch_time"] == pytest.approx(expected.headline.unlatchings["HL"].again, abs=1e-6)


@pytest.mark.parametrize(
    ("command", "key"),
    [
        ({"unlatch_command": 2}, "unlatch_command"),
        ({"unlatch_command": 1, "latch_command": 1}, "opens the latch of HL and closes it"),
    ],
)
def test_what_makes_no_sense_is_refused(command, key):
    """Definition: a command is 1 or 0, and no event opens and closes a latch."""
    scene = door(events=False)
    scene.event("wrong", time=1.0, set={"HL": command})
    (problem,) = fanfold.check_scene(scene).problems
    assert key in problem


@pytest.mark.filterwarnings("ignore:.*W-not-opened")
def test_an_open_latch_stays_open():
    """Definition: a latch opened before it is reached, and not made ready, does not engage; the run warns."""
    scene = door(events=False)
    scene.event("open", time=0.5, set={"HL": {"unlatch_command": 1}})
    with pytest.warns(fanfold.FanfoldWarning, match="did not unlatch HL"):
        found = fanfold.simulate(scene, until=2.0, estimate=False)
    assert found.latch_times == {}
    assert found["hinge", "angle"][-1] > LATCH
