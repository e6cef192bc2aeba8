"""Modal data for the examples of components."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..flexible.modal import ModalData


def example_modal_data() -> ModalData:
    """Modes of a 3x2 grid of point masses: smooth made-up shapes, rigid motions projected out.

    By made-up numbers as well, pairs of three of them displace and turn the points and stretch the body.
    """
    grid = np.array([(x, y, 0.1 * x * y) for x in (0.0, 0.5, 1.0) for y in (-0.4, 0.4)])
    masses = np.linspace(0.8, 1.2, len(grid))
    shapes = np.array(
        [
            [np.sin((k + 1) * p[0] + axis) + (k - 1) * p[1] * p[0] for axis in range(3)]
            for k in range(4)
            for p in grid
        ]
    ).reshape(4, len(grid) * 3)
    data = ModalData.from_point_masses(
        masses,
        grid,
        shapes.T,
        frequency=2.0 * np.pi * np.array([2.0, 9.0, 40.0, 300.0]),
        points={"left": 0, "right": len(grid) - 1},
    )
    point, axis, one, other = np.indices((2, 6, 3, 3))
    pairs = 0.1 * np.cos(1.0 + 2.0 * point + axis + one * other) / (1.0 + one + other)
    form, one, other = np.indices((2, 3, 3))
    forms = 120.0 * np.sin(1.0 + form + one + other) * (1.0 + one) * (1.0 + other)
    return replace(data, second_order_points=pairs, tension_forms=forms)
