"""The antenna's foil in a border of one rigid piece: a body whose bending stretches it, for tests."""

from __future__ import annotations

from components.flexible.finite_elements import FiniteElementModel
from components.flexible.modal import ModalData
from components.flexible.panel import panel_model
from components.flexible.plate import HingeArm, Panel, Plate
from components.flexible.reduction import craig_bampton

MODULUS, RATIO, THICKNESS, AREAL_MASS, SIDE = 700e9, 0.31, 0.5e-3, 7.815, 0.98
"""Pa, 1, m, kg/m2, and the side (m) of the square inside the border."""
STRIP = 0.02


def clamped_membrane(modes: int, ratio: float = RATIO, element_size: float = 0.1) -> ModalData:
    """With so many fixed-interface modes; points `border` and `center`."""
    model = membrane_model(ratio, element_size)
    return craig_bampton(model, ["border"], modes, ["center"], geometry="von_karman")


def membrane_model(ratio: float = RATIO, element_size: float = 0.1) -> FiniteElementModel:
    """Its finite elements."""
    tension = MODULUS * THICKNESS / (1.0 - ratio**2)
    membrane = (tension, tension, ratio * tension, 0.5 * (1.0 - ratio) * tension)
    a11, a22, a12, a66 = (value * THICKNESS**2 / 12.0 for value in membrane)
    whole, half = SIDE + 2.0 * STRIP, 0.5 * SIDE + STRIP
    plate = Plate(whole, whole, AREAL_MASS, (a11, a22, a12, a66), membrane, geometry="von_karman")
    low, high, ends = (0.0, STRIP), (whole - STRIP, whole), (-half, half)
    strips = (
        *((x, ends) for x in (low, high)),
        *(((0.0, whole), y) for y in ((-half, STRIP - half), (half - STRIP, half))),
    )
    border = HingeArm("border", 0.0, x=0.5 * whole, rectangles=strips)
    return panel_model(Panel(plate, (border,), {"center": (0.5 * whole, 0.0)}, 0.0, element_size))
