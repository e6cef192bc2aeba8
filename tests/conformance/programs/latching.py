"""Run in a process of its own: a hinge in end-point mode that latches by itself, driven with event mode.

    python latching.py PATH

The outboard port turns about the hinge line as prescribed; one JSON object of findings. The FMU must be built
as `hinge()` says.
"""

from __future__ import annotations

import json
import sys

import numpy as np
from fmpy import simulate_fmu

from components import REGISTRY
from tests.conformance.programs.driver import OK
from tests.conformance.programs.driver3 import Fmu3
from tests.conformance.programs.findings import checks_of, finding

H = 0.01
LATCH = 0.237
RATE = 0.8
STIFFNESS, DAMPING = 500.0, 3.0
START = {"latch_angle": LATCH, "latch_stiffness": STIFFNESS, "latch_damping": DAMPING, "motor_stiffness": 2.0}


def hinge():
    return REGISTRY["hinge"](axis=(0.0, 0.0, 1.0), latch="spring", wrench_mode="endpoint")


def turn(fmu, angle, rate):
    fmu.put("outboard.orientation", np.cos(0.5 * angle), 0.0, 0.0, np.sin(0.5 * angle))
    fmu.put("outboard.angular_velocity", 0.0, 0.0, rate)


def begun(path, event_mode=True, early_return=True, angle=0.0):
    fmu = Fmu3(path, event_mode=event_mode, early_return=early_return)
    turn(fmu, angle, RATE)
    assert fmu.start() == OK
    if event_mode:
        handle(fmu)
    return fmu


def handle(fmu):
    fmu.slave.updateDiscreteStates()
    fmu.slave.enterStepMode()


def follow(fmu, angle=lambda t: RATE * t, rate=lambda t: RATE):
    """Steps until an event is reported: its time, the size of the step asked for, and whether it was cut."""
    time = 0.0
    while time < 1.0:
        turn(fmu, angle(time), rate(time))
        event, terminate, early, reached = fmu.slave.doStep(time, H)
        assert not terminate
        assert early == (reached < time + H)
        if event:
            return time, reached, early
        assert reached == time + H
        time = reached
    return time, time, False


def check_return_at_latch_up(path):
    """The step ends where the angle at its start and the rate say, and the latch engages in event mode."""
    fmu = begun(path)
    _, reached, early = follow(fmu)
    assert early
    assert abs(reached - LATCH / RATE) < 1e-12
    assert fmu.value("time") == reached
    assert fmu.value("latched") == 0.0
    fmu.slave.enterEventMode()
    turn(fmu, RATE * reached, RATE)
    assert fmu.slave.updateDiscreteStates() == (False, False, False, False, False, 0.0)
    assert fmu.value("latched") == 1.0
    assert abs(fmu.value("latch_torque") + DAMPING * RATE) < 1e-9
    fmu.slave.enterStepMode()
    time, angle = reached, LATCH + 0.01
    turn(fmu, angle, 0.0)
    assert fmu.slave.doStep(time, H) == (False, False, False, time + H)
    assert abs(fmu.value("latch_torque") + STIFFNESS * (angle - LATCH)) < 1e-9


def check_late_prediction(path):
    """Where the rate grows, the prediction is late and the next step starts behind the latch angle."""
    fmu = begun(path)
    time, reached, early = follow(fmu, lambda t: 4.0 * t * t, lambda t: 8.0 * t)
    assert early
    assert time < reached < time + H
    assert abs(reached - np.sqrt(LATCH / 4.0)) < H
    fmu.slave.enterEventMode()
    handle(fmu)
    turn(fmu, LATCH + 0.01, 0.0)
    assert abs(fmu.value("latch_torque") + STIFFNESS * 0.01) < 1e-9


def check_behind_latch_angle(path):
    """An event that is due already is met after a small part of the step."""
    fmu = begun(path, angle=0.0)
    turn(fmu, LATCH + 0.001, RATE)
    event, _, early, reached = fmu.slave.doStep(0.0, H)
    assert (event, early) == (True, True)
    assert 0.0 < reached <= 0.02 * H
    fmu.slave.enterEventMode()
    handle(fmu)
    assert fmu.value("latched") == 1.0


def check_without_early_return(path):
    """Where the host does not allow it, the step goes to its end and the event is reported there."""
    fmu = begun(path, early_return=False)
    time, reached, early = follow(fmu)
    assert not early
    assert time < LATCH / RATE <= reached
    fmu.slave.enterEventMode()
    handle(fmu)
    turn(fmu, LATCH + 0.01, 0.0)
    assert fmu.value("latched") == 1.0
    assert abs(fmu.value("latch_torque") + STIFFNESS * 0.01) < 1e-9


def check_without_event_mode(path):
    """As with FMI 2.0: no event is reported, the latch engages within a step."""
    fmu = begun(path, event_mode=False, early_return=True)
    time, _, early = follow(fmu)
    assert (time >= 1.0, early) == (True, False)
    assert fmu.value("latched") == 1.0


def check_command(path):
    """A latch command given in event mode acts there."""
    fmu = begun(path)
    fmu.slave.enterEventMode()
    fmu.put("latch_command", 1.0)
    handle(fmu)
    assert fmu.value("latched") == 1.0
    assert follow(fmu)[2] is False


def check_states_within_events(path):
    """An event that waits, and event mode itself, are part of the state, also as bytes."""
    fmu = begun(path)
    _, reached, _ = follow(fmu)
    waiting = fmu.slave.serializeFMUState(fmu.slave.getFMUState())
    fmu.slave.enterEventMode()
    entered = fmu.slave.serializeFMUState(fmu.slave.getFMUState())
    handle(fmu)
    torque = fmu.value("latch_torque")
    for data in (waiting, entered):
        other = begun(path)
        other.slave.setFMUState(other.slave.deserializeFMUState(data))
        assert other.value("time") == reached
        assert other.value("latched") == 0.0
        if data is waiting:
            other.slave.enterEventMode()
        handle(other)
        assert other.value("latched") == 1.0
        assert other.value("latch_torque") == torque


def check_fmpys_simulation(path):
    """FMPy's own master with event mode and early return meets the event in time."""
    t = np.linspace(0.0, 0.5, 2001)
    half = 0.5 * RATE * t
    turned = np.stack([np.cos(half), 0 * t, 0 * t, np.sin(half)], axis=1)
    layout = np.dtype([("time", float), ("outboard.orientation", float, 4)])
    signals = np.array(list(zip(t, turned, strict=True)), dtype=layout)
    result = simulate_fmu(
        path,
        stop_time=0.5,
        output_interval=H,
        start_values={"outboard.angular_velocity": [0.0, 0.0, RATE]},
        input=signals,
        use_event_mode=True,
        early_return_allowed=True,
        output=["latched", "angle", "inboard.torque"],
    )
    first = result[result["latched"] > 0.5][0]
    assert abs(first["time"] - LATCH / RATE) < 1e-6
    assert result["inboard.torque"].shape[1:] == (3,)


CHECKS = checks_of(globals())

if __name__ == "__main__":
    print("\n" + json.dumps({name: finding(check, sys.argv[1]) for name, check in CHECKS.items()}))
