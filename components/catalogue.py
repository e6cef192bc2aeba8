"""Bodies of the AMOS-3 wing from its data file, flexible and as rigid twins, with a cache of reductions.

Frames: x outboard, y along the hinge lines, z normal; origin in the middle of the body's inboard hinge line.
A rigid twin has the same points as the flexible body and the mass properties of the data sheet.
"""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
import tomllib
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.resources import files
from math import hypot, sqrt
from pathlib import Path
from typing import Any, Literal
from zipfile import BadZipFile

import numpy as np

from ._component import ComponentError
from .beam_frame import BeamSection, Member, beam_frame, tube_section
from .modal import ModalData
from .panel import HingeArm, Panel, Plate, panel_model
from .reduction import FiniteElementModel, craig_bampton

_SOURCES = ("_component.py", "_frames.py", "modal.py", "reduction.py", "panel.py", "beam_frame.py")
_UNREADABLE = (OSError, EOFError, ValueError, KeyError, BadZipFile, ComponentError)


def values(table: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of a data table whose entries are `{value, unit, source}`, sub-tables included."""
    return {k: v["value"] if "value" in v else values(v) for k, v in table.items()}


def amos3_data() -> dict[str, Any]:
    """Catalogue values of the AMOS-3 wing, SI."""
    text = (files(__package__) / "data" / "amos3.toml").read_text(encoding="utf-8")
    return values(tomllib.loads(text))


def _panel(hinge_lines: Mapping[str, Literal["inboard", "outboard"]], point_mass: float) -> Panel:
    """Panel of the data file with two arms on each named hinge line and a node in the plate's middle."""
    data = amos3_data()
    plate, arm = data["plate"], data["arm"]
    arms = tuple(
        HingeArm(
            name=f"{line}_{side}",
            y=sign * arm["y"],
            edge=edge,
            length=arm["length"],
            section=BeamSection(*(arm[k] for k in ("axial", "bending_y", "bending_z", "torsion"))),
            point_mass=point_mass,
            patch=arm["patch"],
        )
        for line, edge in hinge_lines.items()
        for side, sign in (("left", 1.0), ("right", -1.0))
    )
    return Panel(
        plate=Plate(
            plate["length"],
            plate["width"],
            plate["areal_mass"],
            tuple(plate["bending"]),
            tuple(plate["membrane"]),
        ),
        arms=arms,
        nodes={"center": (arm["length"] + 0.5 * plate["length"], 0.0)},
        plate_start=arm["length"],
    )


def workbench_panel_model() -> FiniteElementModel:
    """Finite elements of the workbench panel: points "left", "right" on the hinge line and "center"."""
    panel = _panel({"hl": "inboard"}, amos3_data()["arm"]["point_mass_workbench"])
    return panel_model(panel)


def amos3_panel1_model() -> FiniteElementModel:
    """Finite elements of panel 1: hinge line 2 inboard, hinge line 3 outboard, node "center"."""
    lines: dict[str, Literal["inboard", "outboard"]] = {"hl2": "inboard", "hl3": "outboard"}
    return panel_model(_panel(lines, amos3_data()["arm"]["point_mass_flight"]))


def amos3_panel2_model() -> FiniteElementModel:
    """Finite elements of panel 2: hinge line 3 inboard, node "center"."""
    return panel_model(_panel({"hl3": "inboard"}, amos3_data()["arm"]["point_mass_flight"]))


def amos3_yoke_model() -> FiniteElementModel:
    """Finite elements of the yoke: an A of three equal tubes, apex "hl1", feet "hl2_left" and "hl2_right".

    Node "guide" is the middle of the left leg. What is not tube is spread evenly along a stretch of both
    legs; the stretch follows from mass, centre of mass and inertia, see `_loaded_stretch`.
    """
    yoke = amos3_data()["yoke"]
    tube = tube_section(
        yoke["tube_diameter"],
        yoke["tube_wall"],
        yoke["youngs_modulus"],
        yoke["shear_modulus"],
        yoke["density"],
    )
    length, foot = yoke["length"], yoke["foot_y"]
    low, high, line_mass = _loaded_stretch(yoke, tube)
    joints: dict[str, tuple[float, float, float]] = {"hl1": (0.0, 0.0, 0.0)}
    members = []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        middle = "guide" if side == "left" else "middle_right"
        names = ("hl1", f"low_{side}", middle, f"high_{side}", f"hl2_{side}")
        for name, x in zip(names[1:], (low, 0.5 * length, high, length), strict=True):
            joints[name] = (x, sign * foot * x / length, 0.0)
        loads = (0.0, line_mass, line_mass, 0.0)
        for k, load in enumerate(loads):
            members.append(Member(names[k], names[k + 1], tube, 4, load))
    members.append(Member("hl2_left", "hl2_right", tube, 10))
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
    half = sqrt(3.0 * spread) if spread > 0.0 else -1.0
    if not 0.0 <= half <= min(middle, length - middle):
        raise ComponentError("the yoke's tubes leave no even spread with its centre of mass and inertia")
    return middle - half, middle + half, mass / (4.0 * half * leg / length)


def workbench_panel(fixed_interface_modes: int = 10) -> ModalData:
    """Workbench panel, attachment points "hl_left" and "hl_right"; 10 fixed-interface modes make 16."""
    return _reduced(workbench_panel_model, ("hl_left", "hl_right"), ("center",), fixed_interface_modes)


def amos3_yoke(fixed_interface_modes: int = 10) -> ModalData:
    """Yoke with three attachment points; 10 fixed-interface modes make 22 flexible ones."""
    points = ("hl1", "hl2_left", "hl2_right")
    return _reduced(amos3_yoke_model, points, ("guide",), fixed_interface_modes)


def amos3_panel1(fixed_interface_modes: int = 10) -> ModalData:
    """Panel 1 with four attachment points; 10 fixed-interface modes make 28 flexible ones."""
    points = ("hl2_left", "hl2_right", "hl3_left", "hl3_right")
    return _reduced(amos3_panel1_model, points, ("center",), fixed_interface_modes)


def amos3_panel2(fixed_interface_modes: int = 10) -> ModalData:
    """Panel 2 with two attachment points; 10 fixed-interface modes make 16 flexible ones."""
    return _reduced(amos3_panel2_model, ("hl3_left", "hl3_right"), ("center",), fixed_interface_modes)


def amos3_yoke_rigid() -> ModalData:
    """Rigid twin of the yoke."""
    return _rigid_twin(amos3_yoke(0), "yoke")


def amos3_panel1_rigid() -> ModalData:
    """Rigid twin of panel 1."""
    return _rigid_twin(amos3_panel1(0), "panel1")


def amos3_panel2_rigid() -> ModalData:
    """Rigid twin of panel 2."""
    return _rigid_twin(amos3_panel2(0), "panel2")


def _rigid_twin(flexible: ModalData, name: str) -> ModalData:
    """Mass, centre of mass and inertia about y of the data sheet, the rest of the flexible body.

    The inertia about z changes as much as that about y, as the perpendicular-axis theorem wants it.
    """
    sheet = amos3_data()[name]
    about_x, about_y, about_z = np.diag(flexible.inertia)
    return ModalData.rigid(
        sheet["mass"],
        (sheet["center_of_mass"], 0.0, 0.0),
        np.diag([about_x, sheet["inertia"], about_z + sheet["inertia"] - about_y]),
        dict(zip(flexible.point_names, flexible.point_positions, strict=True)),
        flexible.display_positions,
        flexible.display_faces,
    )


def _reduced(
    build: Callable[[], FiniteElementModel],
    attachment_points: tuple[str, ...],
    nodes: tuple[str, ...],
    fixed_interface_modes: int,
) -> ModalData:
    """Reduced body, from the cache if it is there."""
    key = {
        "body": build.__name__,
        "data": amos3_data(),
        "attachment_points": attachment_points,
        "nodes": nodes,
        "modes": fixed_interface_modes,
    }
    return cached(lambda: craig_bampton(build(), attachment_points, fixed_interface_modes, nodes), key)


def cache_directory() -> Path:
    """Where reductions are kept: FANFOLD_CACHE, else the user's cache directory."""
    if chosen := os.environ.get("FANFOLD_CACHE"):
        return Path(chosen)
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path.home() / ".cache") / "fanfold"


def cached(build: Callable[[], ModalData], key: Mapping[str, Any]) -> ModalData:
    """What `build` returns, kept in a file named by the content of `key` and of the sources that build it.

    A file that cannot be read is built again; a directory that cannot be written to costs only the time.
    """
    path = cache_directory() / f"modal-{_digest(key)}.npz"
    with suppress(*_UNREADABLE), np.load(path) as stored:
        return ModalData.from_arrays(stored)
    result = build()
    with suppress(OSError):
        _write(path, result)
    return result


def _digest(key: Mapping[str, Any]) -> str:
    """Hash of the key and of the source files that turn it into modal data."""
    content = hashlib.sha256(json.dumps(key, sort_keys=True).encode())
    for name in (*_SOURCES, Path(__file__).name):
        content.update((files(__package__) / name).read_bytes())
    return content.hexdigest()[:24]


def _write(path: Path, data: ModalData) -> None:
    """Write at once or not at all, so that a parallel run never reads half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".tmp", delete=False) as file:
        np.savez(file, **data.to_arrays())
    os.replace(file.name, path)
