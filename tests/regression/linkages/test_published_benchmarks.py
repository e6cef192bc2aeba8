"""Two problems of IFToMM's library of multibody benchmarks, against its reference solutions as published.

The numbers are the points that draw the references in the figures of L. Tagliapietra, M. Vivian, E. Ceseracciu and
M. Reggiani, Multi-Body System Benchmarks in OpenSim (2015), with a resolution of 1e-5 m (governor) and 1e-4 m (rods).
"""

import numpy as np
import pytest

import orchestrator as fanfold
from tests.references.rods import GRAVITY, four_bars, joined

GOVERNOR = (
    0.5, 0.52384, 0.58508, 0.65863, 0.71771, 0.74325, 0.72763, 0.67547, 0.60318, 0.53628, 0.50142, 0.51371, 0.56773,
    0.64088, 0.7057, 0.74068, 0.73527, 0.69103, 0.6216, 0.55075, 0.50591, 0.50623, 0.55157, 0.62258, 0.69182, 0.7356,
    0.74047, 0.705, 0.63991, 0.56684, 0.51325,
)  # fmt: skip
"""Height (m) of the slider of A05 every 0.1 s."""
FOUR_BARS = {
    0.1: 0.10168, 0.2: 0.21338, 0.3: 0.34479, 0.4: 0.50327, 0.6: 0.87529, 0.7: 0.9949, 0.8: 0.91687, 0.9: 0.52269,
    1.05: -0.43339, 1.1: -0.69546, 1.2: -0.97538, 1.3: -0.96844, 1.4: -0.81365, 1.6: -0.44545, 1.8: -0.17322,
    1.95: -0.01562,
}  # fmt: skip
"""Time (s) and place (m) of the first corner of A02 along the ground; forty windows."""


def governor():
    """A05: rods of 1 m and 0.3 kg with 5 kg at their ends, springs of 8e5 N/m and 4e4 N.s/m to a slider of 3 kg."""
    scene = fanfold.Scene("governor", until=3.0, gravity=(0, 0, -GRAVITY), preload=False)
    scene.base("ground", points={"foot": (0, 0, 0)})
    foot = {"body": "ground", "point": "foot"}
    sides = {"right": (0.05, 0, 0), "left": (-0.05, 0, 0)}
    tops = {side: (x, 0, 1.0) for side, (x, _, _) in sides.items()}
    shaft = {"mass": 0.3, "center_of_mass": (0, 0, 0.5), "inertia": (0.025, 0.025, 5e-6)}
    shaft["points"] = {"foot": (0, 0, 0), **tops}
    scene.body("shaft", rigid=shaft, place=foot, angular_velocity=(0, 0, 2 * np.pi))
    slider = {"mass": 3.0, "inertia": (5e-3,) * 3, "points": {"middle": (0, 0, 0), **sides}}
    scene.body("slider", rigid=slider, place={**foot, "offset": (0, 0, 0.5)})
    joined(scene, "bearing", "revolute", (0, 0, 1), ("ground", "foot"), ("shaft", "foot"))
    joined(scene, "guide", "prismatic", (0, 0, 1), ("shaft", "foot"), ("slider", "middle"))
    centre = (0.3 * 0.5 + 5.0) / 5.3
    inertia = 0.3 / 12.0 + 0.3 * (centre - 0.5) ** 2 + 5.0 * (1.0 - centre) ** 2
    points = {"top": (0, 0, 0), "middle": (0.5, 0, 0)}
    rod = {
        "mass": 5.3,
        "center_of_mass": (centre, 0, 0),
        "inertia": (5e-6, inertia, inertia),
        "points": points,
    }
    for side, (x, _, _) in sides.items():
        way = np.sign(x)
        along = {"x": (way * np.cos(np.pi / 6), 0, -0.5), "z": (way * 0.5, 0, np.cos(np.pi / 6))}
        scene.body(f"{side}_rod", rigid=rod, place={**foot, "offset": (x, 0, 1.0), "orientation": along})
        joined(scene, f"{side}_pin", "revolute", (0, 1, 0), ("shaft", side), (f"{side}_rod", "top"))
        ports = {"inboard": ("slider", side), "outboard": (f"{side}_rod", "middle")}
        values = {"stiffness": 8e5, "damping": 4e4, "preload_length": 0.5}
        scene.connection(f"{side}_spring", "spring", parameters=values, ports=ports)
    return scene


def test_a_stiff_governor_rises_and_falls_as_published():
    """Reference solution: to 1e-3 of the travel of 0.24 m, of which 1.6e-4 m is the compliance of joints of 5e6 N/m."""
    run = fanfold.simulate(governor(), tolerance=1e-4, estimate=False)
    heights = np.interp(0.1 * np.arange(31), run.time, run["slider", "frame_position"][:][:, 2])
    assert np.abs(heights - GOVERNOR).max() < 3e-4
    assert run.headline.energy_residual < 1e-5


@pytest.mark.thorough
def test_forty_four_bars_pass_their_singular_positions_as_published():
    """Reference solution through the first two, at 0.9 and 1.1 s: 81 rods on 121 joints, at up to 8 m/s."""
    run = fanfold.simulate(four_bars(40, until=2.0), tolerance=1e-4, estimate=False)
    w, x, y, z = run["crank0", "frame_orientation"][:].T
    angle = np.unwrap(np.arctan2(2 * (x * z - w * y), 1 - 2 * (y * y + z * z)))
    places = np.cos(np.interp(list(FOUR_BARS), run.time, angle))
    assert np.abs(places - list(FOUR_BARS.values())).max() < 5e-4
    assert run.headline.energy_residual < 1e-5
