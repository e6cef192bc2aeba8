"""Run in a process of its own: native FMUs integrated by solvers outside, one JSON object of findings.

    python exchange_runs.py FOLDER

FMUs are written to the folder. A finding is an empty string where all is well.
"""

from __future__ import annotations

import json
import sys
from ctypes import byref, c_double
from math import tan

import numpy as np
from fmpy import simulate_fmu
from fmpy.fmi2 import fmi2EventInfo
from scipy.spatial.transform import Rotation

from components.body import Body
from components.drive import Drive
from components.flexible.modal import ModalData
from components.hinge import Hinge
from components.load import Load
from components.moving_base import MovingBase
from components.point_motion import PointMotion
from fmus import build_fmu
from tests.conformance.programs.driver import OK, Fmu
from tests.conformance.programs.exchange import Model
from tests.conformance.programs.findings import finding
from tests.references.free_rotor import free_rotor

MOTION = ("position", "orientation", "velocity", "angular_velocity")


def integrated(path, **settings):
    """Columns by name of a run with CVode."""
    return simulate_fmu(str(path), fmi_type="ModelExchange", solver="CVode", validate=False, **settings)


def table(result, names):
    return np.array([result[name] for name in names]).T


def run_free_rotor(folder):
    """A free asymmetric rotor against its closed form; both momenta are constant to round-off."""
    inertia, start = np.array([1.0, 2.0, 3.0]), np.array([1.0, 0.01, 1.0])
    data = ModalData.rigid(2.0, (0.0, 0.0, 0.0), np.diag(inertia), {"center": (0.0, 0.0, 0.0)})
    body = Body(modal=data.to_arrays(), ports=[{"name": "center", "point": "center"}])
    path = build_fmu(body, "rotor", folder, start={"initial_angular_velocity": start})
    names = [name for q in body.output_layout.quantities for name in q.scalar_names()]
    momenta = [f"angular_momentum[{i}]" for i in (1, 2, 3)]
    result = integrated(
        path, stop_time=10.0, output_interval=0.1, relative_tolerance=1e-12, output=[*names, *momenta]
    )
    motion, rotor = table(result, names), free_rotor(inertia, start)
    turned = Rotation.from_quat(np.roll(motion[:, 3:7], -1, axis=1))
    found = turned.inv().apply(motion[:, 10:13])
    exact = np.array([rotor.angular_velocity(t) for t in result["time"]])
    assert np.abs(found - exact).max() < 1e-8, f"angular velocity is off by {np.abs(found - exact).max():g}"
    assert np.abs(np.linalg.norm(motion[:, 3:7], axis=1) - 1.0).max() < 1e-14, (
        "an orientation is not of unit length"
    )
    change = np.abs(table(result, momenta) - table(result, momenta)[0]).max()
    assert change < 1e-14, f"momentum changes by {change:g}"


WRENCH = {
    "inboard.force": (3.0, -2.0, 1.0),
    "inboard.torque": (0.2, 0.4, -0.3),
    "outboard.force": (-2.5, 1.5, 1.2),
    "outboard.torque": (-0.4, 0.2, 0.2),
}


def stepped(path, references, h, end):
    """Values after co-simulation steps of one size under the start values of the inputs."""
    fmu = Fmu(path)
    assert fmu.start() == OK, fmu.log
    for k in range(round(end / h)):
        assert fmu.step(k * h, h) == OK, fmu.log
    return fmu.get(references[0], len(references))


def run_flexible_body(folder):
    """A tumbling flexible body under held wrenches against small co-simulation steps, extrapolated; its energies."""
    body, end = Body.example(), 0.5
    start = {**WRENCH, "initial_angular_velocity": (1.0, -2.0, 1.5), "gravity": (0.0, 0.0, -1.6)}
    path = str(build_fmu(body, "flexible", folder, start=start))
    layouts = body.layouts
    names = [name for layout in layouts[2:] for name in layout.scalar_names()]
    first = layouts[0].size + layouts[1].size
    references = range(first, first + len(names))
    result = integrated(path, stop_time=end, output_interval=0.01, relative_tolerance=1e-10, output=names)
    found = table(result, names)[-1]
    coarse, fine = (stepped(path, references, h, end) for h in (5e-4, 2.5e-4))
    exact, place = (4.0 * fine - coarse) / 3.0, 0
    for quantity in (q for layout in layouts[2:] for q in layout.quantities):
        part = slice(place, place + quantity.size)
        place += quantity.size
        error = np.abs(found[part] - exact[part]).max()
        assert error < 1e-8 * max(np.abs(exact[part]).max(), 0.1), f"{quantity.name} is off by {error:g}"
    heat = result["dissipated_energy"]
    assert heat[-1] > 1e-3, "nothing is dissipated"
    assert np.all(np.diff(heat) >= 0.0), "heat returns"


LATCH_ANGLE, STIFFNESS = 0.47, 80.0


def opening(path):
    """A hinge FMU whose outboard port turns about y; linear between samples."""
    times = np.linspace(0.0, 1.0, 11)
    names = ["outboard.orientation[1]", "outboard.orientation[3]", "outboard.angular_velocity[2]"]
    signals = np.zeros(times.size, dtype=[("time", float), *((name, float) for name in names)])
    signals["time"], signals[names[0]], signals[names[1]] = times, np.cos(0.5 * times), np.sin(0.5 * times)
    signals[names[2]] = 1.0
    k = int(LATCH_ANGLE / 0.1)
    (w0, w1), (y0, y1) = (signals[name][k : k + 2] for name in names[:2])
    share = (y0 - w0 * tan(0.5 * LATCH_ANGLE)) / (tan(0.5 * LATCH_ANGLE) * (w1 - w0) - (y1 - y0))
    return signals, times[k] + share * 0.1


