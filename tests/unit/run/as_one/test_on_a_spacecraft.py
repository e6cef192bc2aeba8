"""A wing as one FMU on a free spacecraft in a scene of ours, against the same wing and spacecraft as one scene."""

from __future__ import annotations

import zipfile
from contextlib import suppress

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

import orchestrator as fanfold
from fmus import native_library
from tests.unit.run.as_one.host import Host, latching

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
FREE = {"mass": "500 kg", "center_of_mass": [-1.0, 0.0, 0.0], "inertia": [400.0, 400.0, 400.0]}
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


HELD = {"force": "interface_force", "torque": "interface_torque"}


def mounted(wing, step, told=("HL.latch_time",)):
    """The spacecraft with the wing's loads as loads of its own, in its axes; its rates drive the wing's base."""
    base = {"points": {"root": [0.0, 0.0, 0.0]}, "free": FREE}
    loads = [
        {
            "name": f"wing_{axis}",
            "kind": "load",
            "ports": {"body": {"body": "base", "point": "root"}},
            "structure": {"direction": direction, "frame": "body"},
        }
        for axis, direction in AXES.items()
    ]
    inputs = {
        f"base.{rate}[{i}]": f"base.wing_x.{rate}[{i}]"
        for rate in ("velocity", "angular_velocity")
        for i in (1, 2, 3)
    }
    outputs = {
        f"base.{given}[{i}]": f"wing_{axis}.added_{kind}"
        for kind, given in HELD.items()
        for i, axis in enumerate(AXES, 1)
    }
    fmu = {
        "name": "wing",
        "file": str(wing),
        "step": step,
        "inputs": inputs,
        "outputs": {**outputs, **{name: [] for name in told}},
    }
    tree = {"scene": {"name": "mounted", "until": 1.2}, "base": base, "connection": loads, "fmu": [fmu]}
    return fanfold.Scene.of_tree("mounted.toml", tree)


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_a_driven_wing_starts_by_itself(tmp_path, fmi):
    """FMI 2.0, 2.2.8: no input acts on what is read at the start, so that a tool has no loop to solve there."""
    (path,) = fanfold.export(latching(), tmp_path, as_one=True, driven_base=True, fmi=fmi)
    for unknown in read_model_description(str(path)).initialUnknowns:
        assert {known.causality for known in unknown.dependencies} == {"parameter"}
    if fmi == "2.0":
        host = Host(path)
        host.fmu.setupExperiment(startTime=0.0)
        host.fmu.enterInitializationMode()
        before = host.all()
        host["base.acceleration[3]"], host["HL.latch_command"] = 2.0, 1.0
        assert np.array_equal(host.all(), before)


def test_a_wing_turns_its_spacecraft(tmp_path):
    """Loads are held over a step: the attitude is of first order in it, and the panel latches when it does."""
    tree = latching().tree
    tree["base"]["free"] = FREE
    whole = fanfold.simulate(fanfold.Scene.of_tree("whole.toml", tree), until=1.2, estimate=False)
    latch_time = whole.latch_times["HL"]
    (wing,) = fanfold.export(latching(), tmp_path, as_one=True, driven_base=True)

    def errors(step):
        run = fanfold.simulate(mounted(wing, step), estimate=False)
        before = latch_time - 0.1
        angles = [np.interp(before, r.time, r.signal("base", "attitude")[:, 1]) for r in (run, whole)]
        return abs(angles[0] / angles[1] - 1.0), abs(
            run.signal("wing", "HL.latch_time")[-1] / latch_time - 1.0
        )

    (coarse, later), (fine, latched) = errors("10 ms"), errors("5 ms")
    assert later < 5e-4
    assert 0.4 < latched / later < 0.6
    assert 0.4 < fine / coarse < 0.6


@pytest.fixture(scope="module")
def wing(tmp_path_factory):
    (path,) = fanfold.export(latching(), tmp_path_factory.mktemp("wing"), as_one=True, driven_base=True)
    return path


def ridden(wing, mass, steps=150, step=5e-3):
    """Everything that the wing says on a point mass (kg) that moves along z under the load of a step's start."""
    host, rate = Host(wing).start(), 0.0
    with suppress(FMICallException):
        for _ in range(steps):
            acceleration = host["base.interface_force[3]"] / mass
            host["base.velocity[3]"], host["base.acceleration[3]"] = rate, acceleration
            host.to(host.time + step, step)
            rate += step * acceleration
    return host.said


def test_a_host_that_is_unstable_is_warned_once(wing):
    """Closed form: a held load of a wing with r times the mass of its host is unstable from r = 1/3 on.

    Accelerations are extrapolated over a step, so growth factors are the roots of z^2 + 2 r z - r = 0. Of the wing's
    8 kg, 2 to 8 resist.
    """
    assert not ridden(wing, 100.0)
    (said,) = ridden(wing, 12.0, steps=80)
    assert "host is unstable" in said


def test_that_loads_are_held_is_a_warning(wing):
    with pytest.warns(fanfold.FanfoldWarning, match="W-fmu-wing"):
        fanfold.simulate(mounted(wing, "5 ms"), until=0.02, estimate=False)


def test_an_fmu_that_makes_no_steps_is_refused(wing, tmp_path):
    """An FMU for scheduled execution is neither stepped nor integrated."""
    with zipfile.ZipFile(wing) as archive, zipfile.ZipFile(tmp_path / "other.fmu", "w") as other:
        for name in archive.namelist():
            other.writestr(name, archive.read(name).replace(b"<CoSimulation", b"<ScheduledExecution"))
    with pytest.raises(fanfold.FanfoldError, match="neither co-simulation nor model exchange"):
        fanfold.simulate(mounted(tmp_path / "other.fmu", "5 ms"), estimate=False)


def test_a_wing_is_told_the_tolerance_of_its_scene(wing):
    """Definition: an FMU's tolerance is that of the experiment. At 1e-6 it makes more steps than at 1e-2."""

    def steps(tolerance):
        scene = mounted(wing, "100 ms", told=("steps",))
        return fanfold.simulate(scene, tolerance=tolerance, until=0.5, estimate=False)["wing", "steps"][-1]

    assert steps(1e-6) > 1.5 * steps(1e-2)


@pytest.mark.parametrize("step", ["1 ms", "10 ms", "100 ms"])
def test_a_wing_beside_a_scene_is_the_wing_at_any_step(tmp_path, step):
    """Against its own run: it steps as its own tolerance asks, whatever the scene that hosts it does."""
    expected = fanfold.simulate(latching(), estimate=False).headline
    (wing,) = fanfold.export(latching(), tmp_path, as_one=True)
    block = {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": [1, 1, 1], "points": {"p": [0, 0, 0]}}
    scene = fanfold.Scene("host", until="2 s")
    scene.base("ground", points={"p": (0, 0, 0)})
    scene.body("block", rigid=block, place={"body": "ground", "point": "p"})
    ports = {"inboard": ("ground", "p"), "outboard": ("block", "p")}
    scene.connection("clamp", preset="fixed", ports=ports)
    told = {"HL.latch_time": [], "HL.latch_torque_peak": []}
    tree = scene.tree | {"fmu": [{"name": "wing", "file": str(wing), "step": step, "outputs": told}]}
    found = fanfold.simulate(fanfold.Scene.of_tree("host.toml", tree), estimate=False)
    assert found["wing", "HL.latch_time"][-1] == pytest.approx(expected.latch_times["HL"], rel=1e-8)
    peak = expected.latch_torque_peaks["HL"]
    assert found["wing", "HL.latch_torque_peak"][-1] == pytest.approx(peak, rel=1e-4)
