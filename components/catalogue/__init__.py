"""Bodies of solar-array wings from data files, flexible and as rigid twins, with a cache of reductions.

An entry is a function `entry(fixed_interface_modes, masses)` with a twin `entry_rigid(masses)`; `masses` are
point masses in kg at named points of the body, such as brackets.
Frames: x outboard, y along the hinge lines, z normal; origin in the middle of the body's inboard hinge line.
A rigid twin has the same points as the flexible body and the mass properties of the data sheet.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.resources import files
from typing import Any

import numpy as np

from ..cache.disk import kept
from ..contract.component import ComponentError
from ..flexible.finite_elements import FiniteElementModel
from ..flexible.modal import ModalData
from ..flexible.reduction import craig_bampton
from .amos3 import AMOS3
from .arabsat import ARABSAT
from .bepicolombo import BEPICOLOMBO
from .body import CatalogueBody, PointMasses, rigid_with_masses, symmetric_rigid_body, with_masses
from .data_files import catalogue_data
from .panel import WORKBENCH, workbench_bare_model

BODIES: Mapping[str, CatalogueBody] = {**WORKBENCH, **AMOS3, **BEPICOLOMBO, **ARABSAT}
"""Finite elements, attachment points and nodes of every entry."""

_SOURCES = ("contract", "flexible", "catalogue")
"""Folders of all that turns data into bodies."""


def finite_elements(entry: str, masses: PointMasses = ()) -> FiniteElementModel:
    """Finite elements of an entry with point masses fixed to its points."""
    if entry not in BODIES:
        raise ComponentError(f"there is no catalogue entry {entry!r}; entries are {', '.join(BODIES)}")
    return with_masses(BODIES[entry].build(), masses)


def workbench_panel(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """Workbench panel with two attachment points; 10 fixed-interface modes make 16 flexible ones."""
    return _flexible("workbench_panel", fixed_interface_modes, masses)


def workbench_panel_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of the workbench panel, which the data sheet gives without the hardware on the hinge line."""
    return _rigid_twin("workbench_panel", masses, workbench_bare_model)


