"""Hold-down point: spring and preload, release by time and by command, energy, static phase."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from components.hold_down import HoldDown
from components.numerics.scheme import INSTANT
from fmus import build_fmu
from orchestrator.assembly import Part
from orchestrator.cosim.network import Network
from orchestrator.cosim.participant import in_process
from orchestrator.cosim.settings import Settings
from tests.conformance.programs.driver import OK
from tests.conformance.programs.driver3 import Fmu3
from tests.references.coupled import Tolerance, base, between, completed, mastered, prepared, rigid
from tests.references.native_fmus import needs_native
from tests.references.relative_motion import inputs, port_motion, work
from tests.unit.components.prepared import made
from tests.unit.cosim.signals.signal_cases import slave
from tests.unit.run.as_one.host import Host

MASS, STIFFNESS, PRELOAD = 5.0, 2e4, 300.0
TIGHT = Tolerance(1e-10, 1e-6, 1e-6)
SMALL = st.floats(-0.3, 0.3)
POINT = st.tuples(SMALL, SMALL, SMALL)


def scene(axis=(0.0, 0.0, 1.0), start=None, **change):
    """A body held by its centre of mass on a fixed base."""
    values = {"translational_stiffness": (STIFFNESS,) * 3, "preload": PRELOAD, **change}
    return (
        [
            base(point=(0, 0, 0)),
            rigid("body", MASS, (1.0, 1.0, 1.0), {"point": (0, 0, 0)}, **(start or {})),
            Part("bolt", "hold_down", {"axis": axis}, values),
        ],
        between("bolt", "base.point", "body.point"),
    )


def energy(run):
    total = run.signal("body", "kinetic_energy") + run.signal("body", "potential_energy")
    accounts = ("potential_energy", "dissipated_energy", "numerical_dissipation")
    return total + sum(run.signal("bolt", name) for name in accounts)


def place(run):
    """Place of the body, at the end."""
    return run.master.network.by_name["bolt"].inputs[13:16]


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (2.0, -1.0, 2.0)])
def test_the_preload_pulls_against_the_axis(axis):
    """Closed form: from rest, displacement -(P / k) (1 - cos w t) along the axis, w^2 = k / m, until 0.1 s.

    The mean force and its inertial terms shift frequencies by less than (w h)^2 / 4 of them, in phase w t times that.
    """
    h, w = 5e-4, np.sqrt(STIFFNESS / MASS)
    unit = np.array(axis) / np.linalg.norm(axis)
    run = completed(0.1, *scene(axis), settings=Settings(fixed_step=h), iteration=TIGHT)
    t, error = np.array(run.times), (w * h) ** 2 / 4 * w * 0.1 * PRELOAD
    assert run.signal("bolt", "force")[0] == pytest.approx(-PRELOAD * unit)
    force = -PRELOAD * np.cos(w * t)[:, None] * unit
    assert np.abs(run.signal("bolt", "force") - force).max() < error
    assert place(run) == pytest.approx(
        -PRELOAD / STIFFNESS * (1 - np.cos(w * 0.1)) * unit, abs=error / STIFFNESS
    )
    stored = 0.5 * PRELOAD**2 / STIFFNESS
    assert run.signal("bolt", "potential_energy")[0] == pytest.approx(stored)


@pytest.mark.parametrize("h", [0.05, 3e-3])
@pytest.mark.parametrize("damping", [0.0, 40.0])
def test_energy_balance_through_the_release(h, damping):
    """Conservation law: at any step size, also over the release, which turns what was stored to heat."""
    start = {"initial_velocity": (0.2, -0.4, 1.0)}
    change = {"release_time": 0.31, "translational_damping": (damping,) * 3}
    run = completed(0.6, *scene(start=start, **change), settings=Settings(fixed_step=h), iteration=TIGHT)
    total = energy(run)
    assert np.abs(total - total[0]).max() < 1e-6 * total[0]
    assert run.signal("bolt", "dissipated_energy")[-1] > 0.05


def test_release_at_the_end_of_the_step_that_reaches_the_time():
    """Definition: held until the end of that step, free from then on at the velocity of that instant."""
    h = 0.01
    for release_time, last in ((0.095, 10), (0.1, 10), (0.101, 11)):
        run = completed(
            0.2, *scene(release_time=release_time), settings=Settings(fixed_step=h), iteration=TIGHT
        )
        released = run.signal("bolt", "released")
        assert np.flatnonzero(released)[0] == last
        assert run.signal("bolt", "potential_energy")[last] == 0.0
        assert np.all(run.signal("bolt", "force")[:last, 2] != 0.0)
        assert np.all(run.signal("bolt", "force")[last:] == 0.0)
        assert np.all(run.signal("bolt", "dissipated_energy")[last:] > 0.0)
        kinetic = run.signal("body", "kinetic_energy")
        assert kinetic[last] != pytest.approx(kinetic[last - 1], rel=1e-3), (
            "the step to the release is not held"
        )
        assert kinetic[last:] == pytest.approx(kinetic[last], rel=1e-12)


def test_steps_end_at_the_release():
    """Regression: it came at the end of whatever step passed its time, and a line latched 80 tolerances late."""
    run = completed(0.2, *scene(release_time=0.0973), settings=Settings(1e-3), iteration=TIGHT)
    released = np.flatnonzero(run.signal("bolt", "released"))[0]
    assert run.times[released] == pytest.approx(0.0973, abs=1e-9)
    assert run.times[released] - run.times[released - 1] > 1e-4


@pytest.mark.parametrize("release_time", [0.05, 0.1])
def test_a_release_time_that_is_over_releases_at_once(release_time):
    """Regression: a time set in mid-run to what is past made a step of negative size."""
    run = prepared(*scene(release_time=1.0), settings=Settings(fixed_step=0.01))
    run.master.run(0.1)
    bolt = run.master.network.by_name["bolt"]
    bolt.set_parameter("release_time", [release_time])
    bolt.read()
    assert bolt.outputs[bolt.output_layout["time_to_break"]] == pytest.approx(INSTANT)
    run.master.run(0.2)
    assert run.signal("bolt", "released")[10:12].tolist() == [0.0, 1.0]


def test_release_by_command():
    """Definition: from the start of the next step there is no force, and what was stored is heat."""
    run = prepared(*scene(), settings=Settings(fixed_step=0.01))
    run.master.run(0.1)
    before = {name: run.signal("bolt", name)[-1] for name in ("potential_energy", "dissipated_energy")}
    bolt = run.master.network.by_name["bolt"]
    bolt.inputs[bolt.input_layout["release_command"]] = 1.0
    run.master.run(0.2)
    assert run.signal("bolt", "released")[10:12].tolist() == [0.0, 1.0]
    assert run.signal("bolt", "dissipated_energy")[11:] == pytest.approx(sum(before.values()))
    kinetic = run.signal("body", "kinetic_energy")
    assert kinetic[10:] == pytest.approx(kinetic[10], rel=1e-9)


def test_a_free_body_without_a_release_time_stays_held():
    """Definition: a release time of zero is none."""
    run = completed(0.5, *scene(), settings=Settings(fixed_step=0.01))
    assert np.all(run.signal("bolt", "released") == 0.0)


def test_the_clock_starts_with_the_scene():
    """Statics: what starts where spring and preload balance stays; the release comes 0.05 s after t = 0."""
    rest = {"initial_position": (0.0, 0.0, -PRELOAD / STIFFNESS)}
    parts, links = scene(start=rest, release_time=0.05)
    run = mastered(Network(in_process(parts), links), Settings(fixed_step=0.01))
    run.master.initialize(preload=True)
    assert place(run)[2] == pytest.approx(-PRELOAD / STIFFNESS, rel=1e-6)
    run.master.run(0.1)
    assert np.flatnonzero(run.signal("bolt", "released"))[0] == 5
    assert np.abs(run.signal("body", "kinetic_energy")).max() < 1e-9


def hold_down(mode="mean", axis=(0.0, 0.0, 1.0), **change):
    values = {
        "translational_stiffness": (1e3, 2e3, 3e3), "translational_damping": (10.0, 20.0, 30.0),
        "preload": 50.0, **change,
    }  # fmt: skip
    return made(HoldDown, mode, {"axis": axis}, **values)


@needs_native
def test_a_step_with_event_mode_ends_at_the_release(tmp_path):
    """Definition of FMI 3.0: early return where the event is, exact to round-off; there is no force from it on."""
    component = HoldDown(wrench_mode="endpoint")
    start = {"release_time": 0.0237, "preload": 50.0}
    path = str(build_fmu(component, "bolt", tmp_path, start=start, fmi="3.0"))
    fmu, events, time = Fmu3(path, event_mode=True, early_return=True), [], 0.0
    assert fmu.start() == OK
    fmu.slave.updateDiscreteStates()
    fmu.slave.enterStepMode()
    while time < 0.05:
        event, _, early, reached = fmu.slave.doStep(time, 0.01)
        if event:
            assert early
            events.append(reached)
            fmu.slave.enterEventMode()
            fmu.slave.updateDiscreteStates()
            fmu.slave.enterStepMode()
        time = reached
        force = 0.0 if events else -50.0
        assert fmu.value("outboard.force") == pytest.approx((0.0, 0.0, force))
    assert events == pytest.approx([0.0237], abs=1e-12)
    assert fmu.value("dissipated_energy") == pytest.approx(0.5 * 50.0**2 / 1e6)


@given(move=POINT, turn=SMALL, h=st.sampled_from((1e-3, 0.1)), command=st.sampled_from((0.0, 1.0)))
def test_work_is_energy(move, turn, h, command):
    """Conservation law of one step: work of both wrenches, elastic energy and heat sum to zero, released or not."""
    component, c = hold_down(release_time=0.05)
    frame = port_motion((1, 2, 3), (0, 0, turn))
    u0 = inputs(component, frame, port_motion((1.1, 2.2, 2.7)))
    u1 = inputs(component, frame, port_motion(np.add((1.1, 2.2, 2.7), move)), release_command=command)
    x = component.initial(c, u0)
    y = component.step(c, x, u1, h)
    (*_, stored, heat, numerical), (*_, old, _, _) = component.observe(c, y, u1), component.observe(c, x, u0)
    assert old == pytest.approx(0.5 * 50.0**2 / 3e3)
    lost = heat + numerical
    scale = 1.0 + stored + abs(heat) + abs(numerical)
    assert work(component.outputs(c, y, u1), u0, u1, 2) + stored + lost == pytest.approx(
        old, abs=1e-11 * scale
    )
    assert component.observe(c, y, u1)[3] == float(command > 0.5 or h > 0.05)


def test_end_point_wrench():
    """Definition: along the axes of the turned inboard port, of displacements from the offset at the start."""
    component, c = hold_down("endpoint", (0.0, 1.0, 0.0), release_time=2.0)
    turn = Rotation.from_rotvec((0.2, -0.4, 0.7))
    offset, moved, rate = (
        np.array((0.1, 0.2, -0.1)),
        np.array((0.01, -0.02, 0.03)),
        np.array((0.5, 0.2, -0.3)),
    )
    inboard = port_motion((1, 1, 1), turn.as_rotvec())
    start = inputs(component, inboard, port_motion(1 + turn.apply(offset)))
    u = inputs(component, inboard, port_motion(1 + turn.apply(offset + moved), velocity=turn.apply(rate)))
    x = component.initial(c, start)
    force = -np.array((1e3, 2e3, 3e3)) * moved - np.array((10, 20, 30)) * rate - (0, 50.0, 0)
    *wrenches, left = component.outputs(c, x, u)
    assert left == 2.0
    y = np.reshape(wrenches, (2, 6))
    assert y[1] == pytest.approx((*turn.apply(force), 0, 0, 0), abs=1e-10)
    assert component.observe(c, x, u)[:3] == pytest.approx(force)
    assert component.rates(c, x, u) == pytest.approx((1.0, np.array((10, 20, 30)) @ rate**2))
    assert component.indicators(c, x, u) == pytest.approx(2.0)
    stored = component.observe(c, x, u)[4]
    x[component.state_layout["clock"]] = 2.0
    assert component.indicators(c, x, u) == pytest.approx(0.0)
    assert np.all(component.update(c, x, u, False) == x)
    free = component.update(c, x, u, True)
    assert np.all(component.outputs(c, free, u)[:12] == 0.0)
    assert component.observe(c, free, u) == pytest.approx((0, 0, 0, 1, 0, stored, 0))
    assert (component.indicators(c, free, u), component.rates(c, free, u)[1]) == (1.0, 0.0)


def test_an_impulse_leaves_no_memory():
    """Closed form: after a vanishing impulse step that changes the rates, steps at those rates feel springs only."""
    component, c = hold_down(preload=0.0, translational_damping=0.0)
    still = port_motion()
    x = component.initial(c, inputs(component, still, port_motion(velocity=(0.5, 0, 0))))
    y = component.step(c, x, inputs(component, still, port_motion(velocity=(0.1, 0, 0)), impulse=1.0), 1e-7)
    moved = inputs(component, still, port_motion((1e-3, 0, 0), velocity=(0.1, 0, 0)))
    z = component.step(c, y, moved, 0.01)
    assert component.outputs(c, z, moved)[6] == pytest.approx(-0.5 * 1e3 * 1e-3, rel=1e-9)


def seat(*releases, until="0.06 s", **more):
    """A plate on a soft seat, pressed onto it by bolts that let go at times (s), by their own or by an event."""
    scene = fanfold.Scene("seat", until=until, preload=True, **more)
    ground = scene.base(points={"p": (0, 0, 0)})
    rigid = {"mass": 2.0, "inertia": (0.1, 0.1, 0.1), "points": {"p": (0, 0, 0)}}
    plate = scene.body("plate", place={"body": ground, "point": "p"}, rigid=rigid)
    ports = {"inboard": (ground, "p"), "outboard": (plate, "p")}
    soft = {"translational_stiffness": [1e5] * 3, "translational_damping": [20.0] * 3}
    scene.connection("seat", preset="fixed", axes={"x": (1, 0, 0)}, ports=ports, parameters=soft)
    stiff = {"translational_stiffness": [1e6] * 3, "translational_damping": [10.0] * 3, "preload": 500.0}
    for number, (way, time) in enumerate(releases):
        own = {"release_time": time} if way == "time" else {}
        name = scene.connection(
            f"bolt{number}", "hold_down", structure={"axis": (0, 0, 1)}, ports=ports, parameters=stiff | own
        )
        if way == "event":
            scene.event(f"go{number}", time=time, release=[name])
    return scene


def pressed(bolts):
    """What a seat has of the preload of so many bolts (N)."""
    return bolts * 500.0 * 1e5 / (1e5 + bolts * 1e6)


@pytest.mark.parametrize("released", ["time", "event"])
def test_what_a_release_makes_of_loads_is_told(released):
    """Closed form: the base, where both met, bears what the seat had of the preload at once, k / (k + K) of it.

    Regression: by its own time no row told of it, and a peak was lost.
    """
    run = fanfold.simulate(seat((released, 0.05)), estimate=False)
    load = np.abs(run["base", "interface_force"][:, 2])
    assert load[run.time[:] < 0.05 - 1e-6].max() < 0.01
    assert load.max() == pytest.approx(pressed(1), rel=1e-4)


@needs_native
@pytest.mark.parametrize("released", ["time", "event"])
def test_the_one_fmu_tells_it_as_well(released, tmp_path):
    """The master in C: the same peak, of the resultant."""
    (path,) = fanfold.export(seat((released, 0.05)), tmp_path, as_one=True)
    host = Host(path).start().to(0.06, 0.01)
    assert host["base.interface_force_peak"] == pytest.approx(pressed(1), rel=1e-4)


@pytest.mark.parametrize("gap", [1e-8, 1e-6, 1e-4])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
@pytest.mark.parametrize("way", ["time", "event"])
def test_releases_close_to_each_other_tell_loads_of_their_own(gap, tolerance, way):
    """Closed form: the plate hardly moves between, so that the base bears what the seat has of both, at last.

    Regression: a step between both took the loads before the first for its own, and peaks were 5 to 50 % high; where
    rows were 1e-8 s apart, a cubic went through their jump.
    """
    scene = seat((way, 0.05), (way, 0.05 + gap))
    run = fanfold.simulate(scene, estimate=False, tolerance=tolerance)
    assert run.headline.interface_force_peaks[2] == pytest.approx(pressed(2), rel=2e-3)


def test_a_release_at_the_end_of_a_run():
    """Regression: the steps of the run that shows errors had an empty segment, and an error was raised."""
    run = fanfold.simulate(seat(("time", 0.05), until="0.05 s"))
    assert run.headline.interface_force_peaks[2] < 1.001 * pressed(1)


def test_a_release_where_an_fmu_is_sampled(tmp_path):
    """Regression: what an FMU did at that instant, or nothing, was all that was told of it."""
    scene = seat(("time", 0.05))
    scene.fmu("watch", slave(tmp_path), step=0.01, inputs={"angle": "seat.angle"}, outputs={})
    load = np.abs(fanfold.simulate(scene, estimate=False)["base", "interface_force"][:, 2])
    assert load.max() == pytest.approx(pressed(1), rel=1e-4)
