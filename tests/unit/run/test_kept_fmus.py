"""FMUs that serve several runs: reset, they are those that were loaded."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from orchestrator.run.run import as_fmus, kept_fmus, run
from orchestrator.run.simulation import Options
from orchestrator.scene import find_scene, load_scene
from tests.references.native_fmus import needs_native


@needs_native
@pytest.mark.parametrize("backend", ["native", pytest.param("python", marks=pytest.mark.thorough)])
def test_a_run_with_fmus_that_ran_before_is_that_with_new_ones(backend):
    """Equality to the bit of all signals, through a latch-up of the first run that the second does not have.

    The second starts elsewhere as well, with another spring: its FMUs are those of the first with other start values.
    """
    options = Options(rigid=("all",), step=0.02, backend=backend)
    scene = find_scene("workbench")
    near = [("hinge_line.HL.start_angle", "175 deg")]  # half a second from its latch
    changes = [("hinge_line.HL.start_angle", "30 deg"), ("hinge_line.HL.motor.stowed", "3 N.m")]
    first, second = (options.assemble(load_scene(scene, [], laid)) for laid in (near, changes))
    settings = options.settings(first)

    def signals(assembly, load, end):
        result = run(assembly, None, settings, end, load=load).result
        assert bool(result.events) == (assembly is first)
        return [result.signal(name, of) for name in result.components for of in result.variables(name)]

    with kept_fmus(backend) as load:
        latched = signals(first, load, 2.0)
        again = signals(second, load, 0.5)
    new = signals(second, partial(as_fmus, backend=backend), 0.5)
    assert len(latched) == len(again) == len(new) > 20
    assert all(np.array_equal(a, b) for a, b in zip(again, new, strict=True))
