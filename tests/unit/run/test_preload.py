"""Starting at rest: the deployment that a search for static equilibrium before the run leads to, without one."""

from __future__ import annotations

import numpy as np
import pytest

from components import REGISTRY, Instance
from fmus import native_library
from orchestrator.assembly.assemble import assemble
from orchestrator.cosim.settings import Settings
from orchestrator.run.preload import started_at_rest
from orchestrator.run.run import run
from orchestrator.scene import find_scene, load_scene

pytestmark = pytest.mark.skipif(native_library() is None, reason="takes minutes without native FMUs")


@pytest.fixture(scope="module", params=["all", ""], ids=["rigid", "flexible"])
def assemblies(request):
    """AMOS-3 with its search before the run, and started at rest instead."""
    scene = load_scene(find_scene("amos3"))
    mean, tools = (assemble(scene, {request.param} - {""}, (), mode) for mode in ("mean", "endpoint"))
    return mean, started_at_rest(mean, mean), started_at_rest(tools, mean)


def test_no_search_is_left_to_do(assemblies):
    searching, resting, of_tools = assemblies
    assert searching.preload
    assert not resting.preload
    assert not of_tools.preload


def test_the_same_deployment_follows(assemblies):
    """Against the run that searches, through the first swings of the cable loops: to the search's own residual."""
    before, after = (run(a, None, Settings(1e-3, a.largest_step), 0.3).result for a in assemblies[:2])
    for signal in (
        ("spacecraft", "interface_force"),
        ("hl3_left", "angular_rate"),
        ("panel1", "frame_position"),
    ):
        expected = before.signal(*signal)
        at_same_times = [
            np.interp(before.time, after.time, v) for v in np.atleast_2d(after.signal(*signal).T)
        ]
        off = np.abs(np.atleast_2d(expected.T) - at_same_times).max()
        assert off <= 1e-4 * np.abs(expected).max()


def test_without_it_the_wing_starts_with_a_jolt(assemblies):
    """Rule: what is left out matters; bodies as they are placed are not where the preload has them."""
    searching, resting, _ = assemblies
    starts = {p.name: (p.start, q.start) for p, q in zip(searching.parts, resting.parts, strict=True)}
    placed, rested = (np.array(start["initial_position"]) for start in starts["panel2"])
    assert np.abs(rested - placed).max() > 1e-6


def test_ports_of_connections_start_where_bodies_are(assemblies):
    """Rule: what a tool sees before it connects anything is the equilibrium as well."""
    searching, _, of_tools = assemblies
    parts = {part.name: part for part in of_tools.parts}
    for link in of_tools.links:
        (name, port), (connection, side) = link.body, link.connection
        body = Instance(REGISTRY[parts[name].kind](**parts[name].structure), parts[name].start)
        at = body.component.output_layout[f"{port}.position"]
        assert parts[connection].start[f"{side}.position"] == pytest.approx(body.outputs()[at], abs=1e-14)
    unsearched = next(part for part in searching.parts if part.name == "hl1_hinge").start["outboard.position"]
    assert np.abs(np.subtract(parts["hl1_hinge"].start["outboard.position"], unsearched)).max() > 1e-7
