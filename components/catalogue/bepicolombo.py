"""Finite elements of the BepiColombo MPO wing: inboard panel with its yoke, outboard panel.

Arms on hinge line 2 are rigid: the measured latch torque of that line holds the compliance of the fittings
(Bagnoli 2007, section 3.4.1.3 and equation 2.7).
"""

from __future__ import annotations

from ..flexible.finite_elements import FiniteElementModel
from ..flexible.joined import joined
from ..flexible.panel import HingeArm, Panel, panel_model
from .body import CatalogueBody
from .data_files import catalogue_data
from .panel import SIDES, hinge_arms, hinged_panel, plate, rigid_arm
from .yoke import parallel_yoke, yoke_tube


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
        arms=(*seats, *hinge_arms(rigid_arm(arm), {"hl2": "outboard"}, 0.0)),
        nodes={"center": (center, 0.0), "hold_down": (data["hold_down"]["x"], 0.0)},
        plate_start=yoke["length"],
    )
    return joined(panel_model(panel), parallel_yoke(yoke, yoke_tube()))


def outboard_model() -> FiniteElementModel:
    """The workbench plate with hinge line 2 inboard, node "center"; the hinges' hardware is all on this side."""
    data = catalogue_data("workbench")
    hardware = data["hardware"]["point_mass"]
    return hinged_panel(data["plate"], rigid_arm(data["arm"]), {"hl2": "inboard"}, hardware)


BEPICOLOMBO = {
    "bepicolombo_inboard": CatalogueBody(
        inboard_model, ("hl1_left", "hl1_right", "hl2_left", "hl2_right"), ("center", "hold_down")
    ),
    "bepicolombo_outboard": CatalogueBody(outboard_model, ("hl2_left", "hl2_right"), ("center",)),
}
