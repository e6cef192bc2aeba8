"""Piecewise cubic Hermite interpolation that does not overshoot its points (PCHIP).

Slopes at inner points are the weighted harmonic means of those of both sides, zero at extremes (Fritsch and Butland,
SIAM J. Sci. Stat. Comput. 5, 1984), at the ends those of a parabola through three points.
"""

from __future__ import annotations

import numpy as np

from ..contract.component import Vector


def monotone_cubics(x: Vector, y: Vector) -> Vector:
    """Coefficients (4, n - 1) of the cubics between two or more points (n,), highest power of x - x_i first."""
    widths = np.diff(x)
    chords = np.diff(y) / widths
    slopes = _slopes(widths, chords)
    bend = (slopes[:-1] + slopes[1:] - 2.0 * chords) / widths
    return np.array((bend / widths, (chords - slopes[:-1]) / widths - bend, slopes[:-1], y[:-1]))


def _slopes(widths: Vector, chords: Vector) -> Vector:
    """Slopes (n,) at all points."""
    if chords.size == 1:
        return np.repeat(chords, 2)
    left, right = chords[:-1], chords[1:]
    rising = left * right > 0.0
    to_left, to_right = 2.0 * widths[1:] + widths[:-1], widths[1:] + 2.0 * widths[:-1]
    inverse = np.zeros(left.size)
    np.divide(to_left, left, out=inverse, where=rising)
    inverse += np.divide(to_right, right, out=np.zeros(left.size), where=rising)
    inner = np.divide(to_left + to_right, inverse, out=np.zeros(left.size), where=rising)
    first = _end(widths[0], widths[1], chords[0], chords[1])
    last = _end(widths[-1], widths[-2], chords[-1], chords[-2])
    return np.concatenate(([first], inner, [last]))


def _end(width: float, next_width: float, chord: float, next_chord: float) -> float:
    """Slope at an end, from the chords and widths of the two pieces next to it."""
    slope = ((2.0 * width + next_width) * chord - width * next_chord) / (width + next_width)
    if slope * chord <= 0.0:
        return 0.0
    return 3.0 * chord if chord * next_chord < 0.0 and abs(slope) > 3.0 * abs(chord) else slope
