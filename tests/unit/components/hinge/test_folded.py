"""A hinge that gives way across its line until the angle about it has no meaning is told of by name."""

import pytest

import orchestrator as fanfold

SOFT = """
[scene]
name = "soft"
until = 5.0
gravity = [0.0, 0.0, -9.81]

[base]
points = { root = [0.0, 0.0, 0.0] }

[joint]
cross_stiffness = 0.01

[[body]]
name = "arm"

[body.rigid]
mass = 1.0
center_of_mass = [0.0, 0.5, 0.0]
inertia = [0.1, 0.01, 0.1]
points = { root = [0.0, 0.0, 0.0] }

[[hinge_line]]
name = "line"
inboard = "base"
outboard = "arm"
axis = "+y"
aligned_angle = "90 deg"
hinges = [{ name = "pin", inboard = "root", outboard = "root" }]
motor = { stowed = 0.001, deployed = 0.001 }
"""


@pytest.mark.parametrize("backend", ["native", "python"])
@pytest.mark.filterwarnings("ignore:.*W-no-end")  # nothing stops it
def test_it_is_told_where_the_line_has_folded(tmp_path, backend):
    """Closed form: an arm along its line falls like a pendulum from the horizontal, to 180 deg on the other side."""
    scene, path = tmp_path / "soft.toml", tmp_path / "soft.h5"
    scene.write_text(SOFT, encoding="utf-8")
    with pytest.raises(fanfold.FanfoldError, match=r"pin at t = .*17\d deg") as caught:
        fanfold.simulate(scene, save=path, backend=backend, tolerance=1e-3, estimate=False)
    assert "cross_stiffness" in str(caught.value)
    assert len(fanfold.Result.open(path).time) > 10


@pytest.mark.filterwarnings("ignore:.*W-bent")  # which it is free to
def test_a_joint_without_springs_across_may_fold(tmp_path):
    """Definition: nothing that a spherical joint does hangs on its angle; energy as for any pendulum."""
    text = SOFT.replace('outboard = "root" }]', 'outboard = "root", kind = "spherical" }]')
    scene = tmp_path / "free.toml"
    scene.write_text(text.replace("motor = { stowed = 0.001, deployed = 0.001 }\n", ""), encoding="utf-8")
    result = fanfold.simulate(scene, until=1.5, tolerance=1e-3, estimate=False)
    assert result.complete
