"""The sequence of the master in Python and that of a scene as one FMU: the same rows and latch-ups, in every bit.

Both have the same steps made by the same C, so that a difference is one of what happens when.
"""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

import orchestrator as fanfold
from fmus import native_library
from tests.references.coupled_wing import coupled_wing
from tests.unit.cosim.events.test_contact_onset import HEAVY_AND_LIGHT
from tests.unit.cosim.events.test_unlatching import door
from tests.unit.cosim.test_at_one_instant import twins
from tests.unit.run.as_one.host import STACK, Host

pytestmark = [
    pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native"),
    pytest.mark.filterwarnings("ignore::orchestrator.FanfoldWarning"),  # of runs that end early
]

EVENTS = [
    {
        "name": "motor_fails",
        "when": {"component": "HL", "variable": "angle", "above": "100 deg"},
        "set": {"HL": {"motor_stiffness": 0}},
    },
    {"name": "brake", "time": "1.2345 s", "set": {"HL": {"friction_preload": "0.3 N.m"}}},
]
"""Of the workbench: a condition on an observation, and an instant."""
AT_END = 3
"""Rows at the end of a run, whose steps are made to fit it."""


def workbench(latch, **scene):
    found = fanfold.load("workbench", (), {"hinge_line.HL.latch.kind": latch})
    tree = found.tree
    return fanfold.Scene.of_tree(
        "workbench.toml", {**tree, "scene": {**tree["scene"], **scene}, "event": EVENTS}
    )


def spinning():
    """The workbench's panel, already opening, on a spacecraft that spins and drifts."""
    tree = fanfold.load("workbench").tree
    free = {"mass": 500.0, "inertia": [200.0] * 3, "velocity": [0.1, 0, 0], "angular_velocity": [0.1, 0, 0.2]}
    lines = [{**line, "start_rate": 0.1} for line in tree["hinge_line"]]
    scene = {**tree["scene"], "preload": False}
    changed = {**tree, "scene": scene, "base": {**tree["base"], "free": free}, "hinge_line": lines}
    return fanfold.Scene.of_tree("spinning.toml", changed)


def restowed():
    """The flexible workbench near its latch, which lets go again and engages once more."""
    found = fanfold.load("workbench", (), {"hinge_line.HL.latch.kind": "kinematic", "scene.preload": False})
    tree = found.tree
    lines = [{**line, "start_angle": "179.9 deg", "start_rate": 1.0} for line in tree["hinge_line"]]
    events = [
        {
            "name": "opens",
            "time": 0.05,
            "set": {"HL": {"unlatch_command": 1, "motor_constant_torque": -200.0}},
        },
        {"name": "ready", "time": 0.1, "set": {"HL": {"unlatch_command": 0, "motor_constant_torque": 200.0}}},
    ]
    return fanfold.Scene.of_tree("restowed.toml", {**tree, "hinge_line": lines, "event": events})


SCENES = {
    "workbench, spring, events": (lambda: workbench("spring", tolerance=1e-3), 5.0, "all", 3),
    "workbench, kinematic, events": (lambda: workbench("kinematic"), 5.0, "all", 3),
    "workbench, flexible": (lambda: fanfold.load("workbench"), 0.3, (), 0),
    "amos3": (lambda: fanfold.load("amos3"), 12.0, "all", 3),
    "amos3, spring latches": (lambda: fanfold.load("amos3", "spring_latch"), 9.0, "all", 2),
    "amos3, flexible": (lambda: fanfold.load("amos3"), 0.2, (), 0),
    "coupler, flexible": (lambda: coupled_wing(0.1, stiffness=2e5), 0.1, (), 0),
    "bepicolombo": (lambda: fanfold.load("bepicolombo"), 2.0, "all", 0),
    "antenna-unit": (lambda: fanfold.load("antenna-unit"), 0.03, "all", 0),
    "twins, spring": (lambda: twins("spring"), 2.5, "all", 2),
    "twins, kinematic": (lambda: twins("kinematic"), 2.5, "all", 2),
    "light body that strikes": (
        lambda: fanfold.Scene.of_tree("light.toml", tomllib.loads(HEAVY_AND_LIGHT)),
        4.0,
        "all",
        0,
    ),
    "spinning spacecraft, flexible": (spinning, 0.2, (), 0),
    "unlatched, spring": (door, 7.0, "all", 5),
    "unlatched, kinematic, flexible": (restowed, 0.2, (), 5),
    "hold-downs, snubbers": (lambda: fanfold.load(STACK), 5.3, "all", 2),
}
"""A scene, its end (s), its rigid bodies, and how many events and latch-ups there are."""


def columns(result, names):
    """Those of outputs by name that are recorded signals, a row each (rows, outputs)."""
    found = {}
    for name in names:
        signal, _, number = name.partition("[")
        component, _, variable = signal.rpartition(".")
        component = component or "scene"
        if component in result.components and variable in result.variables(component):
            values = np.asarray(result.signal(component, variable))
            found[name] = values[:, int(number[:-1]) - 1] if number else values
    return list(found), np.array(list(found.values())).T


@pytest.mark.parametrize("name", SCENES)
def test_rows_and_latch_ups(name, tmp_path):
    """At the time of every row the FMU gives that row, the first of several at one time."""
    make, until, rigid, count = SCENES[name]
    result = fanfold.simulate(make(), until=until, rigid=rigid, estimate=False)
    assert len(result.events) == count
    (path,) = fanfold.export(make(), tmp_path, rigid=rigid, as_one=True)
    host = Host(path).start()
    names, expected = columns(result, host.outputs)
    assert len(names) > 50
    assert all(host[f"{line}.latch_rate"] == 0.0 for line in result.latch_times)
    found = [host.read(names)]
    times = np.asarray(result.time)
    kept = np.flatnonzero(np.diff(times, prepend=-1.0) > 0.0)[:-AT_END]
    for time in times[kept[1:]]:
        host.to(time, time - host.time)
        found.append(host.read(names))
    assert host["rejected_steps"] == result.costs["rejected_steps"]
    np.testing.assert_array_equal(np.array(found), expected[kept])
    for line, time in result.latch_times.items():
        again = result.headline.unlatchings.get(line)
        assert host[f"{line}.latch_time"] == (time if again is None else again.again)
        assert again is not None or host[f"{line}.latch_rate"] == result.headline.latch_rates[line]
