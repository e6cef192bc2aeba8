"""A folded stack with thickness: snubbers carry what bolts pull until these are released, then the panels part."""

from pathlib import Path

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.results.result import Result

STACK = Path(__file__).parents[2] / "scenes" / "snubbed_stack.toml"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """The result of its first 0.6 s; the bolt to the wall lets go at 0.5 s, that between the panels never."""
    found = tmp_path_factory.mktemp("stack") / "stack.h5"
    with pytest.warns(fanfold.FanfoldWarning, match="has not"):
        fanfold.simulate(STACK, until=0.6, rigid="all", estimate=False, save=found)
    return found


def pads(result, name):
    """Force (N) on both pads of a name at every row."""
    return sum(result.signal(f"{name}_{side}", "contact_force") for side in ("left", "right"))


def test_at_rest_pads_balance_bolt_and_motor(path):
    """Statics about both lines with the arms of the scene, within 0.02 % of what the bolts take.

    HL2: bolt x 1.0 m = pads x 1.2 m + means of motor (1.45 N.m) and harness (0.09 N.m) of both ways. HL1: bolt x 0.68 m
    = pads x 0.48 m + motor (1.6 N.m), within what friction and hysteresis hold (0.1 and 0.11 N.m). Bolts also carry
    0.7 N across at 24 mm.
    """
    result = Result.open(path)
    rest = np.searchsorted(result.time, 0.49) - 1  # the last row before
    bolts = result.signal("panel_bolt", "force")[rest, 2], -result.signal("wall_bolt", "force")[rest, 0]
    second = 1.2 * pads(result, "snubber")[rest] + 1.36 - 1.0 * bolts[0]
    first = 0.48 * pads(result, "wall")[rest] + 1.6 - 0.68 * bolts[1]
    assert min(bolts) > 150.0
    assert second == pytest.approx(0.0, abs=0.11 + 0.7 * 0.024)
    assert first == pytest.approx(0.0, abs=0.1 + 0.7 * 0.024)


def test_released_panels_leave_the_wall_together(path):
    """The wall's pads lift off and never pull, what the other bolt joins stays pressed; energy closes.

    The scene's tolerance of 1e-3 bounds what a step may err by, and the balance errs by far less: a hundredth of it.
    """
    result = Result.open(path)
    after = result.time > 0.52
    assert np.all(pads(result, "wall")[after] == 0.0)
    assert min(pads(result, name).min() for name in ("wall", "snubber")) == 0.0
    assert pads(result, "snubber")[after].min() > 200.0
    assert fanfold.Result.open(path).headline.energy_residual < 1e-5


def test_readers_take_a_hold_downs_force(path):
    """A load with three axes, which no scene that comes with Fanfold has."""
    result = fanfold.Result.open(path)
    assert set(result.headline.force_extremes["wall_bolt"]) == {"force_x", "force_y", "force_z"}
    assert fanfold.compare(result, result).rows


@pytest.mark.thorough
def test_panels_on_the_wrong_faces_are_told():
    """With the other sign of HL2's offsets panel2 would open through panel1; a sound stack is not doubted."""
    assert fanfold.check_scene(STACK).warnings == ()
    offsets = (
        "body.panel1.panel.hinge_line_offsets.outboard",
        "body.panel2.panel.hinge_line_offsets.inboard",
    )
    normals = (f"connection.snubber_{side}.structure.normal" for side in ("left", "right"))
    settings = dict.fromkeys(offsets, "12 mm") | dict.fromkeys(normals, (0, 0, 1))
    (sentence,) = fanfold.check_scene(STACK, settings=settings).warnings
    assert sentence.startswith("hinge_line.HL2: ")
