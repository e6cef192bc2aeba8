"""The spin-up beam three ways, as one body, as eight in a chain and as a beam of large deformation, and in Exudyn.

    python -m tests.benchmark.spin_up

Wall time of the second of two runs, which finds its bodies reduced; errors (%) of how far the tip falls behind at the
most and at 10 s, against beams of 24 and 48 elements at a tolerance of 1e-6, extrapolated.
"""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter
from typing import NamedTuple

import numpy as np

import orchestrator as fanfold
from components.contract.component import Vector
from tests.benchmark.spin_up import exudyn_boom
from tests.references.spin_up import seen_from_the_base, spin_up, tip_of_beam, tip_of_modal

PIECES = 8
UNTIL = 11.0
"""s"""
EXUDYN = ((8, 2e-2), (16, 1e-2), (16, 5e-3), (32, 5e-3), (32, 2e-3))
"""Elements and step size (s)."""


class Fall(NamedTuple):
    """How far the tip falls behind at the most and at 10 s (m), wall time (s), steps."""

    deepest: float
    at_ten: float
    wall: float = np.nan
    steps: int = 0

    @classmethod
    def of(cls, t: Vector, tip: Vector, wall: float) -> Fall:
        """From times (T,) and positions (T, 3)."""
        behind = seen_from_the_base(t, tip)[1]
        return cls(_crest(t, behind), float(np.interp(10.0, t, behind)), wall, len(t))


def _crest(t: Vector, values: Vector) -> float:
    """Largest value, of the parabola through the largest row and its neighbours."""
    k = int(values.argmax())
    a, b, c = np.polyfit(t[k - 1 : k + 2] - t[k], values[k - 1 : k + 2], 2)
    return float(c - b * b / (4.0 * a))


def _timed(scene: fanfold.Scene) -> tuple[fanfold.Result, float]:
    for _ in range(2):
        start = perf_counter()
        result = fanfold.simulate(scene, until=UNTIL, estimate=False, progress=False)
        wall = perf_counter() - start
    return result, wall


def modal(pieces: int, modes: int, second_order: int, tolerance: float) -> Fall:
    """So many modal bodies, with so many modes each, and of these of second order."""
    keys = {"fidelity": "flexible", "fixed_interface_modes": modes, "second_order_modes": second_order}
    elements = 24 // pieces
    result, wall = _timed(spin_up(tolerance, pieces, elements, **keys))
    return Fall.of(np.array(result.time), tip_of_modal(result, pieces, elements, modes, second_order), wall)


def beam(elements: int, tolerance: float) -> Fall:
    """One beam of large deformation."""
    result, wall = _timed(spin_up(tolerance, elements=elements, fidelity="large_deformation"))
    return Fall.of(np.array(result.time), tip_of_beam(result), wall)


def exudyn(elements: int, h: float) -> Fall:
    """Exudyn's own solution."""
    wall, t, tip = exudyn_boom.spin_up(elements, h, UNTIL)
    return Fall.of(t, tip, wall)


def reference() -> Fall:
    """Beams of large deformation, whose errors fall with the square of the number of elements."""
    coarse, fine = beam(24, 1e-6), beam(48, 1e-6)
    return Fall(*((4.0 * b - a) / 3.0 for a, b in zip(coarse[:2], fine[:2], strict=True)))


def rows() -> Iterator[tuple[str, Fall]]:
    """Ways with their names."""
    for tolerance in (1e-3, 1e-4):
        yield f"one body, 6 modes of second order, {tolerance:g}", modal(1, 6, 6, tolerance)
        yield f"{PIECES} bodies, 4 modes of second order, {tolerance:g}", modal(PIECES, 4, 4, tolerance)
        yield f"{PIECES} bodies, first order, {tolerance:g}", modal(PIECES, 4, 0, tolerance)
        yield f"beam of 24 elements, {tolerance:g}", beam(24, tolerance)
    for elements, h in EXUDYN:
        yield f"Exudyn, {elements} elements, {1e3 * h:g} ms", exudyn(elements, h)


def main() -> None:
    """Print the table."""
    exact = reference()
    print(f"reference: {exact.deepest:.5f} m at the most, {exact.at_ten:.5f} m at 10 s")
    print(f"{'':44} {'wall, s':>8} {'steps':>6} {'deepest, %':>11} {'at 10 s, %':>11}")
    for name, found in rows():
        errors = [100.0 * (a / b - 1.0) for a, b in zip(found[:2], exact[:2], strict=True)]
        print(f"{name:44} {found.wall:8.2f} {found.steps:6d} {errors[0]:11.3f} {errors[1]:11.3f}", flush=True)


if __name__ == "__main__":
    main()
