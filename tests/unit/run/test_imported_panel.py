"""A panel of bars through every import path: the same deployment, whatever program's files it came from."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
import tomli_w

import orchestrator as fanfold
from components.flexible.beam_frame import Member, beam_frame
from components.imported.matrices import write_npz
from orchestrator.scene import find_scene
from tests.references.imports.frame_model import SECTION, frame_data
from tests.references.imports.matrix_writers import WRITERS

CORNERS = {
    "hl_left": (0, 0.565, 0),
    "hl_right": (0, -0.565, 0),
    "right": (1.8, -0.565, 0),
    "left": (1.8, 0.565, 0),
}
BARS = [
    ("hl_left", "hl_right"),
    ("hl_right", "right"),
    ("right", "left"),
    ("left", "hl_left"),
    ("hl_left", "right"),
]
LATCHED = 1.3
"""s; with this motor the line latches at 1.137 s."""


TOLERANCE = 1e-3
ITERATED = 1e-6
"""Tolerance of iterations, the largest there is."""


def deployed(folder, files):
    """The workbench with this panel in place of its own, and a stronger motor."""
    tree = tomllib.loads(find_scene("workbench").read_text(encoding="utf-8"))
    tree["hinge_line"][0]["motor"] = {"stowed": "40 N.m", "deployed": "30 N.m"}
    table = (
        {name: str(path) for name, path in files.items()} if isinstance(files, dict) else {"file": str(files)}
    )
    points = {"attachment_points": {"hl_left": 1, "hl_right": 2}}
    tree["body"] = [{"name": "panel", "fixed_interface_modes": 6, "import": table | points}]
    (folder / "scene.toml").write_text(tomli_w.dumps(tree), encoding="utf-8")
    return fanfold.simulate(folder / "scene.toml", until=LATCHED, tolerance=TOLERANCE, estimate=False)


@pytest.fixture(scope="module")
def data():
    return frame_data(beam_frame(CORNERS, [Member(a, b, SECTION, 3) for a, b in BARS]))


@pytest.fixture(scope="module")
def own(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("own")
    write_npz(folder / "panel.npz", data)
    return deployed(folder, folder / "panel.npz")


@pytest.mark.parametrize("program", WRITERS)
def test_a_panel_deploys_the_same_by_every_path(tmp_path, data, own, program):
    """Latch times to 1e-9, and torques to what the digits of the files leave: DMIG has ten.

    Or to what iterations leave in two runs, of which one may have taken one more.
    """
    writer, digits = WRITERS[program]
    other = deployed(tmp_path, writer(tmp_path, data))
    assert other.latch_times["HL"] == pytest.approx(own.latch_times["HL"], rel=1e-9)
    for signal in ("latch_torque", "angle"):
        mine, theirs = (run.signal("hinge_left", signal) for run in (own, other))
        np.testing.assert_allclose(theirs, mine, atol=max(5.0 * digits, 2.0 * ITERATED) * np.abs(mine).max())


def test_a_body_without_rows_of_stress_is_told(own):
    with pytest.raises(fanfold.FanfoldError, match=r"panel: .*stresses"):
        fanfold.body_outputs(own, "panel")
