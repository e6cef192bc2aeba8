"""Plain steps in C against those of the master in Python, which define them: same steps, same rows, same events.

Both make the same operations in the same order, so that nothing differs but where a compiler contracts a product and a
sum: by rounding, 1e-12 of a signal's largest value over these runs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from orchestrator.cosim.native.library import library

from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.run import Outcome, kept_fmus, run
from orchestrator.scene import find_scene, load_scene

pytestmark = pytest.mark.skipif(library() is None, reason="there is no C compiler")

EVENTS = """
[[hinge_line]]
name = "HL"
latch.kind = "{latch}"

[[event]]
name = "motor_fails"
when = {{ component = "HL", variable = "angle", above = "100 deg" }}
set = {{ HL = {{ motor_stiffness = 0 }} }}

[[event]]
name = "brake"
time = "1.2345 s"
set = {{ HL = {{ friction_preload = "0.3 N.m" }} }}
"""
"""Of the workbench: its latch, a condition on an observation, and an instant."""


def outcomes(scene, settings: Settings, until: float, **around) -> tuple[Outcome, Outcome]:
    """A run by both, with the same FMUs."""
    assembly = assemble(scene, **around)
    with kept_fmus() as load:
        by_python, by_c = (
            run(assembly, None, replace(settings, compiled=compiled), until, load=load)
            for compiled in (False, True)
        )
    return by_python, by_c


def assert_same(by_python: Outcome, by_c: Outcome) -> None:
    assert by_c.segments == by_python.segments
    counts = [(o.costs.steps, o.costs.iterations, o.costs.rejected) for o in (by_python, by_c)]
    assert counts[0] == counts[1]
    assert by_c.result.events == by_python.result.events
    for name in by_python.result.components:
        for variable in by_python.result.variables(name):
            expected, found = (o.result.signal(name, variable) for o in (by_python, by_c))
            size = np.abs(expected).max(initial=0.0)
            np.testing.assert_allclose(
                found, expected, rtol=0.0, atol=1e-12 * size, err_msg=f"{name}.{variable}"
            )


@pytest.mark.parametrize(
    ("name", "until", "rigid"),
    [("amos3", 8.0, ["all"]), ("amos3", 0.3, []), ("bepicolombo", 2.0, ["all"]), ("antenna-unit", 0.1, [])],
)
def test_scenes(name, until, rigid):
    """Latch-ups, loops, dampers, contact at the stack, motion laws that change their form, order 4."""
    by_python, by_c = outcomes(load_scene(find_scene(name)), Settings(tolerance=1e-4), until, rigid=rigid)
    assert by_python.costs.steps > 50
    assert_same(by_python, by_c)


@pytest.mark.parametrize(
    ("latch", "settings"),
    [
        ("spring", Settings(tolerance=1e-3)),
        ("kinematic", Settings(tolerance=1e-4)),
        ("spring", Settings(tolerance=1e-5, order=2)),
        ("spring", Settings(fixed_step=7e-3)),
        ("spring", Settings(step_plan=[[5e-3] * 300, [5e-3] * 10])),
    ],
    ids=["loose", "kinematic", "order 2", "fixed step", "plan that ends early"],
)
def test_latch_ups_and_events(tmp_path, latch, settings):
    """At an instant, on a condition and at a latch, however steps are chosen."""
    path = tmp_path / "wing.toml"
    text = f"extends = '{find_scene('workbench')}'\n{EVENTS.format(latch=latch)}"
    path.write_text(text, encoding="utf-8")
    by_python, by_c = outcomes(load_scene(path), settings, 5.0, rigid=["all"])
    assert len(by_python.result.events) == 3
    assert_same(by_python, by_c)
