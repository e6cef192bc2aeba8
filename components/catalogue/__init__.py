"""Bodies of solar-array wings as plain values: what their tables say, and the finite elements that follow.

Frames: x outboard, y along the hinge lines, z normal; origin in the middle of the body's inboard hinge line.
A rigid twin has the same points as the flexible body and the mass properties of the data sheet.
"""

from .definition import BodyDefinition, PointMasses

__all__ = ["BodyDefinition", "PointMasses"]
