"""Bodies written for other programs: what is read back is the same body, to rounding, and deploys the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import orchestrator as fanfold
from components.imported.reduced import few_samples
from orchestrator.cli.main import main
from orchestrator.scene import SceneError, find_scene

PANEL = 'body = [{ name = "panel", catalogue = "workbench_panel", fixed_interface_modes = 10 }]\n'
LATCHED = 4.5
"""s; the workbench latches at 4.27 s."""


@pytest.mark.parametrize("name", ["panel.npz", "panel.op4", "panel.asm"])
def test_a_body_read_back_deploys_the_same(tmp_path, name):
    """Frequencies of a panel of 9,330 degrees of freedom have ten digits, so its deployment has nine.

    The slowest mode, the panel on its motor, takes the round-off of the stiffer ones.
    """
    text = find_scene("workbench").read_text(encoding="utf-8")
    assert PANEL in text
    entry = fanfold.export_body("workbench", "panel", tmp_path / name).to_toml()
    wing = tmp_path / "wing.toml"
    wing.write_text(text.replace(PANEL, "") + entry, encoding="utf-8")
    # strains to second order stay behind
    first_order = fanfold.Scene.load("workbench").with_settings({"body.panel.second_order_modes": 0})
    own, other = (fanfold.modes(scene).frequencies for scene in (first_order, wing))
    np.testing.assert_allclose(other, own, rtol=1e-9, atol=1e-10 * own[1])
    if name != "panel.op4":
        own, other = (fanfold.simulate(scene, until=LATCHED, estimate=False) for scene in (first_order, wing))
        assert other.latch_times["HL"] == pytest.approx(own.latch_times["HL"], rel=1e-9)
        for signal in ("latch_torque", "angle"):
            mine, theirs = (run.signal("hinge_left", signal) for run in (own, other))
            # the last row has no step after it by which what rings in stiff joints is told
            np.testing.assert_allclose(theirs[:-1], mine[:-1], atol=1e-8 * np.abs(mine).max())


def test_few_samples_have_all_sums_of_second_order():
    """Against the sums over all samples, by rounding."""
    rng = np.random.default_rng(1)
    masses, positions = rng.uniform(0.1, 2.0, 400), rng.standard_normal((400, 3))
    displacement = rng.standard_normal((1200, 5))
    few = few_samples(masses, positions, displacement)
    assert len(few.masses) == 4 + 3 * 5
    assert np.all(few.masses > 0.0)

    def sums(masses, positions, displacement):
        fields = np.column_stack([np.ones(len(masses)), positions, displacement.reshape(len(masses), -1)])
        return fields.T @ (masses[:, None] * fields)

    exact = sums(masses, positions, displacement)
    found = sums(few.masses, few.positions, few.displacement.toarray())
    np.testing.assert_allclose(found, exact, atol=1e-13 * np.abs(exact).max())


@pytest.mark.parametrize(
    ("body", "name", "told"),
    [
        ("wing", "wing.npz", "'wing'"),
        ("panel1", "panel1.mat", ".npz, .op4, .asm"),
    ],
)
def test_what_cannot_be_written_is_told(tmp_path, body, name, told):
    with pytest.raises(SceneError, match=told):
        fanfold.export_body("amos3", body, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_rigid_body_is_told(tmp_path):
    scene = Path(__file__).parents[2] / "scenes" / "light_root_latch.toml"
    with pytest.raises(SceneError, match="rigid"):
        fanfold.export_body(scene, fanfold.load(scene).bodies[0], tmp_path / "body.npz")


def test_command_prints_the_entry_that_reads_it_back(tmp_path):
    """Interface: as many modes as asked for, numbers of nodes by point."""
    path = tmp_path / "yoke.npz"
    run = CliRunner().invoke(main, ["export-body", "amos3", "yoke", "-o", str(path), "--modes", "3"])
    assert run.exit_code == 0
    assert path.exists()
    assert "fixed_interface_modes = 3" in run.output
    assert "hl1 = 1" in run.output
