"""Run in a process of its own: deployments, the library of the coupling one with sanitizers; prints steps.

    python sanitized_runs.py LIBRARY

The sanitizers' run-time library has to be preloaded, as Python has none. Repository root on PYTHONPATH.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim import coupling
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import run
from orchestrator.scene import find_scene, load_scene

EVENTS = """
[[hinge_line]]
name = "HL"
latch.kind = "kinematic"

[[event]]
name = "motor_fails"
when = { component = "HL", variable = "angle", above = "100 deg" }
set = { HL = { motor_stiffness = 0 } }
"""
"""Of the workbench: an impulse at its latch-up, and a condition on an observation."""


def main() -> None:
    """Flexible panels and a scene with loops and contact for a moment; rigid panels through an event and a latch-up."""
    coupling.native_library = lambda: Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        wing = Path(folder) / "wing.toml"
        wing.write_text(f"extends = '{find_scene('workbench')}'\n{EVENTS}", encoding="utf-8")
        runs = [
            (wing, 0.02, [], Settings(snapshot_every=0.01)),
            (find_scene("bepicolombo"), 0.005, ["all"], Settings()),
            (wing, 5.0, ["all"], Settings(tolerance=1e-3)),
            (wing, 0.1, ["all"], Settings(fixed_step=7e-3, order=2)),
            (wing, 0.1, ["all"], Settings(step_plan=[[5e-3] * 5])),
        ]
        for scene, until, rigid, settings in runs:
            outcome = run(assemble(load_scene(scene), rigid=rigid), None, settings, until)
            print(outcome.costs.steps, len(outcome.result.events))


if __name__ == "__main__":
    main()
