"""The way from the start to the deployed configuration: its ends are those of the scene, loops stay closed."""

from __future__ import annotations

import numpy as np
import pytest

import orchestrator as fanfold


@pytest.mark.parametrize(("name", "tolerance"), [("amos3", 1e-12), ("antenna-unit", 1e-6)])
def test_it_leads_from_the_start_to_the_deployed_poses(name, tolerance):
    """Places by the path of hinge lines, and of loops closed by sixteen stages, as the check draws them."""
    scene = fanfold.load(name).check()
    way = scene.way([k / 16 for k in range(17)])
    for found, poses in ((way[0], scene.poses), (way[-1], scene.deployed.extended.poses)):
        for body, pose in poses.items():
            np.testing.assert_allclose(found[body].position, pose.position, atol=tolerance)


def test_hinges_stay_together_on_the_way():
    """Points of both bodies of every hinge are one place, and angles rise in proportion."""
    found = fanfold.check_scene("amos3", rigid="all")
    scene, way = found.placed, found.opening
    for poses in scene.way([0.3, 0.8]):
        for line in scene.hinge_lines:
            for hinge in line.hinges:
                ends = [
                    poses[body].place(scene.points[body][point])
                    for body, point in ((line.inboard, hinge.inboard), (line.outboard, hinge.outboard))
                ]
                np.testing.assert_allclose(*ends, atol=1e-12)
    middle = way.time.size // 2
    assert way.time[[0, middle, -1]].tolist() == [0.0, 50.0, 100.0]
    np.testing.assert_allclose(np.rad2deg(way.signal("hl2_left", "angle")[middle]), 90.0)
