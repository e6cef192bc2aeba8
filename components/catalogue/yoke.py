"""Yokes of the catalogue as frames of tubes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import hypot, sqrt

from ..contract.component import ComponentError
from ..flexible.beam_frame import BeamSection, Member, beam_frame, tube_section
from ..flexible.finite_elements import FiniteElementModel
from .data_files import catalogue_data
from .panel import SIDES

_LEG_ELEMENTS, _BAR_ELEMENTS = 4, 10


def yoke_tube(changes: Mapping[str, float] | None = None) -> BeamSection:
    """Tube of data/tube.toml, with some of its values changed."""
    return tube_section(**{**catalogue_data("tube")["tube"], **(changes or {})})


def a_frame_yoke(yoke: Mapping[str, float], tube: BeamSection) -> FiniteElementModel:
    """An A of three equal tubes: apex "hl1", feet "hl2_left" and "hl2_right", middle of the left leg "guide".

    What is not tube is spread evenly along a stretch of both legs; the stretch follows from mass, centre of
    mass and inertia, see `_loaded_stretch`.
    """
    length, foot = yoke["length"], yoke["foot_y"]
    low, high, line_mass = _loaded_stretch(yoke, tube)
    joints: dict[str, tuple[float, float, float]] = {"hl1": (0.0, 0.0, 0.0)}
    members = []
    for side, sign in SIDES:
        middle = "guide" if side == "left" else "middle_right"
        names = ("hl1", f"low_{side}", middle, f"high_{side}", f"hl2_{side}")
        for name, x in zip(names[1:], (low, 0.5 * length, high, length), strict=True):
            joints[name] = (x, sign * foot * x / length, 0.0)
        loads = (0.0, line_mass, line_mass, 0.0)
        for k, load in enumerate(loads):
            members.append(Member(names[k], names[k + 1], tube, _LEG_ELEMENTS, load))
    members.append(Member("hl2_left", "hl2_right", tube, _BAR_ELEMENTS))
    return beam_frame(joints, members, points=("hl1", "hl2_left", "hl2_right", "guide"))


def _loaded_stretch(yoke: Mapping[str, float], tube: BeamSection) -> tuple[float, float, float]:
    """Ends (x, m) of the stretch of both legs with the non-structural mass, and that mass per m of leg.

    An even load of mean x and half-length h has the second moment m (x² + h²/3); mass, first and second
    moment of what the tubes lack give m, x and h. A tube of polar radius of gyration r adds, about y,
    r²/2 (1 + n²) per mass, n being the x component of the in-plane normal.
    """
    leg = hypot(yoke["length"], yoke["foot_y"])
    legs, bar = 2.0 * leg * tube.line_mass, 2.0 * yoke["foot_y"] * tube.line_mass
    length, center = yoke["length"], yoke["center_of_mass"]
    around_leg, around_bar = (
        0.5 * tube.gyration_radius**2 * (1.0 + n**2) for n in (yoke["foot_y"] / leg, 1.0)
    )
    mass = yoke["mass"] - legs - bar
    first = yoke["mass"] * center - 0.5 * length * legs - length * bar
    second = yoke["inertia"] + yoke["mass"] * center**2
    second -= legs * (length**2 / 3.0 + around_leg) + bar * (length**2 + around_bar) + mass * around_leg
    middle, spread = first / mass, second / mass - (first / mass) ** 2
    half = sqrt(3.0 * max(spread, 0.0))
    low, high = middle - half, middle + half
    if not 0.0 <= low < 0.5 * length < high <= length:
        raise ComponentError("the yoke's tubes leave no even spread with its centre of mass and inertia")
    return low, high, mass / (4.0 * half * leg / length)


def parallel_yoke(yoke: Mapping[str, float], tube: BeamSection) -> FiniteElementModel:
    """Two equal straight legs from "hl1_left", "hl1_right" to "yoke_left", "yoke_right" at x = length.

    What is not tube is spread evenly along the legs' axes, so that their inertia is that of rods.
    """
    line_mass = 0.5 * yoke["mass"] / yoke["length"]
    radius = tube.gyration_radius * sqrt(tube.line_mass / line_mass)
    section = replace(tube, line_mass=line_mass, gyration_radius=radius)
    joints, members = {}, []
    for side, sign in SIDES:
        for name, x in ((f"hl1_{side}", 0.0), (f"yoke_{side}", yoke["length"])):
            joints[name] = (x, sign * yoke["foot_y"], 0.0)
        members.append(Member(f"hl1_{side}", f"yoke_{side}", section, _LEG_ELEMENTS))
    return beam_frame(joints, members)
