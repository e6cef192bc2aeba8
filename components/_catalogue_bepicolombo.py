"""Finite elements of the BepiColombo MPO wing: inboard panel with its yoke, outboard panel."""

from __future__ import annotations

from ._catalogue_body import CatalogueBody
from ._catalogue_data import catalogue_data
from ._catalogue_joined import joined
from ._catalogue_panel import SIDES, hinge_arms, plate, workbench_plate_panel
from ._catalogue_yoke import parallel_yoke, yoke_tube
from .panel import HingeArm, Panel, panel_model
from .reduction import FiniteElementModel


def inboard_model() -> FiniteElementModel:
    """Plate with hinge line 2 outboard and two tubes from its inboard edge to hinge line 1.

    The tubes end in rigid inserts as the hinge arms do. Nodes: "center" of the plate and "hold_down", the
    point of the plate that its hold-down touches.
    """
    data, common = catalogue_data("bepicolombo"), catalogue_data("workbench")
    yoke, arm = data["yoke"], common["arm"]
    sheet = plate(common["plate"] | data["plate"])
    seats = tuple(
        HingeArm(f"yoke_{side}", sign * yoke["foot_y"], length=0.0, patch=arm["patch"])
        for side, sign in SIDES
    )
    center = yoke["length"] + 0.5 * sheet.length
    panel = Panel(
        plate=sheet,
        arms=(*seats, *hinge_arms(arm, {"hl2": "outboard"}, 0.0)),
        nodes={"center": (center, 0.0), "hold_down": (data["hold_down"]["x"], 0.0)},
        plate_start=yoke["length"],
    )
    return joined(panel_model(panel), parallel_yoke(yoke, yoke_tube()))


def outboard_model() -> FiniteElementModel:
    """The workbench panel with hinge line 2 inboard, node "center"; the hinges' hardware is all on this side."""
    return workbench_plate_panel({"hl2": "inboard"}, catalogue_data("workbench")["hardware"]["point_mass"])


BEPICOLOMBO = {
    "bepicolombo_inboard": CatalogueBody(
        inboard_model, ("hl1_left", "hl1_right", "hl2_left", "hl2_right"), ("center", "hold_down")
    ),
    "bepicolombo_outboard": CatalogueBody(outboard_model, ("hl2_left", "hl2_right"), ("center",)),
}
