"""A wing on a free spacecraft: what it tells of attitude and loads, by conservation and beside a fixed one."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

import orchestrator as fanfold
from orchestrator.results.signal import EVENT_WIDTH
from tests.references.native_fmus import needs_native

TOLERANCE = 1e-4
ARM = 0.565
AT = {"hinge_left": (0.2, ARM, 0.3), "hinge_right": (0.2, -ARM, 0.3)}


def wing(mass=None, until="5 s"):
    """The workbench's panel on a spacecraft of a mass (kg), or on ground."""
    scene = fanfold.Scene("one_panel", until=until)
    free = (
        None if mass is None else {"mass": mass, "center_of_mass": (-0.5, 0.1, 0), "inertia": [mass / 2] * 3}
    )
    points = {"left": AT["hinge_left"], "right": AT["hinge_right"]}
    base = scene.base(points=points) if free is None else scene.base(points=points, free=free)
    panel = scene.body("panel", catalogue="workbench_panel")
    scene.hinge_line(
        "HL",
        base,
        panel,
        axis="+y",
        aligned_angle="180 deg",
        hinges={"hinge_left": ("left", "hl_left"), "hinge_right": ("right", "hl_right")},
        motor={"stowed": "2.304 N.m", "deployed": "1.434 N.m"},
        latch={"stiffness": 4147.8, "effective_inertia": 6.2514},
    )
    return scene


def run(scene, tolerance=TOLERANCE, **options):
    return fanfold.simulate(scene, rigid="all", tolerance=tolerance, estimate=False, **options)


@pytest.fixture(scope="module")
def light():
    """On a spacecraft so light that it turns far."""
    return run(wing(30.0))


def smooth_parts(result):
    """Rows before and after the latch-up."""
    latch_up = result.latch_times["HL"]
    return [result.time < latch_up - EVENT_WIDTH, result.time > latch_up + EVENT_WIDTH]


def test_interface_loads_are_what_changes_the_momentum_of_the_base(light):
    """Balance of momentum and of angular momentum about the world's origin, over every part between two events."""
    turn = Rotation.from_quat(light["base", "frame_orientation"][:], scalar_first=True)
    force = turn.apply(light["base", "interface_force"][:])
    torque = turn.apply(light["base", "interface_torque"][:])
    moment = torque + np.cross(light["base", "frame_position"][:], force)
    for load, name in ((force, "linear_momentum"), (moment, "angular_momentum")):
        for rows in smooth_parts(light):
            time, momentum = light.time[rows], light["base", name][:][rows]
            taken = CubicSpline(time, load[rows]).integrate(time[0], time[-1])
            size = np.trapezoid(np.linalg.norm(load[rows], axis=1), time)
            assert size > 0.1
            assert np.abs(taken - (momentum[-1] - momentum[0])).max() < TOLERANCE * size


def test_nothing_from_outside_acts(light):
    """Conservation: linear and angular momentum of the whole stay zero, to what iterations leave of wrenches."""
    for name in ("linear_momentum", "angular_momentum"):
        base, panel = light["base", name][:], light["panel", name][:]
        assert np.abs(base).max() > 0.5
        assert np.abs(base + panel).max() < 1e-6 * np.abs(base).max()


def test_ports_add_up_to_the_interface_load(light):
    """Statics: sums of forces and of moments about the base's origin, but where a jump bounds each by itself."""
    force = {name: light["base", f"{name}.interface_force"][:] for name in AT}
    moment = {
        name: light["base", f"{name}.interface_torque"][:] + np.cross(AT[name], force[name]) for name in AT
    }
    for ports, name in ((force, "interface_force"), (moment, "interface_torque")):
        total = light["base", name][:]
        gap = np.abs(sum(ports.values()) - total).max(1) / np.abs(total).max()
        assert np.count_nonzero(gap > 1e-12) <= 2 * len(light.events)


def test_attitude_is_told(light):
    """Independent: the rotation vector of the recorded quaternion by SciPy, in the file and among the numbers."""
    turn = Rotation.from_quat(light["base", "frame_orientation"][:], scalar_first=True)
    attitude, rate = light["base", "attitude"][:], light["base", "attitude_rate"][:]
    assert np.rad2deg(np.abs(attitude).max()) > 5.0
    assert attitude == pytest.approx(turn.as_rotvec(), abs=1e-12)
    center = light["base", "frame_position"][:] + turn.apply([-0.5, 0.1, 0.0])
    spin = light["base", "angular_momentum"][:] - np.cross(center, light["base", "linear_momentum"][:])
    assert turn.apply(15.0 * rate) == pytest.approx(spin, abs=1e-12)  # kg.m2 about every axis
    shown = {(row.quantity, row.of): row.value for row in light.headline.numbers()}
    largest = np.abs(attitude[:, 1]).max()  # of samples; the peak lies between two
    assert largest <= shown["attitude peak", "y"] < largest * (1.0 + 1e-5)
    assert shown["final attitude", "y"] == attitude[-1, 1]
    assert shown["attachment force peak", "hinge_left"] > 0.0


def test_a_heavy_spacecraft_is_a_fixed_one():
    """Limit: differences of latch time and interface loads from those of ground fall with the mass."""
    fixed, *free = (numbers(run(wing(mass, "4.5 s"), 1e-5)) for mass in (None, 1e4, 1e5))
    far, near = (np.abs(found - fixed) / fixed for found in free)
    assert far.max() > 1e-4
    assert near == pytest.approx(0.1 * far, rel=0.02, abs=1e-5)


def numbers(result):
    loads = result.headline
    forces = (loads.interface_force_peaks[0], loads.interface_torque_peaks[1])
    return np.array([result.latch_times["HL"], *forces, loads.port_force_peaks["hinge_left"]])


@needs_native
@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before
def test_native_and_python_agree():
    """Independent implementations of the record, of attitude and of loads, over 20 steps that iterate to 1e-9."""
    native, python = (
        run(wing(30.0, "0.04 s"), 1e-9, step="2 ms", backend=backend) for backend in ("native", "python")
    )
    for name in native.variables("base"):
        found, expected = native["base", name][:], python["base", name][:]
        assert found == pytest.approx(expected, abs=1e-8 * max(np.abs(expected).max(), 1e-3)), name
