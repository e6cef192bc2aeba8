"""A frame of three bars with nodes of six components, as finite elements of any program have them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from components.flexible.beam_frame import BeamSection, Member, beam_frame
from components.imported.body import ImportedBody
from components.imported.data import FiniteElementData

SECTION = BeamSection(
    axial=4e6, bending_y=900.0, bending_z=1500.0, torsion=600.0, line_mass=0.8, gyration_radius=0.01
)
JOINTS = {"left": (0.0, 0.4, 0.0), "right": (0.0, -0.4, 0.0), "tip": (1.7, 0.1, 0.2)}
MEMBERS = [Member(a, b, SECTION, 4) for a, b in (("left", "right"), ("right", "tip"), ("tip", "left"))]
POINTS = (("left", 1), ("right", 2), ("tip", 3))


def bar_frame(elements=4):
    return beam_frame(JOINTS, [replace(member, elements=elements) for member in MEMBERS])


def frame_data(model):
    """Its matrices with nodes 1, 2, ..., of which the first three are the corners."""
    numbers = np.arange(1, len(model.display_positions) + 1)
    dofs = np.column_stack([np.repeat(numbers, 6), np.tile(np.arange(1, 7), len(numbers))])
    return FiniteElementData(model.stiffness, model.mass_matrix, numbers, model.display_positions, dofs)


def imported(files, points=POINTS, **keys):
    """An imported body of one file, or of files by key; never one from the cache."""
    named = (
        tuple((name, str(path)) for name, path in files.items())
        if isinstance(files, dict)
        else (("file", str(files)),)
    )
    return ImportedBody(named, str(np.random.default_rng().integers(2**60)), points, **keys)
