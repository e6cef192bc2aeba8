"""Bodies of solar-array wings as tables in data files: what is written down, read, and made a body of.

Frames: x outboard, y along the hinge lines, z normal; origin in the middle of the body's inboard hinge line.
A rigid twin has the same points as the flexible body and the mass properties of the data sheet.
"""

from .data_sheets import entries, entry, entry_table
from .definition import BodyDefinition, PointMasses
from .reader import read_body
from .tables import Convert, TableError

__all__ = [
    "BodyDefinition",
    "Convert",
    "PointMasses",
    "TableError",
    "entries",
    "entry",
    "entry_table",
    "read_body",
]
