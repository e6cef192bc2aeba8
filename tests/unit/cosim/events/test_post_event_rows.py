"""What acts at one instant is one row: loads between two latch-ups at the same time last no time and are no peak."""

from __future__ import annotations

import numpy as np
import pytest

import orchestrator as fanfold
from fmus import native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import run
from orchestrator.scene import read_scene
from tests.unit.run.as_one.host import Host, latching

SIDES = {"left": ("+y", 1.0), "right": ("-y", -1.0)}


def mirrored(latch=True):
    """Two panels that mirror each other about the y-z plane, opened by 30 deg and caught by latches that brake.

    Without latches, two events of their angles make their motors stronger.
    """
    scene = fanfold.Scene("mirrored", until=1.4)
    base = scene.base(points={"left": (0, 0, 0), "right": (0, 0, 0)})
    for name, (axis, sign) in SIDES.items():
        panel = {"mass": 8, "center_of_mass": (0.8 * sign, 0, 0), "inertia": (0.9, 1.8, 2.7)}
        body = scene.body(f"{name}_panel", rigid={**panel, "points": {"root": (0, 0, 0)}})
        ends = (
            {"latch": {"kind": "spring", "stiffness": 2e3, "damping_ratio": 0.5}}
            if latch
            else {"end_stop": {"angle": "150 deg", "stiffness": 1e3}}
        )
        scene.hinge_line(
            f"{name}_line", base, body, axis=axis, aligned_angle="90 deg", start_angle="60 deg",
            motor={"stowed": 8.0, "deployed": 8.0}, hinges={f"{name}_hinge": (name, "root")}, **ends,
        )  # fmt: skip
        if not latch:
            scene.event(
                f"{name}_boost", when={"component": f"{name}_hinge", "variable": "angle", "above": "70 deg"},
                set={f"{name}_hinge": {"motor_constant_torque": 60.0}},
            )  # fmt: skip
    return scene


@pytest.mark.parametrize("latch", [True, False])
def test_mirrored_wings_do_not_turn_their_base(latch):
    """Symmetry. Regression: the row after the first latch-up and before the second had half of both as a peak."""
    assembly = assemble(read_scene("mirrored.toml", mirrored(latch).tree))
    result = run(assembly, None, Settings(1e-3)).result
    own = np.abs(result.signal("left_hinge", "latch_torque" if latch else "motor_torque")).max()
    assert own > 50.0
    assert len(result.events) == 2
    assert np.abs(result.signal("base", "interface_torque")).max() < 1e-6 * own
    # the row of the instant is there: the latch brakes at once
    assert np.count_nonzero(np.diff(result.time) < 1e-7) == 1


@pytest.mark.skipif(native_library() is None, reason="a scene as one FMU is native")
def test_nor_do_they_as_one_fmu(tmp_path):
    (path,) = fanfold.export(mirrored(), tmp_path, as_one=True)
    host = Host(path).start().to(1.4, 0.05)
    assert host["left_line.latched"] == host["right_line.latched"] == 1.0
    assert host["base.interface_torque_peak"] < 1e-6 * host["left_line.latch_torque_peak"]


@pytest.mark.parametrize("fixed_step", [1e-3, None])
def test_a_latch_that_an_event_commands_has_one_row_with_it(fixed_step):
    """Rule: at a fixed step, where latches have no row of their own, the event's is there all the same."""
    events = [{"name": "caught", "time": 0.5, "set": {"HL": {"latch_command": 1}}}]
    assembly = assemble(read_scene("latching.toml", latching(events).tree))
    result = run(assembly, None, Settings(1e-3, fixed_step=fixed_step)).result
    assert result.events[0][0] == pytest.approx(0.5, abs=1e-9)
    (row,) = np.flatnonzero(np.diff(result.time) < 1e-7)
    assert result.time[row] == pytest.approx(0.5, abs=1e-9)
