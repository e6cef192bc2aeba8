"""A wing as one FMU on a free spacecraft in a scene of ours, against the same wing and spacecraft as one scene."""

from __future__ import annotations

import numpy as np
import pytest
from fmpy import read_model_description

import orchestrator as fanfold
from fmus import native_library
from tests.unit.run.as_one.host import Host, latching

pytestmark = pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
FREE = {"mass": "500 kg", "center_of_mass": [-1.0, 0.0, 0.0], "inertia": [400.0, 400.0, 400.0]}
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


LIGHT = {"mass": "5 kg", "center_of_mass": [-0.1, 0.0, 0.0], "inertia": [4.0, 4.0, 4.0]}
HELD = {"force": "interface_force", "torque": "interface_torque"}
ITERATED = {"force": "interface_impulse", "torque": "interface_angular_impulse"}


def mounted(wing, step, free=FREE, told=("HL.latch_time",), *, iterated=False):
    """The spacecraft with the wing's loads as loads of its own, in its axes; its rates drive the wing's base."""
    base = {"points": {"root": [0.0, 0.0, 0.0]}, "free": free}
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
        for kind, given in (ITERATED if iterated else HELD).items()
        for i, axis in enumerate(AXES, 1)
    }
    fmu = {
        "name": "wing",
        "file": str(wing),
        "step": step,
        "inputs": inputs,
        "outputs": {**outputs, **{name: [] for name in told}},
        **({"iterated": True, "parameters": {"base_meets_rates": 1}} if iterated else {}),
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

    (coarse, _), (fine, latched) = errors("10 ms"), errors("5 ms")
    assert latched < 1e-4
    assert 0.4 < fine / coarse < 0.6


def opening(kind="spring"):
    """The wing with a latch whose damping does not hang on what it is mounted on."""
    tree = latching().tree
    tree["hinge_line"][0]["latch"] |= {"kind": kind, "effective_inertia": "1 kg.m2"}
    return fanfold.Scene.of_tree("latching.toml", tree)


def on_light_spacecraft(kind="spring"):
    tree = opening(kind).tree
    tree["base"]["free"] = LIGHT
    return fanfold.Scene.of_tree("whole.toml", tree)


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_an_iterated_wing_is_the_wing_built_in(tmp_path, fmi):
    """A panel of 8 kg on 5 kg, where held loads blow up at once: latch time, peak and attitude of the whole scene."""
    whole = fanfold.simulate(on_light_spacecraft(), until=0.7, tolerance=1e-6, estimate=False)
    (wing,) = fanfold.export(opening(), tmp_path, as_one=True, driven_base=True, fmi=fmi)
    told = ("HL.latch_time", "HL.latch_torque_peak")
    run = fanfold.simulate(mounted(wing, "20 ms", LIGHT, told, iterated=True), until=0.7, estimate=False)
    assert run["wing", "HL.latch_time"][-1] == pytest.approx(whole.latch_times["HL"], rel=1e-6)
    peak = whole.headline.latch_torque_peaks["HL"]
    assert run["wing", "HL.latch_torque_peak"][-1] == pytest.approx(peak, rel=2e-4)
    exact = whole["base", "attitude"][:, 1]
    turned = np.interp(whole.time, run.time, run["base", "attitude"][:, 1])
    assert turned == pytest.approx(exact, abs=5e-4 * np.max(np.abs(exact)))


@pytest.mark.filterwarnings("ignore:latching.*W-export")
def test_an_iterated_wing_gives_the_impulse_of_its_lock(tmp_path):
    """A load of no length, in what the base's impulse grows by: the attitude is that of the whole scene, and stays."""
    whole = fanfold.simulate(on_light_spacecraft("kinematic"), until=0.52, tolerance=1e-6, estimate=False)
    (wing,) = fanfold.export(opening("kinematic"), tmp_path, as_one=True, driven_base=True)
    mounted_wing = mounted(wing, "5 ms", LIGHT, iterated=True)
    run = fanfold.simulate(mounted_wing, until=0.52, tolerance=1e-3, estimate=False)
    latch_time = whole.latch_times["HL"]
    assert run["wing", "HL.latch_time"][-1] == pytest.approx(latch_time, rel=2e-5)
    angles = np.interp([latch_time + 0.01, 0.52], run.time, run["base", "attitude"][:, 1])
    assert angles == pytest.approx([whole["base", "attitude"][-1, 1]] * 2, rel=1e-3)


@pytest.fixture(scope="module")
def wing(tmp_path_factory):
    (path,) = fanfold.export(opening(), tmp_path_factory.mktemp("wing"), as_one=True, driven_base=True)
    return path


def changed(wing, **keys):
    """An iterated wing whose table has other keys."""
    tree = mounted(wing, "5 ms", iterated=True).tree
    tree["fmu"][0] |= keys
    return fanfold.Scene.of_tree("mounted.toml", tree)


def locked(wing):
    """A panel of the scene's own beside it, with a kinematic latch."""
    tree = mounted(wing, "5 ms", iterated=True).tree
    own = opening("kinematic").tree
    return fanfold.Scene.of_tree(
        "mounted.toml", tree | {"body": own["body"], "hinge_line": own["hinge_line"]}
    )


MESSAGES = {
    "over a step.*W-fmu-wing": lambda wing: mounted(wing, "5 ms"),
    "lags.*W-fmu-wing": lambda wing: changed(wing, parameters={}),
    "kinematic.*W-fmu-wing": lambda wing: changed(
        wing, outputs={"base.interface_force[1]": "wing_x.added_force"}
    ),
    "HL.*W-fmu-wing": locked,
}


@pytest.mark.parametrize("words", MESSAGES)
def test_what_a_wing_does_not_get_is_told(wing, words):
    with pytest.warns(fanfold.FanfoldWarning, match=words):
        fanfold.simulate(MESSAGES[words](wing), until=0.02, estimate=False)


def test_a_fixed_step_beside_an_iterated_wing_is_refused(wing):
    """Regression: lateral loads of 0.3 N grew by half with every step of 10 ms, to 7 kN, and nothing was told."""
    with pytest.raises(fanfold.FanfoldError, match="needs step-size control"):
        fanfold.simulate(mounted(wing, "5 ms", iterated=True), step=0.005)


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
