"""What pictures add to geometry: boxes of known mass properties, thickness of sandwiches, marks of a wing."""

from __future__ import annotations

import numpy as np
import pytest

import orchestrator as fanfold
from orchestrator.views.report.scene3d.content import content
from orchestrator.views.report.scene3d.looks import spacecraft, thickness


def checked(**settings):
    return fanfold.load("amos3", settings=settings).check()


def test_a_box_has_the_inertia_that_it_is_drawn_for():
    """Closed form: moments m (b^2 + c^2) / 12 of a box 3 x 2 x 1 m, about its centre of mass."""
    free = {"mass": 120.0, "center_of_mass": [-1.5, 0.0, 0.2], "inertia": [50.0, 100.0, 130.0]}
    base = checked(**{"base.free": free}).base.model_copy(update={"size": None})
    corners = spacecraft(base).positions
    np.testing.assert_allclose(np.ptp(corners, axis=0), [3.0, 2.0, 1.0], rtol=1e-12)
    np.testing.assert_allclose(corners.mean(axis=0), free["center_of_mass"], atol=1e-12)


def test_a_fixed_box_touches_the_wing():
    """Its side along x has the points of the wing in its middle; without a size there is none."""
    base = checked().base
    corners = spacecraft(base).positions
    np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [[-2, -1, -1], [0, 1, 1]])
    assert spacecraft(base.model_copy(update={"size": None})) is None


def test_thickness_of_a_sandwich():
    """Two skins of 0.2 mm on a core of 20 mm: their mid-planes are 20.2 mm apart, to a share of (t/d)^2 / 6."""
    wing = fanfold.Scene("wing", until="1 s")
    base = wing.base(points={"root": (0.0, 0.0, 0.0)})
    sandwich = {"skin": "0.2 mm", "core": "20 mm", "youngs_modulus": "70 GPa", "poisson_ratio": 0.3}
    panel = {
        "length": 2.0,
        "width": 1.0,
        "areal_mass": 3.0,
        "sandwich": sandwich,
        "arms": [{"name": "arm", "y": 0.0}],
    }
    body = wing.body("panel", panel=panel)
    wing.hinge_line("HL", base, body, axis="+y", aligned_angle="90 deg", hinges={"hinge": ("root", "arm")})
    scene = wing.check()
    assert thickness(scene, "panel") == pytest.approx(20.2e-3, rel=(0.2 / 20.2) ** 2)
    assert thickness(scene, "base") == 0.0


@pytest.mark.filterwarnings("ignore:.*W-not-opened")  # it ends before
def test_a_free_spacecraft_is_a_box_in_the_page():
    """In place of the plane through its points that a run records."""
    wing = fanfold.load("amos3", variant="free")
    result = fanfold.simulate(wing, rigid="all", until=0.01, estimate=False)
    (one,) = content([result], "A", ["A"]).data["results"]
    (base,) = [body for body in one["bodies"] if body["is_base"]]
    assert base["nodes"]["shape"] == [8, 3]
