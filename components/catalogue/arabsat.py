"""Finite elements of the ARABSAT wing: yoke, four equal panels, tip panel."""

from __future__ import annotations

from ..flexible.finite_elements import FiniteElementModel
from .body import CatalogueBody
from .data_files import catalogue_data
from .panel import HingeLines, hinged_panel
from .yoke import a_frame_yoke, yoke_tube

_ELEMENT_SIZE = 0.1  # m; half of it changes the lowest frequencies by 3e-3 at most


def yoke_model() -> FiniteElementModel:
    """Finite elements of the yoke: an A of three equal tubes, apex "hl1", feet "hl2_left" and "hl2_right"."""
    data = catalogue_data("arabsat")
    return a_frame_yoke(data["yoke"], yoke_tube(data["tube"]))


def inner_panel_model() -> FiniteElementModel:
    """Finite elements of panels 1 to 4: hinge lines "inboard" and "outboard", node "center"."""
    return _panel({"inboard": "inboard", "outboard": "outboard"})


def tip_panel_model() -> FiniteElementModel:
    """Finite elements of panel 5, which has no outboard arms."""
    return _panel({"inboard": "inboard"})


def _panel(lines: HingeLines) -> FiniteElementModel:
    data, common = catalogue_data("arabsat"), catalogue_data("workbench")
    plate, arm = (common[table] | data[table] for table in ("plate", "arm"))
    return hinged_panel(plate, arm, lines, data["hardware"]["point_mass"], _ELEMENT_SIZE)


ARABSAT = {
    "arabsat_yoke": CatalogueBody(yoke_model, ("hl1", "hl2_left", "hl2_right"), ("guide",)),
    "arabsat_panel": CatalogueBody(
        inner_panel_model, ("inboard_left", "inboard_right", "outboard_left", "outboard_right"), ("center",)
    ),
    "arabsat_panel_tip": CatalogueBody(tip_panel_model, ("inboard_left", "inboard_right"), ("center",)),
}