def amos3_yoke(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """AMOS-3 yoke with three attachment points; 10 fixed-interface modes make 22 flexible ones."""
    return _flexible("amos3_yoke", fixed_interface_modes, masses)


def amos3_panel1(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """AMOS-3 panel 1 with four attachment points; 10 fixed-interface modes make 28 flexible ones."""
    return _flexible("amos3_panel1", fixed_interface_modes, masses)


def amos3_panel2(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """AMOS-3 panel 2 with two attachment points; 10 fixed-interface modes make 16 flexible ones."""
    return _flexible("amos3_panel2", fixed_interface_modes, masses)


def amos3_yoke_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of the AMOS-3 yoke."""
    return rigid_with_masses(_on_sheet(_rigid_twin("amos3_yoke"), "yoke"), masses)


def amos3_panel1_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of AMOS-3 panel 1."""
    return rigid_with_masses(_on_sheet(_rigid_twin("amos3_panel1"), "panel1"), masses)


def amos3_panel2_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of AMOS-3 panel 2."""
    return rigid_with_masses(_on_sheet(_rigid_twin("amos3_panel2"), "panel2"), masses)


def bepicolombo_inboard(fixed_interface_modes: int = 5, masses: PointMasses = ()) -> ModalData:
    """BepiColombo yoke and inboard panel, four attachment points; 5 fixed-interface modes make 23."""
    return _flexible("bepicolombo_inboard", fixed_interface_modes, masses)


def bepicolombo_outboard(fixed_interface_modes: int = 5, masses: PointMasses = ()) -> ModalData:
    """BepiColombo outboard panel with two attachment points; 5 fixed-interface modes make 11."""
    return _flexible("bepicolombo_outboard", fixed_interface_modes, masses)


def bepicolombo_inboard_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of the BepiColombo yoke and inboard panel."""
    return _rigid_twin("bepicolombo_inboard", masses)


def bepicolombo_outboard_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of the BepiColombo outboard panel."""
    return _rigid_twin("bepicolombo_outboard", masses)


def arabsat_yoke(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """ARABSAT yoke with three attachment points; 10 fixed-interface modes make 22 flexible ones."""
    return _flexible("arabsat_yoke", fixed_interface_modes, masses)


def arabsat_panel(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """ARABSAT panels 1 to 4 with four attachment points; 10 fixed-interface modes make 28 flexible ones."""
    return _flexible("arabsat_panel", fixed_interface_modes, masses)


def arabsat_panel_tip(fixed_interface_modes: int = 10, masses: PointMasses = ()) -> ModalData:
    """ARABSAT panel 5 with two attachment points; 10 fixed-interface modes make 16 flexible ones."""
    return _flexible("arabsat_panel_tip", fixed_interface_modes, masses)


def arabsat_yoke_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of the ARABSAT yoke."""
    return _rigid_twin("arabsat_yoke", masses)


def arabsat_panel_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of ARABSAT panels 1 to 4."""
    return _rigid_twin("arabsat_panel", masses)


def arabsat_panel_tip_rigid(masses: PointMasses = ()) -> ModalData:
    """Rigid twin of ARABSAT panel 5."""
    return _rigid_twin("arabsat_panel_tip", masses)


def _flexible(entry: str, fixed_interface_modes: int, masses: PointMasses) -> ModalData:
    """Reduced body, from the cache if it is there."""
    body = BODIES[entry]

    def reduced() -> ModalData:
        model = finite_elements(entry, masses)
        return craig_bampton(model, body.attachment_points, fixed_interface_modes, body.nodes)

    added = [(point, float(mass)) for point, mass in masses]
    return cached(reduced, {"body": entry, "modes": fixed_interface_modes, "masses": added})


def _rigid_twin(
    entry: str, masses: PointMasses = (), build: Callable[[], FiniteElementModel] | None = None
) -> ModalData:
    """Rigid body with the mass properties of finite elements, the entry's own unless others are given."""
    body = BODIES[entry]
    model = build or body.build
    rigid = cached(lambda: symmetric_rigid_body(model(), body.points), {"rigid": entry})
    return rigid_with_masses(rigid, masses)


def _on_sheet(body: ModalData, name: str) -> ModalData:
    """Mass, centre of mass and inertia about y of the AMOS-3 data sheet, the rest of the body.

    The inertia about z changes as much as that about y, as the perpendicular-axis theorem wants it.
    """
    sheet = catalogue_data("amos3")[name]
    about_x, about_y, about_z = np.diag(body.inertia)
    return replace(
        body,
        mass=sheet["mass"],
        center_of_mass=np.array((sheet["center_of_mass"], 0.0, 0.0)),
        inertia=np.diag((about_x, sheet["inertia"], about_z + sheet["inertia"] - about_y)),
    )


def cached(build: Callable[[], ModalData], key: Mapping[str, Any]) -> ModalData:
    """What `build` returns, kept in a file named by the content of `key` and of all that builds bodies."""

    def content() -> bytes:
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **build().to_arrays())
        return buffer.getvalue()

    with np.load(io.BytesIO(kept("modal", _digest(key), content))) as stored:
        return ModalData.from_arrays(stored)


def _digest(key: Mapping[str, Any]) -> str:
    """Hash of the key and of the sources and data that turn it into modal data."""
    content = hashlib.sha256(json.dumps(key, sort_keys=True).encode())
    package = files("components")
    for folder, ending in (*((name, ".py") for name in _SOURCES), ("data", ".toml")):
        found = [file for file in (package / folder).iterdir() if file.name.endswith(ending)]
        for file in sorted(found, key=lambda file: file.name):
            content.update(file.read_bytes())
    return content.hexdigest()
