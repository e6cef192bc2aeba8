"""Hinged panels of the catalogue: a plate and two equal arms on every hinge line; the workbench panel.

Frames: x outboard, y along the hinge lines, z normal; origin in the middle of the body's inboard hinge line.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from ..flexible.beam_frame import BeamSection
from ..flexible.finite_elements import FiniteElementModel, Plate
from ..flexible.panel import HingeArm, Panel, panel_model
from .body import CatalogueBody
from .data_files import catalogue_data

HingeLines = Mapping[str, Literal["inboard", "outboard"]]
SIDES = (("left", 1.0), ("right", -1.0))


def plate(data: Mapping[str, Any]) -> Plate:
    """Plate of a data table."""
    return Plate(
        data["length"], data["width"], data["areal_mass"], tuple(data["bending"]), tuple(data["membrane"])
    )


_ARM_STIFFNESSES = ("axial", "bending_y", "bending_z", "torsion")


def rigid_arm(arm: Mapping[str, float]) -> dict[str, float]:
    """The arm without its stiffnesses, for wings whose latches hold the compliance of the hinge fittings."""
    return {name: value for name, value in arm.items() if name not in _ARM_STIFFNESSES}


def hinge_arms(arm: Mapping[str, float], lines: HingeLines, point_mass: float) -> tuple[HingeArm, ...]:
    """Arms at both sides of every named hinge line with a mass (kg) at each attachment point.

    An arm without stiffnesses is a rigid link.
    """
    flexible = set(_ARM_STIFFNESSES) <= arm.keys()
    section = BeamSection(*(arm[k] for k in _ARM_STIFFNESSES)) if flexible else None
    return tuple(
        HingeArm(f"{line}_{side}", sign * arm["y"], edge, arm["length"], section, point_mass, arm["patch"])
        for line, edge in lines.items()
        for side, sign in SIDES
    )


def hinged_panel(
    plate_data: Mapping[str, Any],
    arm: Mapping[str, float],
    lines: HingeLines,
    point_mass: float,
    element_size: float = 0.05,
) -> FiniteElementModel:
    """Panel of data tables with arms on the named hinge lines and a node "center" in the plate's middle."""
    return panel_model(
        Panel(
            plate=plate(plate_data),
            arms=hinge_arms(arm, lines, point_mass),
            nodes={"center": (arm["length"] + 0.5 * plate_data["length"], 0.0)},
            plate_start=arm["length"],
            element_size=element_size,
        )
    )


def workbench_plate_panel(lines: HingeLines, point_mass: float) -> FiniteElementModel:
    """Plate and arms of the workbench panel, which other wings have with other hinge lines and hardware."""
    data = catalogue_data("workbench")
    return hinged_panel(data["plate"], data["arm"], lines, point_mass)


def workbench_panel_model() -> FiniteElementModel:
    """Finite elements of the workbench panel: points "hl_left", "hl_right" on the hinge line and "center"."""
    return workbench_plate_panel({"hl": "inboard"}, catalogue_data("workbench")["hardware"]["point_mass"])


def workbench_bare_model() -> FiniteElementModel:
    """The workbench panel without the hardware on its hinge line."""
    return workbench_plate_panel({"hl": "inboard"}, 0.0)


WORKBENCH = {"workbench_panel": CatalogueBody(workbench_panel_model, ("hl_left", "hl_right"), ("center",))}
