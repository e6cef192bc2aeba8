"""Runs with a prescribed motion: rates from steps, what is chosen to be shown, and waits until bodies are quiet."""

import numpy as np
import pytest

from components.contract.roles import HINGE_LOAD
from orchestrator.analysis.motion import histories as motion
from orchestrator.analysis.motion.deflection import QUIET, motion_end, quiet
from orchestrator.assembly import Geometry
from orchestrator.results.parts import Meaning
from orchestrator.results.result import Result

END = 1.0
"""s, of the law."""
DECAY, RATE, LARGEST = 2.0, 60.0, 0.01


def result(signals, until=6.0, step=1e-3, shapes=1.0, roles=None):
    """A run in memory: signals as functions of time by component and variable, and a foil of one mode."""
    time = np.linspace(0.0, until, round(until / step) + 1)
    values = {of: signal(time) for of, signal in signals.items()}
    catalogue = {}
    for name, variable in values:
        meaning = Meaning("N.m", "made up", (roles or {}).get((name, variable), ""))
        catalogue.setdefault(name, {})[variable] = meaning
    foil = Geometry(
        np.zeros((2, 3)), np.array([[[0.0]] * 3, [[0.0], [0.0], [shapes]]]), np.zeros((0, 4), int)
    )
    return Result(None, time, [], {}, {}, (), {"foil": foil}, True, catalogue, values)


def swinging(until=6.0, offset=0.0):
    """A law that ends at one second, and a foil that from then on swings less and less about an offset."""
    return result(
        {
            ("motion", "commanded_distance"): lambda t: np.minimum(t, END),
            ("motion", "commanded_rate"): lambda t: np.where(t < END, 1.0, 0.0),
            ("foil", "modal_coordinate"): lambda t: (
                offset + LARGEST * np.exp(-DECAY * np.maximum(t - END, 0.0)) * np.cos(RATE * (t - END))
            )[:, None],
        },
        until,
    )


@pytest.mark.parametrize("offset", [0.0, 0.004])
def test_wait_is_that_of_the_decay(offset):
    """exp(-DECAY wait) = share of the largest; the last swing above may be half a period before."""
    (found,) = quiet(swinging(offset=offset))
    expected = -np.log(QUIET * (LARGEST + offset) / LARGEST) / DECAY
    assert found.motion_ends == pytest.approx(END, abs=1e-3)
    assert found.largest == pytest.approx(LARGEST + offset, rel=1e-3)
    assert expected - np.pi / RATE - 1e-3 < found.wait < expected + 1e-3
    assert f"{found.wait:.3g} s later" in found.sentence(6.0)


def test_a_run_too_short_to_tell_says_so():
    """Still above at its end, or below in less than the last tenth of the time."""
    ends = END - np.log(QUIET) / DECAY
    for until in (1.5, END + 1.03 * (ends - END)):
        (found,) = quiet(swinging(until))
        assert found.wait is None
        assert " 5 %" in found.sentence(until)


def test_nothing_is_told_without_a_law_or_before_its_end():
    assert motion_end(swinging(until=0.9)) is None
    assert not list(quiet(swinging(until=0.9)))
    assert not list(quiet(result({("foil", "modal_coordinate"): lambda t: np.sin(t)[:, None]})))
    assert not list(motion.histories(result({("hl", "angle"): np.sin})))


def test_rates_are_means_of_the_steps_and_events_are_left_out():
    """Of a quadratic they are exact at the middles; two rows of one instant hold a jump, which is no rate."""
    time = np.array([0.0, 0.1, 0.3, 0.3, 0.4])
    at, rate = motion._rate(time, np.stack([3.0 * time**2, np.where(np.arange(5) > 2, 7.0, 5.0)], axis=1))
    np.testing.assert_allclose(at, [0.05, 0.2, 0.35])
    np.testing.assert_allclose(rate, np.stack([6.0 * at, 0.0 * at], axis=1), atol=1e-12)


def test_angular_rate_of_a_steady_turn():
    """About z at 2 rad/s, through half a turn and beyond."""
    time = np.linspace(0.0, 3.0, 31)
    quaternion = np.stack([np.cos(time), 0 * time, 0 * time, np.sin(time)], axis=1)
    _, rate = motion._angular_rate(time, quaternion)
    np.testing.assert_allclose(rate, np.tile([0.0, 0.0, 2.0], (30, 1)), atol=1e-12)


def test_the_first_of_an_array_stands_for_all():
    names = ["top", "link_1", "link_2", "side_12", "link_a_1"]
    assert motion.first_of_arrays(names) == ["top", "link_1", "side_12", "link_a_1"]
    assert motion.chosen([f"joint_{k}" for k in range(8)]) == [f"joint_{k}" for k in range(8)]
    assert motion.chosen([f"joint_{k}" for k in range(9)]) == ["joint_0"]


def test_small_loads_have_a_panel_of_their_own_and_round_off_has_none():
    """100 and 20 N.m about x share a panel; 1 N.m has its own; 1e-6 N.m is nothing; nothing acts about y and z."""
    sizes = {"great": 100.0, "middle": 20.0, "small": 1.0, "nothing": 1e-6}
    signals = {
        (name, "hinge_torque"): lambda t, size=size: size * np.outer(np.sin(t), [1.0, 0.0, 1e-5])
        for name, size in sizes.items()
    }
    run = result(
        {("motion", "commanded_distance"): np.sin, **signals}, roles=dict.fromkeys(signals, HINGE_LOAD)
    )
    (history,) = [one for one in motion.histories(run) if one.name == "joint_torques"]
    assert [(panel.label, set(panel.curves)) for panel in history.panels] == [
        ("x, N.m", {"great", "middle"}),
        ("x, N.m", {"small"}),
    ]
    time, values = history.panels[0].curves["great"]
    np.testing.assert_array_equal(values, 100.0 * np.sin(time))
