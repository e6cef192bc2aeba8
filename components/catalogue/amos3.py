"""Finite elements of the AMOS-3 wing."""

from __future__ import annotations

from ..flexible.finite_elements import FiniteElementModel
from .body import CatalogueBody
from .data_files import catalogue_data
from .panel import workbench_plate_panel
from .yoke import a_frame_yoke, yoke_tube


def yoke_model() -> FiniteElementModel:
    """Finite elements of the yoke: an A of three equal tubes, apex "hl1", feet "hl2_left" and "hl2_right"."""
    return a_frame_yoke(catalogue_data("amos3")["yoke"], yoke_tube())


def panel1_model() -> FiniteElementModel:
    """Finite elements of panel 1: hinge line 2 inboard, hinge line 3 outboard, node "center"."""
    return workbench_plate_panel({"hl2": "inboard", "hl3": "outboard"}, _point_mass())


def panel2_model() -> FiniteElementModel:
    """Finite elements of panel 2: hinge line 3 inboard, node "center"."""
    return workbench_plate_panel({"hl3": "inboard"}, _point_mass())


def _point_mass() -> float:
    return float(catalogue_data("amos3")["hardware"]["point_mass"])


AMOS3 = {
    "amos3_yoke": CatalogueBody(yoke_model, ("hl1", "hl2_left", "hl2_right"), ("guide",)),
    "amos3_panel1": CatalogueBody(
        panel1_model, ("hl2_left", "hl2_right", "hl3_left", "hl3_right"), ("center",)
    ),
    "amos3_panel2": CatalogueBody(panel2_model, ("hl3_left", "hl3_right"), ("center",)),
}
