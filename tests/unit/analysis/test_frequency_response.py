"""Base excitation: transmissibility in closed form, two degrees of freedom, and clamped finite elements."""

import json
from math import pi, sqrt

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import sparse
from scipy.sparse.linalg import splu

from orchestrator.analysis.frequency_response import (
    base_response,
    frequency_grid,
    peaks,
    point_motion,
    responses,
)
from orchestrator.analysis.vibration import INTERFACE
from orchestrator.assembly.statics.configuration import configuration, placed
from orchestrator.assembly.statics.linear_model import linearise, normal_modes
from orchestrator.cli.main import main
from orchestrator.scene import SceneError, load_scene
from tests.references import catalogue
from tests.references.edits import edited

RATIO = 0.03
HEAD = """
[scene]
name = "chain"
until = 1.0
[base]
points = { root = [0.0, 0.0, 0.0] }
FREE
[joint]
damping_ratio = 0.03
damping_frequency = "5 Hz"
"""
BODY = """
[[body]]
name = "NAME"
[body.rigid]
mass = MASS
inertia = [0.3, 0.4, 0.5]
points = { a = [0.0, 0.0, 0.0], b = [0.0, 0.0, 0.0] }
"""
SPRING = (
    'kind = "bushing", translational_stiffness = [STIFFNESS, 1e10, 1e10], '
    "rotational_stiffness = [1e10, 1e10, 1e10]"
)
LINE = """
[[hinge_line]]
name = "to_NAME"
inboard = "INBOARD"
outboard = "NAME"
axis = "+x"
aligned_angle = "1 rad"
start_angle = "1 rad"
hinges = [{ name = "spring_NAME", inboard = "POINT", outboard = "a", JOINT }]
"""
TIME = 2.0 * RATIO / (2.0 * pi * 5.0)
"""s; damping over stiffness of every joint, from the scene's damping ratio at 5 Hz"""
M1, M2 = 4.0, 2.5
K1, K2 = M1 * (2.0 * pi * 5.0) ** 2, 900.0


def chain(folder, bodies, free=False):
    """Masses on springs along x, in a row from the base; bodies are (mass, stiffness)."""
    base = "free = { mass = 10.0, inertia = [1.0, 1.0, 1.0] }" if free else ""
    text, inboard, point = edited(HEAD, ("FREE", base)), "base", "root"
    for k, (mass, stiffness) in enumerate(bodies, 1):
        name = f"m{k}"
        text += edited(BODY, ("NAME", name), ("MASS", str(mass)))
        places = (("NAME", name), ("INBOARD", inboard), ("POINT", point))
        text += edited(LINE, *places, ("JOINT", SPRING), ("STIFFNESS", str(stiffness)))
        inboard, point = name, "b"
    path = folder / "chain.toml"
    path.write_text(text, encoding="utf-8")
    return path


def model_of(path):
    scene = load_scene(path)
    return linearise(placed(scene, (), (), configuration(scene)))


@pytest.mark.parametrize("free", [False, True])
def test_one_degree_of_freedom(tmp_path, free):
    """Closed form: (1 + 2 i z r) / (1 - r^2 + 2 i z r), and the load -m times it, on ground or a free base alike."""
    model = model_of(chain(tmp_path, [(M1, K1)], free))
    frequency = np.array([0.1, 1.0, 4.9, 5.0, 5.1, 7.0711, 20.0])
    r = frequency / 5.0
    transmissibility = (1.0 + 2j * RATIO * r) / (1.0 - r**2 + 2j * RATIO * r)
    found = responses(model, "x", "x", ["m1.a", INTERFACE], frequency)
    np.testing.assert_allclose(found[0].values, transmissibility, rtol=1e-8)
    np.testing.assert_allclose(found[1].values, -M1 * transmissibility, rtol=1e-8)
    assert [f.unit for f in found] == ["(m/s2)/(m/s2)", "N/(m/s2)"]


