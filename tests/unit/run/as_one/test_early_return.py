"""A scene as one FMU of FMI 3.0 that returns at a latch-up or an event of the scene, with event mode and without."""

from __future__ import annotations

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

import orchestrator as fanfold
from fmus import native_library
from tests.unit.run.as_one.host import latching
from tests.unit.run.as_one.host3 import Host3

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
SAME = 1e-9
"""Of numbers that come from the same steps of the master, at times that are sums of step sizes."""
UNTIL = 1.5


def exported(scene, folder, **options):
    (path,) = fanfold.export(scene, folder, as_one=True, fmi="3.0", **options)
    return path


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return exported(latching(), tmp_path_factory.mktemp("latching"))


@pytest.fixture(scope="module")
def latch_time():
    return fanfold.simulate(latching(), estimate=False).latch_times["HL"]


def walk(host, until=UNTIL, step=0.1):
    """Step to a time, through events; times of early returns."""
    returns = []
    while host.time < until - SAME:
        needs_event, early = host.step(min(step, until - host.time))
        if early:
            returns.append(host.time)
        if needs_event:
            host.event()
    return returns


@pytest.mark.parametrize("step", [1.0, 0.013])
def test_a_step_ends_at_latch_up(path, latch_time, step):
    host = Host3(path)
    assert walk(host, 0.9, step if step < 0.9 else 0.9) == []
    needs_event, early = host.step(step)
    while not early and host.time < 1.0:
        needs_event, early = host.step(step)
    assert needs_event
    assert early
    assert host.time == pytest.approx(latch_time, rel=SAME)


@pytest.mark.parametrize("early", [True, False])
def test_a_step_that_nobody_could_wait_for_is_refused(path, early):
    """FMI 3.0, 4.2: discarded, as smaller steps may do. Regression: it never came back."""
    host = Host3(path, early=early)
    with pytest.raises(FMICallException) as caught:
        host.fmu.doStep(0.0, 1e30)
    assert caught.value.status == 2
    assert not host.step(0.1)[1]


def test_an_event_is_read_before_and_after_it(path):
    """The latch meets a panel that moves: its damper pulls at once, and the angle has not changed."""
    host = Host3(path)
    while not host.step(0.1)[1]:
        pass
    time, angle = host.time, host["root.angle"]
    assert (host["HL.latched"], host["HL.latch_time"], host["root.latch_torque"]) == (0.0, -1.0, 0.0)
    host.event()
    assert (host["HL.latched"], host["HL.latch_time"]) == (1.0, time)
    assert host["root.latch_torque"] < -1.0
    assert host["root.angle"] == pytest.approx(angle, abs=1e-6)


def test_early_returns_change_nothing_after_them(path):
    with_events, without, inside = Host3(path), Host3(path, events=False), Host3(path, early=False)
    assert walk(with_events) == walk(without)
    assert walk(inside) == []
    for name in ("root.angle", "stored_energy", "HL.latch_torque_peak", "steps"):
        assert with_events[name] == pytest.approx(inside[name], rel=SAME)
        assert without[name] == pytest.approx(inside[name], rel=SAME)


def test_without_event_mode_what_came_out_is_read(path):
    """The host is told of no event that it could not handle."""
    host = Host3(path, events=False)
    needs_event = early = False
    while not early:
        needs_event, early = host.step(0.1)
    assert not needs_event
    assert host["HL.latched"] == 1.0
    assert host["root.latch_torque"] < -1.0


def test_a_step_that_ends_at_latch_up_by_itself_is_not_early(path, latch_time):
    host = Host3(path)
    assert host.step(latch_time) == (True, False)
    host.event()
    assert host["HL.latched"] == 1.0


def test_a_state_of_an_event_leads_to_the_same_bits(path):
    host, other = Host3(path), Host3(path)
    while not host.step(0.1)[1]:
        pass
    data = host.fmu.serializeFMUState(host.fmu.getFMUState())
    other.fmu.setFMUState(other.fmu.deserializeFMUState(data))
    other.time = host.time
    for one in (host, other):
        one.event()
        walk(one)
    for name in ("root.angle", "stored_energy", "HL.latch_time"):
        assert host[name] == other[name]


def test_commands_act_in_event_mode(path):
    host = Host3(path)
    assert walk(host, 0.3) == []
    host.event(**{"HL.latch_command": 1.0})
    assert host["HL.latched"] == 1.0
    assert host["HL.latch_time"] == pytest.approx(0.3, rel=SAME)
    angle = host["root.angle"]
    assert walk(host, 0.6) == []
    assert host["root.angle"] == pytest.approx(angle, abs=0.05)


def test_events_of_the_scene_end_steps_too(tmp_path):
    event = {"name": "faster", "time": "0.31 s", "set": {"root": {"motor_constant_torque": "16 N.m"}}}
    host = Host3(exported(latching([event]), tmp_path))
    first, second = walk(host)
    assert first == pytest.approx(0.31, rel=SAME)
    assert second == host["HL.latch_time"]


def test_the_plain_command_of_fmpy_with_events(path, latch_time):
    """Rows before and after the event at the same time."""
    rows = fmpy.simulate_fmu(
        str(path),
        stop_time=UNTIL,
        output_interval=0.1,
        output=["HL.latched", "root.angle"],
        use_event_mode=True,
        early_return_allowed=True,
    )
    (twice,) = np.flatnonzero(np.diff(rows["time"]) == 0.0)
    assert rows["time"][twice] == pytest.approx(latch_time, rel=SAME)
    assert rows["HL.latched"][twice : twice + 2].tolist() == [0.0, 1.0]
    assert len(rows) == 15 + 1 + 2


def test_only_what_has_events_declares_that_it_returns_early(path, tmp_path):
    """Event mode is for commands as well, here of the motor's failure."""
    interface = Host3(path).interface
    assert interface.hasEventMode
    assert interface.mightReturnEarlyFromDoStep
    assert not interface.canReturnEarlyAfterIntermediateUpdate
    tree = latching().tree
    del tree["hinge_line"][0]["latch"]
    (still,) = fanfold.export(fanfold.Scene.of_tree("free.toml", tree), tmp_path, as_one=True, fmi="3.0")
    interface = fmpy.read_model_description(str(still)).coSimulation
    assert interface.hasEventMode
    assert not interface.mightReturnEarlyFromDoStep


def test_a_driven_base_keeps_its_course_through_an_early_return(tmp_path):
    """What the return costs is less than what half the step size gains: drives go on over steps that differ."""
    path = exported(latching(), tmp_path, driven_base=True)

    def driven(step, *, early):
        host = Host3(path, early=early)
        while host.time < 1.2 - SAME:
            host.fmu.setFloat64(
                [host.reference("base.angular_velocity")], [0.0, 0.2 * np.sin(4.0 * host.time), 0.0]
            )
            host.fmu.setFloat64(
                [host.reference("base.angular_acceleration")], [0.0, 0.8 * np.cos(4.0 * host.time), 0.0]
            )
            if host.step(min(step, 1.2 - host.time))[0]:
                host.event()
        return host["HL.latch_time"], host["root.angle"]

    returning, plain, fine = driven(0.02, early=True), driven(0.02, early=False), driven(0.01, early=False)
    assert abs(returning[0] - plain[0]) < abs(fine[0] - plain[0])
    assert abs(returning[1] - plain[1]) < abs(fine[1] - plain[1])
