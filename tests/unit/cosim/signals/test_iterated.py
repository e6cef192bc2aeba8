"""FMUs that take every step of a scene, repeated until loads and motion agree: against closed forms and SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import orchestrator as fanfold
from components.drive import MotionLaw
from tests.unit.cosim.signals.signal_cases import INERTIA, controlled, slave

pytestmark = pytest.mark.filterwarnings("ignore:fmu.controller.*W-fmu-unit")
STIFF = {"gain": 5e4, "damping": 20.0}  # a swing of 50 rad/s, beside steps of 0.05 s that hold it


@pytest.fixture(scope="module")
def spring(tmp_path_factory):
    """A rotational spring and damper: the controller with a state that can be set."""
    return slave(tmp_path_factory.mktemp("fmu"), canGetAndSetFMUstate=True)


def swung(until):
    """Angle (rad) at times that reach to the end, by SciPy."""
    push = MotionLaw(True, 0.0, 1.0, 0.0, 0.5)

    def rates(t, y):
        return [y[1], (push.angle(t) - STIFF["gain"] * y[0] - STIFF["damping"] * y[1]) / INERTIA]

    return solve_ivp(rates, (0.0, until), [0.0, 0.0], rtol=1e-11, atol=1e-15, dense_output=True).sol


def test_a_stiff_spring_is_followed_where_a_held_one_blows_up(spring):
    """Independent path: SciPy. Loads over a step are the mean of its ends, so errors go with its square."""
    expected = swung(0.5)

    def error(step):
        scene = controlled(spring, 0.5, iterated=True, parameters=STIFF)
        run = fanfold.simulate(scene, tolerance=1e-6, step=step, estimate=False)
        angle, exact = run["craft", "attitude"][:, 1], expected(run.time)[0]
        return np.max(np.abs(angle - exact)) / np.max(np.abs(exact))

    coarse, fine = error(4e-3), error(2e-3)
    assert fine < 5e-3
    assert 3.5 < coarse / fine < 4.5
    held = fanfold.simulate(controlled(spring, parameters=STIFF), estimate=False)
    assert np.max(np.abs(held["craft", "attitude"][:, 1])) > 1e3 * np.max(np.abs(swung(1.0)(held.time)[0]))


def test_steps_are_chosen_by_the_tolerance(spring):
    """Independent path: SciPy, from the steps that the loads ask for, at most the FMU's own; energies close."""
    run = fanfold.simulate(
        controlled(spring, 0.5, iterated=True, parameters=STIFF, step=0.02), tolerance=1e-4, estimate=False
    )
    exact = swung(0.5)(run.time)[0]
    assert run["craft", "attitude"][:, 1] == pytest.approx(exact, abs=2e-3 * np.max(np.abs(exact)))
    assert np.max(np.diff(run.time)) <= 0.02 * (1.0 + 1e-12)
    assert run.headline.energy_residual < 1e-8
    assert run["controller", "angle"][:] == pytest.approx(run["craft", "attitude"][:, 1], abs=1e-9)


def test_estimates_see_what_the_steps_cost(spring):
    """The companion takes every two steps as one, of the FMU as well: its torque's peak tells the true error."""
    scene = controlled(spring, 0.5, iterated=True, parameters=STIFF)  # the peak is at 0.49 s
    run = fanfold.simulate(scene, tolerance=1e-3, refine=False)
    exact = np.max(np.abs(swung(0.5)(np.linspace(0.0, 0.5, 10001))[0])) * STIFF["gain"]
    peak = np.max(np.abs(run["controller", "torque"][:]))
    assert peak == pytest.approx(exact, rel=1e-2)


CANNOT = {
    "no state": (False, {}, "iterated: .*Controller.fmu"),
    "no loads": (True, {"outputs": {"torque": []}}, "iterated: .*load"),
}


@pytest.mark.parametrize("kind", CANNOT)
def test_what_cannot_be_iterated_is_told_before_the_run(tmp_path, kind):
    saves, keys, sentence = CANNOT[kind]
    file = slave(tmp_path, canGetAndSetFMUstate=saves)
    with pytest.raises(fanfold.FanfoldError, match=rf"fmu.controller.{sentence}"):
        fanfold.simulate(controlled(file, iterated=True, **keys))


def test_an_explicit_master_cannot_iterate(spring):
    with pytest.raises(fanfold.FanfoldError, match="iterate"):
        fanfold.simulate(controlled(spring, iterated=True), master="gauss-seidel", step=1e-3)


def test_what_fails_in_a_repeated_step_is_named(tmp_path):
    """An FMU that raises from its twentieth step on: the run ends with its name, and the rows stay."""
    fault = "if self.count > 20: raise ValueError('the spring is broken')"
    file = slave(tmp_path, fault=fault, canGetAndSetFMUstate=True)
    with pytest.raises(fanfold.FanfoldError, match="controller: cannot do a step") as caught:
        fanfold.simulate(controlled(file, iterated=True, parameters=STIFF), step=1e-3, estimate=False)
    assert len(caught.value.result.time) > 3