def test_two_degrees_of_freedom(tmp_path):
    """Closed form: the 2 x 2 complex system of the chain, solved by Cramer's rule."""
    model = model_of(chain(tmp_path, [(M1, K1), (M2, K2)]))
    frequency = np.geomspace(0.5, 30.0, 41)
    omega = 2.0 * pi * frequency
    k1, k2 = K1 * (1.0 + 1j * omega * TIME), K2 * (1.0 + 1j * omega * TIME)
    a, b, d = k1 + k2 - M1 * omega**2, -k2, k2 - M2 * omega**2
    x1, x2 = k1 * d / (a * d - b * b), -k1 * b / (a * d - b * b)
    found = responses(model, "x", "x", ["m1.a", "m2.b", INTERFACE], frequency)
    np.testing.assert_allclose(found[0].values, x1, rtol=1e-7)
    np.testing.assert_allclose(found[1].values, x2, rtol=1e-7)
    np.testing.assert_allclose(found[2].values, -(M1 * x1 + M2 * x2), rtol=1e-7)


def test_rotation_of_the_base(tmp_path):
    """Rigid limit: far below resonance everything turns with the base, at an arm of 0.7 m with 0.7 (m/s2)/(rad/s2)."""
    path = chain(tmp_path, [(M1, 1e10)])
    text = edited(path.read_text(encoding="utf-8"), ("root = [0.0, 0.0, 0.0]", "root = [0.7, 0.0, 0.0]"))
    path.write_text(text, encoding="utf-8")
    model = model_of(path)
    (found,) = responses(model, "ry", "z", ["m1.a"], np.array([1.0]))
    assert found.values[0] == pytest.approx(-0.7, rel=1e-6)
    assert found.unit == "(m/s2)/(rad/s2)"
    (load,) = responses(model, "ry", "ry", [INTERFACE], np.array([1.0]))
    assert load.values[0] == pytest.approx(-(0.4 + M1 * 0.7**2), rel=1e-6)
    assert load.unit == "N.m/(rad/s2)"


def test_interface_load_is_the_inertia_of_what_moves(tmp_path):
    """Newton's law for the whole, off resonance and on it: load on the base = - sum of m a, about any axis."""
    model = model_of(chain(tmp_path, [(M1, K1), (M2, K2)]))
    rigid = model.mechanism.rigid_motion(model.origin)
    for excitation in range(6):
        accelerations, loads = base_response(model, excitation, np.array([0.7, 2.7, 5.0, 40.0]))
        # the joints' 1e10 N/m over (2 pi 0.7)^2 is their round-off, 1e-16 * 1e10 / 20
        np.testing.assert_allclose(loads, -accelerations @ model.mass @ rigid, atol=1e-6)


CLAMP = (
    'kind = "bushing", translational_stiffness = [1e12, 1e12, 1e12], '
    "rotational_stiffness = [1e12, 1e12, 1e12]"
)
PANEL = """
[scene]
name = "clamped"
until = 1.0
[base]
points = { left = [0.0, 0.565, 0.0], right = [0.0, -0.565, 0.0] }
[joint]
damping_ratio = 0.0
[[body]]
name = "panel"
catalogue = "workbench_panel"
fixed_interface_modes = 30
damping_ratio = 0.0
[[hinge_line]]
name = "line"
inboard = "base"
outboard = "panel"
axis = "+y"
aligned_angle = "90 deg"
start_angle = "90 deg"
hinges = [
  { name = "left", inboard = "left", outboard = "hl_left", JOINT },
  { name = "right", inboard = "right", outboard = "hl_right", JOINT },
]
"""