def run_latching_hinge(folder):
    """A hinge driven by signals latches at the instant its angle says, and resists from the latch angle on."""
    hinge = Hinge(latch="spring", wrench_mode="endpoint")
    start = {"latch_angle": LATCH_ANGLE, "latch_stiffness": STIFFNESS, "latch_damping": 3.0}
    path = build_fmu(hinge, "opening", folder, start=start)
    signals, expected = opening(path)
    names = ["latched", "angle", "outboard.torque[2]", "latch_energy", "latch_distance"]
    settings = {"stop_time": 1.0, "output_interval": 0.02, "relative_tolerance": 1e-8}
    result = integrated(path, **settings, input=signals, output=names, record_events=True)
    latched = result["latched"] > 0.5
    before, after = result["time"][~latched], result["time"][latched]
    assert before.max() == after.min(), "no event was recorded"
    assert abs(after.min() - expected) < 1e-12, f"latched {after.min() - expected:g} s late"
    angle = result["angle"][latched]
    torque = -STIFFNESS * (angle - LATCH_ANGLE) - 3.0
    assert np.abs(result["outboard.torque[2]"][latched] - torque).max() < 1e-9
    assert np.abs(result["outboard.torque[2]"][~latched]).max() == 0.0
    heat = 3.0 * (1.0 - expected)
    assert abs(result["latch_energy"][-1] - heat) < 1e-7, (
        f"heat {result['latch_energy'][-1]:g} is not {heat:g}"
    )


def run_turns(folder):
    """The angle of a hinge that turns several times, and one that a solver tries far ahead and takes back."""
    hinge = Hinge(latch="none", wrench_mode="endpoint")
    path = str(build_fmu(hinge, "turning", folder))
    fmu, place = Model(path, hinge), hinge.layouts
    orientation = place[0].size + place[1]["outboard.orientation"].start
    angle = sum(layout.size for layout in place[:3])
    fmu.start()
    assert fmu.call("enterContinuousTimeMode") == OK

    def turn(a):
        fmu.set(orientation, [np.cos(0.5 * a), 0.0, np.sin(0.5 * a), 0.0])
        return fmu.get(angle, 1)[0]

    for k in range(200):
        assert abs(turn(0.1 * k) - 0.1 * k) < 1e-12
        assert abs(turn(0.1 * k - 3.0) - (0.1 * k - 3.0)) < 1e-12
        turn(0.1 * k)
        assert fmu.call("completedIntegratorStep") == OK


def run_short_pulse(folder):
    """A load of 100 N for 20 ms, far apart from all else, on a port that moves evenly: its work is in closed form.

    Regression: breaks of laws were no events, and solvers stepped over it.
    """
    rise = [
        {"profile": "ramp", "start": at, "duration": 1e-3, "change": change}
        for at, change in ((3.003, 100.0), (3.023, -100.0))
    ]
    load = Load(force=rise, wrench_mode="endpoint")
    path = build_fmu(load, "pulse", folder, start={"body.velocity": (0.0, 0.0, 0.1)})
    settings = {"stop_time": 8.0, "output_interval": 8.0, "relative_tolerance": 1e-9}
    found = integrated(path, output=["supplied_energy"], **settings)
    work = found["supplied_energy"][-1]
    assert abs(work - 100.0 * 0.02 * 0.1) < 1e-6, f"the work is {work:g} J"


def run_breaks_are_events(folder):
    """Next event times of laws in order; none where they have come to their ends."""
    ramp = {"profile": "ramp", "start": 0.5, "duration": 0.25, "change": 1.0}
    shift, turn = [ramp], [{**ramp, "start": 1.5}]
    base = MovingBase([{"name": "hinge", "position": (0.0, 0.0, 0.0)}], shift, turn)
    drive = Drive(profile="step", wrench_mode="endpoint")
    motion = PointMotion(law=shift, wrench_mode="endpoint")
    for name, component, start, expected in (
        ("moved", base, {}, [0.5, 0.75, 1.5, 1.75]),
        ("driven", drive, {"start_time": 0.5, "duration": 0.75}, [0.5, 1.25]),
        ("pulled", motion, {}, [0.5, 0.75]),
    ):
        fmu = Model(str(build_fmu(component, name, folder, start=start)), component)
        fmu.start()
        clock, times = component.state_layout["clock"].start, []
        place = list(component.continuous.places).index(clock)
        info = fmi2EventInfo()
        for _ in range(len(expected) + 1):
            assert fmu.slave.fmi2NewDiscreteStates(fmu.slave.component, byref(info)) == OK
            times += [info.nextEventTime] if info.nextEventTimeDefined else []
            assert fmu.call("enterContinuousTimeMode") == OK
            assert fmu.call("setTime", info.nextEventTime) == OK
            states = fmu.states()
            states[place] = info.nextEventTime
            assert fmu.call("setContinuousStates", (c_double * fmu.nx)(*states), fmu.nx) == OK
            assert fmu.call("enterEventMode") == OK
        assert np.allclose(times, expected, atol=1e-12), f"{name}: events at {times}"


RUNS = {
    name.removeprefix("run_"): function for name, function in globals().items() if name.startswith("run_")
}


if __name__ == "__main__":
    print("\n" + json.dumps({name: finding(run, sys.argv[1]) for name, run in RUNS.items()}))