def test_clamped_flexible_panel_against_its_finite_elements(tmp_path):
    """Independent: (K - w^2 M) x = w^2 M r of the whole finite-element model, points clamped and moved as one.

    Off resonance. Modes left out are above 930 Hz and miss up to (20 / 930)^2 = 5e-4 of their static share, which
    is a few percent: 5e-5.
    """
    path = tmp_path / "clamped.toml"
    path.write_text(edited(PANEL, ("JOINT", CLAMP)), encoding="utf-8")
    model = model_of(path)
    elements = catalogue.entry("workbench_panel").finite_elements()
    clamped = np.concatenate([elements.attachment_dofs[name] for name in ("hl_left", "hl_right")])
    inside = np.setdiff1d(np.arange(elements.stiffness.shape[0]), clamped)
    center = elements.point_motions["center"]
    frequency = np.array([0.5, 3.0, 6.0, 20.0])
    for direction, rigid in ((2, elements.rigid_motions[:, 2]), (1, elements.rigid_motions[:, 1])):
        found = responses(model, "xyz"[direction], "xyz"[direction], ["panel.center", INTERFACE], frequency)
        for k, omega in enumerate(2.0 * pi * frequency):
            dynamic = sparse.csc_array(elements.stiffness - omega**2 * elements.mass_matrix)
            motion = rigid.copy()
            motion[inside] = splu(dynamic[inside][:, inside]).solve(
                -np.asarray(dynamic[inside][:, clamped] @ rigid[clamped])
            )
            acceleration = (center @ motion)[direction]
            load = -rigid @ (elements.mass_matrix @ motion)
            assert found[0].values[k].real == pytest.approx(acceleration, rel=5e-5)
            assert found[1].values[k].real == pytest.approx(load, rel=5e-5)


def test_grid_holds_the_resonances_and_peaks_find_them(tmp_path):
    """Peak of one degree of freedom: close to 1 / 2 z at r = sqrt(1 - 2 z^2) for small z; the grid resolves it."""
    model = model_of(chain(tmp_path, [(M1, K1)]))
    grid = frequency_grid(model, 0.5, 50.0, 20)
    (found,) = responses(model, "x", "x", ["m1.a"], grid)
    ((frequency, size), *_) = peaks(grid, found.values)
    # the grid is a tenth of the half-width fine: the magnitude is low by at most half its square
    assert frequency == pytest.approx(5.0, rel=0.1 * RATIO)
    assert size == pytest.approx(sqrt(1.0 + 4.0 * RATIO**2) / (2.0 * RATIO), rel=6e-3)
    assert normal_modes(model).frequencies[0] in grid
    assert (grid[0], grid[-1]) == (0.5, 50.0)


def test_grid_of_a_free_base_holds_the_resonances_with_the_base_prescribed(tmp_path):
    """Prescribed, a free base of 10 kg is a ground: 5 Hz, and not the 5.92 Hz at which base and mass swing freely."""
    model = model_of(chain(tmp_path, [(M1, K1)], free=True))
    grid = frequency_grid(model, 0.5, 50.0, 20)
    assert np.abs(grid - 5.0).min() == pytest.approx(0.0, abs=1e-6)


def test_unknown_point(tmp_path):
    """A sentence with the points that there are."""
    with pytest.raises(SceneError, match=r"no point 'm1\.c'; points are m1\.a, m1\.b"):
        point_motion(model_of(chain(tmp_path, [(M1, K1)])), "m1.c")


def test_command(tmp_path, monkeypatch):
    """Interface: JSON with magnitude and phase over frequency; a picture; sentences."""
    path = chain(tmp_path, [(M1, K1), (M2, K2)])
    monkeypatch.chdir(tmp_path)
    arguments = ["analyse", "frequency-response", str(path), "--excite", "x", "--from", "1", "--to", "9"]
    result = CliRunner().invoke(main, [*arguments, "--points", "m2.b,interface", "--json", "--plot", "r.png"])
    assert result.exit_code == 0, result.output
    content = json.loads(result.stdout)
    first = content["responses"][0]
    assert first["output"] == "m2.b x"
    assert len(first["magnitude"]) == len(first["phase_deg"]) == len(content["frequency_hz"])
    assert (tmp_path / "r.png").stat().st_size > 10_000
    assert "largest resonances" in CliRunner().invoke(main, arguments).stdout
    refused = CliRunner().invoke(main, [*arguments, "--to", "0.5"])
    assert refused.exit_code == 2
    assert "--from 1 Hz" in refused.stderr


def test_an_output_without_a_resonance_is_listed():
    """Stowed and rigid, nothing peaks between 1 and 2 Hz; the output is there all the same."""
    arguments = ["analyse", "frequency-response", "bepicolombo", "--rigid", "all", "--from", "1", "--to", "2"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    assert "none" in next(line for line in result.stdout.splitlines() if "interface z" in line)
